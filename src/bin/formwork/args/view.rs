use std::path::PathBuf;

use clap::{ArgGroup, value_parser};
use formwork::view::Up;

use super::{Common, Names, choice};

/// What can be drawn on the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layer {
    Strokes,
    Arrows,
    Cage,
    Creases,
    Zeros,
    Mesh,
}

const LAYERS: Names<Layer> = &[
    ("strokes", Layer::Strokes),
    ("arrows", Layer::Arrows),
    ("cage", Layer::Cage),
    ("creases", Layer::Creases),
    ("zeros", Layer::Zeros),
    ("mesh", Layer::Mesh),
];
const AXES: Names<Up> = &[("y", Up::Y), ("z", Up::Z)];

pub const HELP: &str = "\
The page is one file that needs no network: open it in any browser, send it by
mail. It shows the limit surface with exact normals, what is carried along by
the field of the 1-form, its zeros, the control cage and the creases; 0-forms
and densities of 2-forms as colours, with their scale. Drag turns it; ? lists
its keys. Every level up to --levels is in it, its vertices on the limit
surface. The picture shows the same without a browser.

Of the three degrees only one need be given. A missing 1-form is the gradient
of the 0-form, a missing 0-form the potential of the exact part of the 1-form,
a missing 2-form the curl of the 1-form.

Examples:
  formwork view assets/creased_box.obj --field assets/creased_box.field.json \\
      -o box.html
  formwork view assets/torus.obj --spec assets/torus.design.json -o torus.html
  formwork view assets/genus2.obj --field assets/genus2.field.json \\
      --show arrows,zeros --png genus2.png --size 800x600
  formwork view assets/creased_box.obj --field assets/creased_box.field.json \\
      --form 2 --png curl.png --size 800x600";

#[derive(Debug, clap::Args)]
#[command(group(ArgGroup::new("out").required(true).multiple(true).args(["output", "png"])))]
pub struct View {
    /// Forms on the control cage, as JSON, instead of those that the mesh file holds
    #[arg(long, value_name = "FIELD.json")]
    pub field: Option<PathBuf>,
    /// A field to be designed, as JSON: see formwork design --help
    #[arg(long, value_name = "SPEC.json", conflicts_with = "field")]
    pub spec: Option<PathBuf>,
    /// With --spec: take an excess of sources or vortices off evenly, by area
    #[arg(long, requires = "spec")]
    pub balance: bool,
    /// The page to write: .html
    #[arg(long, short, value_name = "OUT.html")]
    pub output: Option<PathBuf>,
    /// The picture to write: .png
    #[arg(long, value_name = "OUT.png")]
    pub png: Option<PathBuf>,
    /// The size of the picture in pixels
    #[arg(long, value_name = "WxH", default_value = "1400x1000", value_parser = size)]
    pub size: [u32; 2],
    /// The finest level [as many as stay below 30 000 faces, 4 at most]
    #[arg(long, short, value_name = "N", value_parser = value_parser!(u8).range(0..=15))]
    pub levels: Option<u8>,
    /// The degree that is shown first [1, or the first that is there]
    #[arg(long, value_name = "DEGREE", value_parser = value_parser!(u8).range(0..=2))]
    pub form: Option<u8>,
    /// What is drawn on the surface first
    #[arg(
        long,
        value_name = "LAYERS",
        value_delimiter = ',',
        default_value = "strokes,cage,creases,zeros",
        value_parser = choice(LAYERS)
    )]
    pub show: Vec<Layer>,
    /// How many strokes
    #[arg(long, value_name = "N", default_value_t = 1400, value_parser = value_parser!(u32).range(0..=100_000))]
    pub lines: u32,
    /// The axis that points up [z; y for glTF and USD]
    #[arg(long, value_name = "AXIS", value_parser = choice(AXES))]
    pub up: Option<Up>,
    #[command(flatten)]
    pub common: Common,
}

/// `1400x1000`.
fn size(typed: &str) -> Result<[u32; 2], String> {
    let side = |text: &str| text.parse::<u32>().ok().filter(|side| (16..=16_384).contains(side));
    let sides = typed.split_once('x').and_then(|(width, height)| Some([side(width)?, side(height)?]));
    let fits = |[width, height]: &[u32; 2]| u64::from(*width) * u64::from(*height) <= 1 << 24;
    sides
        .filter(fits)
        .ok_or_else(|| "write two numbers from 16 on, as 1400x1000, 16 million pixels at most".to_owned())
}
