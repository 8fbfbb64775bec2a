use std::path::PathBuf;

use clap::value_parser;
use formwork::design::{Condition, Metric};

use super::{Common, Names, Writing, choice};

pub const METRICS: Names<Metric> = &[("limit", Metric::Limit), ("control-mesh", Metric::ControlMesh)];
const CONDITIONS: Names<Condition> = &[("tangential", Condition::Tangential), ("normal", Condition::Normal)];

pub const DESIGN: &str = "\
The spec is JSON. Indices start at 0, every key may be left out:
  {\"sources\": [{\"vertex\": v, \"strength\": q}, {\"at\": [face, s, t], ...}],
   \"vortices\": [{\"face\": f, \"strength\": q}, {\"at\": [face, s, t], ...}],
   \"edges\": [{\"vertices\": [a, b], \"value\": x, \"weight\": w}],
   \"vectors\": [{\"at\": [face, s, t], \"vector\": [x, y, z], \"weight\": w}],
   \"boundary\": [\"tangential\", \"normal\", ...],
   \"harmonic\": [{\"generator\": i, \"circulation\": x}],
   \"regions\": [{\"faces\": [f, ...], \"weight\": w}]}
A sink is a source of negative strength. Strengths are fluxes and circulations;
where nothing can flow off they sum to 0, or --balance makes them. Points are
those that evaluate takes, [face, corner, s, t] on polygons. Edge values are
circulations of the limit field along limit edges. Values without a weight are
met exactly. Boundary loops (in the order of their first edges) are tangential
unless said otherwise. There are 2g generators on a closed surface of genus g.

The field is written as by the command limit; --field-out writes its
control values for the other commands. Its zeros are found on the limit surface
and counted against the Euler characteristic.

Examples:
  formwork design assets/torus.obj --spec assets/torus.design.json -o torus.usda
  formwork design assets/gem.obj --spec assets/gem.design.json --balance \\
      --tangents --level 2 -o gem.usda
  formwork design assets/genus2.obj --spec assets/genus2.design.json --json \\
      -o genus2.json";

pub const DECOMPOSE: &str = "\
c = d0 a + k + h: without curl, without divergence, without either; orthogonal
to each other in the metric. What is written, one number for each cell:
  potential                    a, on vertices; exact = d0 a
  stream                       y, on faces: M1 coexact = d1' y
  edges                        their ends, as [a, b]
  exact, coexact, harmonic     values on the edges, in their directions
  circulations                 of h round the cycle of each generator
  cycles                       these cycles, as lists of vertices (JSON only)

Examples:
  formwork decompose assets/creased_box.obj \\
      --field assets/creased_box.field.json -o parts.json
  formwork decompose assets/genus2.obj --field assets/genus2.field.json \\
      --metric control-mesh -o parts.npz";

pub const STREAMLINES: &str = "\
Seeds are spread evenly over the surface, or taken from --points (as evaluate
takes them). A line ends after --length, where the field vanishes, at the
boundary, or where it closes. Lengths are in units of the surface's size: the
diagonal of the box round it is 1.

What is written, by the extension of -o:
  .json  positions, points [face, corner, s, t] and ends of each line
  .usda  a BasisCurves prim    .obj  polylines

Examples:
  formwork streamlines assets/creased_box.obj \\
      --field assets/creased_box.field.json --seeds 50 -o lines.usda
  formwork streamlines assets/genus2.obj --field assets/genus2.field.json \\
      --seeds 20 --length 0.5 -o lines.json";

#[derive(Debug, clap::Args)]
pub struct Design {
    /// What the field shall have, as JSON
    #[arg(long, value_name = "SPEC.json")]
    pub spec: PathBuf,
    /// Take an excess of sources or vortices off evenly, by area
    #[arg(long)]
    pub balance: bool,
    /// Where lengths and angles are measured
    #[arg(long, value_name = "METRIC", default_value = "limit", value_parser = choice(METRICS))]
    pub metric: Metric,
    /// Also write the control values of the field, as JSON for --field
    #[arg(long, value_name = "FIELD.json")]
    pub field_out: Option<PathBuf>,
    /// How many times to refine what is written
    #[arg(long, short, value_name = "N", default_value_t = 2, value_parser = value_parser!(u8).range(0..=15))]
    pub level: u8,
    /// The file to write: .usda, .glb, .gltf, .obj, .json or .npz
    #[arg(long, short, value_name = "OUT")]
    pub output: PathBuf,
    /// Also write the direction of the field: TANGENT in glTF, primvars:combDir in USD, for fur
    #[arg(long)]
    pub tangents: bool,
    #[command(flatten)]
    pub common: Common,
}

impl Design {
    pub fn writing(&self) -> Writing {
        Writing { field: None, output: self.output.clone(), frames: None, tangents: self.tangents }
    }
}

#[derive(Debug, clap::Args)]
pub struct Decompose {
    /// The 1-form on the control cage, as JSON, instead of that in the mesh file
    #[arg(long, value_name = "FIELD.json")]
    pub field: Option<PathBuf>,
    /// Where lengths and angles are measured
    #[arg(long, value_name = "METRIC", default_value = "limit", value_parser = choice(METRICS))]
    pub metric: Metric,
    /// What the exact part does at the boundary loops, in their order
    #[arg(long, value_name = "CONDITIONS", value_delimiter = ',', value_parser = choice(CONDITIONS))]
    pub conditions: Vec<Condition>,
    /// The file to write: .json or .npz
    #[arg(long, short, value_name = "OUT")]
    pub output: PathBuf,
    #[command(flatten)]
    pub common: Common,
}

#[derive(Debug, clap::Args)]
pub struct Streamlines {
    /// The 1-form on the control cage, as JSON, instead of that in the mesh file
    #[arg(long, value_name = "FIELD.json")]
    pub field: Option<PathBuf>,
    /// How many lines
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = value_parser!(u32).range(1..=1_000_000))]
    pub seeds: u32,
    /// Lines through these points instead, as JSON
    #[arg(long, value_name = "P.json", conflicts_with = "seeds")]
    pub points: Option<PathBuf>,
    /// The length of a line in each direction, at most
    #[arg(long, value_name = "LENGTH", default_value_t = 0.25, value_parser = positive)]
    pub length: f64,
    /// The length of a step, at most
    #[arg(long, value_name = "LENGTH", default_value_t = 0.005, value_parser = positive)]
    pub step: f64,
    /// Only along the field, not against it
    #[arg(long)]
    pub forward: bool,
    /// The file to write: .json, .usda or .obj
    #[arg(long, short, value_name = "OUT")]
    pub output: PathBuf,
    #[command(flatten)]
    pub common: Common,
}

fn positive(typed: &str) -> Result<f64, String> {
    typed
        .parse()
        .ok()
        .filter(|x: &f64| *x > 0.0 && *x <= 1e3)
        .ok_or_else(|| "write a positive number".to_owned())
}
