//! What can be typed. Parsed and range-checked here, settled in [`crate::job`].

mod batch;

use std::path::PathBuf;

pub use batch::Batch;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Parser, Subcommand, value_parser};
use formwork::io::Frames;
use formwork::osd::OsdScheme;
use formwork::scheme::{BoundaryRule, DooSabin, Scheme, Variant};
use formwork::topology::{BoundaryInterpolation, CreasingMethod, TriangleSubdivision};

// Lines of at most 79 characters: clap breaks longer ones in a narrow terminal, code and all.
const EXAMPLES: &str = "\
Examples:
  What is this cage, and what becomes of its creases, holes and polygons?
    formwork inspect assets/open_polygons.obj

  Refine a cage and the 1-form on its edges; any glTF viewer opens the result:
    formwork subdivide assets/creased_box.obj \\
        --field assets/creased_box.field.json --levels 3 -o box.glb

  Measure that d S = S d, against OpenSubdiv's own weights:
    formwork validate assets/creased_box.obj --levels 3

`formwork COMMAND --help` tells more. Exit codes: 0 fine, 2 the input or the
arguments are at fault (one line on stderr says where and what to do), 3 a law
does not hold, 1 some assets of a batch failed.";

const SUBDIVIDE_HELP: &str = "\
The field file is JSON. Indices start at 0; cells not listed have the value 0:
  {\"edges\": [[a, b, value], ...],    1-form: circulation from vertex a to b
   \"vertices\": [[v, value], ...],    0-form
   \"faces\": [[f, value], ...]}       2-form: flux, counter-clockwise side positive
Any of the three may be left out. Without --field, the forms that the mesh file
holds itself are refined: primvars form0, form1, form2 in USD, extras in glTF.

What is written, by the extension of -o:
  .usda  the stage of the input with the mesh refined in its place, or a stage
         of its own; forms as primvars, the field as primvars:form1Vector
  .glb, .gltf  triangles with normals; the forms as vertex attributes _FORM0
         and _FORM1 (the tangent vector of the 1-form), all of them in extras,
         and a node of line segments that shows the field as arrows
  .json  everything: positions, polygons, edges, forms, a vector for each face
  .obj   the polygons; OBJ has no place for forms, so they go to a second file,
         X.fields.json beside X.obj, in the format above
Faces that are holes are left out. --levels 0 writes the cage itself with its
tags and holes: that turns one format into another.

Examples:
  formwork subdivide assets/creased_box.obj \\
      --field assets/creased_box.field.json -o box.glb
  formwork subdivide assets/creased_box.obj \\
      --field assets/creased_box.field.json --levels 2 -o box.usda
  formwork subdivide assets/scene.usda --prim /Scene/Wave --frames all -o fine.usda
  formwork subdivide assets/open_polygons.obj --levels 0 -o open.usda
  formwork subdivide assets/open_polygons.obj --boundary none -o open.json";

const OPERATORS_HELP: &str = "\
For each level l the archive has l{l}/edges (E, 2), l{l}/face_sizes,
l{l}/face_vertices and the matrices l{l}/d0 and l{l}/d1; for l >= 1 also the
matrices l{l}/S0, l{l}/S1, l{l}/S2 from level l - 1 to level l, and
l{l}/vertex_parent_kind (0 vertex, 1 edge, 2 face), l{l}/vertex_parent_index.
A matrix M is four arrays, M_data, M_indices, M_indptr and M_shape (compressed
sparse rows). With npz = numpy.load(\"box.npz\"), SciPy reads it by

  def matrix(npz, name):
      parts = (npz[f\"{name}_{part}\"] for part in (\"data\", \"indices\", \"indptr\"))
      return scipy.sparse.csr_matrix(tuple(parts), shape=npz[f\"{name}_shape\"])

Faces that are holes belong to the complex and are here.

Examples:
  formwork operators assets/creased_box.obj --levels 2 -o box.npz
  formwork operators assets/open_polygons.obj --doo-sabin original -o open.npz
  formwork operators assets/creased_box.obj --json -o box.npz";

const VALIDATE_HELP: &str = "\
For each level: the largest entry of d0 S0 - S1 d0, with OpenSubdiv's own S0,
and of d1 S1 - S2 d1; how far the column sums of S2 are from 1; the largest
difference between our S0 and OpenSubdiv's. Then, for a random 0-form, its
refined differential summed along each control edge, against the difference of
OpenSubdiv's refined values (equal to rounding) and of its limit values
(approached by the rate shown: 2 on regular meshes, less next to semi-sharp
creases, darts and n-gons, where its limit values are not exact). Schemes that
OpenSubdiv does not have are compared with their own S0.

Examples:
  formwork validate assets/creased_box.obj --levels 3
  formwork validate assets/open_polygons.obj --json
  formwork validate assets/creased_box.obj --boundary edge-and-corner
  formwork validate assets/gem.obj --scheme modified-loop";

const INSPECT_HELP: &str = "\
Examples:
  formwork inspect assets/creased_box.obj
  formwork inspect assets/open_polygons.obj --boundary none
  formwork inspect assets/open_polygons.obj --json";

/// Smooth differential forms on OpenSubdiv surfaces: values on vertices, oriented edges and faces, refined
/// so that d S = S d exactly.
#[derive(Debug, Parser)]
#[command(version, after_help = EXAMPLES, max_term_width = 100)]
pub struct Args {
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Count and classify a cage, and say how it will be treated
    #[command(after_help = INSPECT_HELP)]
    Inspect(Inspect),
    /// Refine a cage, with forms on it, and write the result
    #[command(after_help = SUBDIVIDE_HELP)]
    Subdivide(Subdivide),
    /// Write the subdivision operators and exterior derivatives as sparse matrices, for NumPy and SciPy
    #[command(after_help = OPERATORS_HELP)]
    Operators(Operators),
    /// Measure that the operators commute with d, against OpenSubdiv itself
    #[command(after_help = VALIDATE_HELP)]
    Validate(Validate),
    /// Refine many assets, failures apart, and go on where the last run stopped
    #[command(after_help = batch::HELP)]
    Batch(Batch),
}

impl Command {
    /// The options of a command on one mesh.
    pub fn common(&self) -> Option<&Common> {
        Some(match self {
            Command::Batch(_) => return None,
            Command::Inspect(args) => &args.common,
            Command::Subdivide(args) => &args.common,
            Command::Operators(args) => &args.common,
            Command::Validate(args) => &args.common,
        })
    }
}

#[derive(Debug, clap::Args)]
pub struct Inspect {
    #[command(flatten)]
    pub common: Common,
}

#[derive(Debug, clap::Args)]
pub struct Subdivide {
    /// Forms on the control cage, as JSON, instead of those that the mesh file holds
    #[arg(long, value_name = "FIELD.json")]
    pub field: Option<PathBuf>,
    /// How many times to refine; 0 writes the cage itself
    #[arg(long, short, value_name = "N", default_value_t = 3, value_parser = value_parser!(u8).range(0..=15))]
    pub levels: u8,
    /// The file to write: .usda, .glb, .gltf, .obj or .json
    #[arg(long, short, value_name = "OUT")]
    pub output: PathBuf,
    /// USD: the time samples to refine: `all`, a range `1:24`, or one time `12.5`
    #[arg(long, value_name = "TIMES", value_parser = frames)]
    pub frames: Option<Frames>,
    /// glTF: also write the direction of the 1-form as TANGENT, for shaders
    #[arg(long)]
    pub tangents: bool,
    #[command(flatten)]
    pub common: Common,
}

#[derive(Debug, clap::Args)]
pub struct Operators {
    /// How many times to refine
    #[arg(long, short, value_name = "N", default_value_t = 1, value_parser = value_parser!(u8).range(1..=15))]
    pub levels: u8,
    /// The file to write: .npz
    #[arg(long, short, value_name = "OUT.npz")]
    pub output: PathBuf,
    #[command(flatten)]
    pub common: Common,
}

#[derive(Debug, clap::Args)]
pub struct Validate {
    /// How many times to refine
    #[arg(long, short, value_name = "N", default_value_t = 3, value_parser = value_parser!(u8).range(1..=15))]
    pub levels: u8,
    #[command(flatten)]
    pub common: Common,
}

#[derive(Debug, clap::Args)]
pub struct Common {
    /// The control cage: .obj (with OpenSubdiv's `t` tags), .usda, .usdc, .usdz, .glb, .gltf or .json
    #[arg(value_name = "MESH")]
    pub mesh: PathBuf,
    /// Which mesh, if the file has several: a prim path in USD, the name or number of a node in glTF
    #[arg(long, value_name = "NAME")]
    pub prim: Option<String>,
    /// Print one JSON object on stdout
    #[arg(long)]
    pub json: bool,
    /// Drop vertices that a face repeats, as collapsed quads at a pole do; without it they are an error
    #[arg(long)]
    pub collapse: bool,
    /// The boundary rule, instead of the file's [edge-only unless it says]
    #[arg(long, value_name = "RULE", value_parser = choice(BOUNDARY))]
    pub boundary: Option<BoundaryInterpolation>,
    /// How semi-sharp creases decay, instead of the file's [uniform unless it says]
    #[arg(long, value_name = "METHOD", value_parser = choice(CREASING))]
    pub creasing: Option<CreasingMethod>,
    /// The rule next to triangles, instead of the file's [catmark unless it says]
    #[arg(long, value_name = "RULE", value_parser = choice(TRIANGLES))]
    pub triangles: Option<TriangleSubdivision>,
    /// Faces are listed clockwise
    #[arg(long)]
    pub left_handed: bool,
    /// The subdivision scheme [the file's; else loop if all faces are triangles, else catmark]
    #[arg(long, value_name = "NAME", value_parser = choice(SCHEMES))]
    pub scheme: Option<SchemeName>,
    /// catmark: the face weights of 2-forms
    #[arg(long, value_name = "WEIGHTS", default_value = "thesis", value_parser = choice(DOO_SABIN))]
    pub doo_sabin: DooSabin,
    /// loop and modified-loop: the face weights of 2-forms at boundaries and creases
    #[arg(long, value_name = "RULE", default_value = "reflect", value_parser = choice(BOUNDARY_RULES))]
    pub half_box: BoundaryRule,
    /// No progress bar and no notes
    #[arg(long, short)]
    pub quiet: bool,
}

/// The names of an option's values.
pub type Names<T> = &'static [(&'static str, T)];

pub const BOUNDARY: Names<BoundaryInterpolation> = &[
    ("none", BoundaryInterpolation::None),
    ("edge-only", BoundaryInterpolation::EdgeOnly),
    ("edge-and-corner", BoundaryInterpolation::EdgeAndCorner),
];
pub const CREASING: Names<CreasingMethod> =
    &[("uniform", CreasingMethod::Uniform), ("chaikin", CreasingMethod::Chaikin)];
pub const TRIANGLES: Names<TriangleSubdivision> =
    &[("catmark", TriangleSubdivision::Catmark), ("smooth", TriangleSubdivision::Smooth)];
pub const DOO_SABIN: Names<DooSabin> = &[("thesis", DooSabin::Thesis), ("original", DooSabin::Original)];
pub const BOUNDARY_RULES: Names<BoundaryRule> =
    &[("reflect", BoundaryRule::Reflect), ("thesis", BoundaryRule::Thesis), ("dct", BoundaryRule::Dct)];
pub const SCHEMES: Names<SchemeName> = &[
    ("catmark", SchemeName::Catmark),
    ("loop", SchemeName::Loop),
    ("modified-loop", SchemeName::ModifiedLoop),
    ("whitney", SchemeName::Whitney),
    ("bilinear", SchemeName::Bilinear),
];

/// A scheme as the command line names it; its weights are options of their own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SchemeName {
    Catmark,
    Loop,
    ModifiedLoop,
    Whitney,
    Bilinear,
}

impl SchemeName {
    /// What OpenSubdiv, and so most files, calls it.
    pub fn opensubdiv(self) -> Option<OsdScheme> {
        match self {
            SchemeName::Catmark => Some(OsdScheme::Catmark),
            SchemeName::Loop => Some(OsdScheme::Loop),
            SchemeName::Bilinear => Some(OsdScheme::Bilinear),
            SchemeName::ModifiedLoop | SchemeName::Whitney => None,
        }
    }
}

impl Common {
    /// The scheme that was asked for; else the file's; else Loop's for a mesh of triangles and
    /// Catmull-Clark's for any other.
    pub fn scheme(&self, of_file: Option<OsdScheme>, face_sizes: &[u32]) -> Scheme {
        let default = match of_file {
            Some(OsdScheme::Bilinear) => SchemeName::Bilinear,
            Some(OsdScheme::Catmark) => SchemeName::Catmark,
            Some(OsdScheme::Loop) => SchemeName::Loop,
            None if face_sizes.iter().all(|&size| size == 3) => SchemeName::Loop,
            None => SchemeName::Catmark,
        };
        match self.scheme.unwrap_or(default) {
            SchemeName::Catmark => Scheme::Catmark(self.doo_sabin),
            SchemeName::Loop => Scheme::Loop(Variant::Loop, self.half_box),
            SchemeName::ModifiedLoop => Scheme::Loop(Variant::ModifiedLoop, self.half_box),
            SchemeName::Whitney => Scheme::Whitney,
            SchemeName::Bilinear => Scheme::Bilinear,
        }
    }
}

/// The name of a scheme.
pub fn scheme_name(scheme: Scheme) -> &'static str {
    let name = match scheme {
        Scheme::Catmark(_) => SchemeName::Catmark,
        Scheme::Loop(Variant::Loop, _) => SchemeName::Loop,
        Scheme::Loop(Variant::ModifiedLoop, _) => SchemeName::ModifiedLoop,
        Scheme::Whitney => SchemeName::Whitney,
        Scheme::Bilinear => SchemeName::Bilinear,
    };
    name_of(SCHEMES, name)
}

/// The name of a value.
pub fn name_of<T: PartialEq>(names: Names<T>, value: T) -> &'static str {
    names.iter().find(|(_, named)| *named == value).map_or("?", |(name, _)| name)
}

/// `all`, `1:24` or `12.5`.
fn frames(typed: &str) -> Result<Frames, String> {
    let time = |text: &str| text.parse::<f64>().ok().filter(|time| time.is_finite());
    let frames = match typed.split_once(':') {
        _ if typed == "all" => Some(Frames::All),
        None => time(typed).map(Frames::At),
        Some((first, last)) => time(first).zip(time(last)).map(|(first, last)| Frames::Range(first, last)),
    };
    frames.ok_or_else(|| "write all, two times as 1:24, or one time".to_owned())
}

fn choice<T: Clone + Send + Sync + 'static>(names: Names<T>) -> impl TypedValueParser<Value = T> {
    let parser = PossibleValuesParser::new(names.iter().map(|(name, _)| *name));
    parser.try_map(move |typed| {
        let found = names.iter().find(|(name, _)| *name == typed);
        found.map(|(_, value)| value.clone()).ok_or("not one of the values")
    })
}
