//! What can be typed. Parsed and range-checked here, settled in [`crate::job`].

mod analysis;
mod batch;
mod design;
mod help;
mod solve;
mod study;
mod view;
pub mod volume;

use std::path::PathBuf;

pub use analysis::{Basis, Cell, CharMap, Spectrum, Stencil, Valences, Vertex};
pub use batch::Batch;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Parser, Subcommand, value_parser};
pub use design::{Decompose, Design, METRICS, Streamlines};
use formwork::io::Frames;
use formwork::osd::OsdScheme;
use formwork::scheme::{BoundaryRule, DooSabin, Scheme, Variant};
use formwork::topology::{BoundaryInterpolation, CreasingMethod, TriangleSubdivision};
pub use solve::{Masses, Solve};
pub use study::Study;
pub use view::{Layer, View};

/// Smooth differential forms on OpenSubdiv surfaces: values on vertices, oriented edges and faces, refined
/// so that d S = S d exactly.
#[derive(Debug, Parser)]
#[command(version, after_help = help::EXAMPLES, max_term_width = 100)]
pub struct Args {
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Count and classify a cage, and say how it will be treated
    #[command(after_help = help::INSPECT)]
    Inspect(Inspect),
    /// Refine a cage, with forms on it, and write the result
    #[command(after_help = help::SUBDIVIDE)]
    Subdivide(Subdivide),
    /// Put a refined cage, with forms on it, on its limit surface: exact positions, normals, vectors
    #[command(after_help = help::LIMIT)]
    Limit(Limit),
    /// Evaluate the limit surface and the forms on it at points
    #[command(after_help = help::EVALUATE)]
    Evaluate(Evaluate),
    /// Write the subdivision operators and exterior derivatives as sparse matrices, for NumPy and SciPy
    #[command(after_help = help::OPERATORS)]
    Operators(Operators),
    /// Design a tangent field: sources, sinks, vortices, directions, harmonic parts
    #[command(after_help = design::DESIGN)]
    Design(Design),
    /// Split a 1-form into its exact, coexact and harmonic parts
    #[command(after_help = design::DECOMPOSE)]
    Decompose(Decompose),
    /// Trace streamlines of a 1-form on the limit surface
    #[command(after_help = design::STREAMLINES)]
    Streamlines(Streamlines),
    /// Solve with smooth forms on the surface: Hodge-Laplace problems, eigenforms, diffusion
    #[command(after_help = solve::SOLVE)]
    Solve(Solve),
    /// Write masses and stiffnesses of the smooth forms, for NumPy, SciPy and PETSc
    #[command(after_help = solve::MASSES)]
    Masses(Masses),
    /// Look at a surface and the forms on it: a page for the browser, a picture
    #[command(after_help = view::HELP)]
    View(View),
    /// Measure that the operators commute with d, against OpenSubdiv itself
    #[command(after_help = help::VALIDATE)]
    Validate(Validate),
    /// Solve a boundary value problem on finer and finer lattices: errors and their rates
    #[command(after_help = study::HELP)]
    Study(Study),
    /// Eigenvalues of the operators round a vertex
    #[command(after_help = analysis::SPECTRUM)]
    Spectrum(Spectrum),
    /// What a cell of the next level takes of the cells round a vertex
    #[command(after_help = analysis::STENCIL)]
    Stencil(Stencil),
    /// The characteristic map of a vertex: a picture, and whether it looks injective
    #[command(name = "charmap", after_help = analysis::CHARMAP)]
    CharMap(CharMap),
    /// Draw a basis form near a vertex
    #[command(after_help = analysis::BASIS)]
    Basis(Basis),
    /// Refine many assets, failures apart, and go on where the last run stopped
    #[command(after_help = batch::HELP)]
    Batch(Batch),
    /// Solids of tetrahedra and octahedra: forms of degree 0 to 3 in space
    #[command(after_help = volume::HELP)]
    Volume(volume::Volume),
}

impl Command {
    /// The options of a command on one vertex.
    pub fn vertex(&self) -> Option<&Vertex> {
        match self {
            Command::Spectrum(args) => Some(&args.vertex),
            Command::Stencil(args) => Some(&args.vertex),
            Command::CharMap(args) => Some(&args.vertex),
            Command::Basis(args) => Some(&args.vertex),
            _ => None,
        }
    }

    /// The options of a command on one mesh.
    pub fn common(&self) -> Option<&Common> {
        Some(match self {
            Command::Batch(_) | Command::Study(_) | Command::Volume(_) => return None,
            Command::Spectrum(_) | Command::Stencil(_) | Command::CharMap(_) | Command::Basis(_) => {
                return None;
            }
            Command::Inspect(args) => &args.common,
            Command::Subdivide(args) => &args.common,
            Command::Limit(args) => &args.common,
            Command::Evaluate(args) => &args.common,
            Command::Operators(args) => &args.common,
            Command::Validate(args) => &args.common,
            Command::Solve(args) => &args.common,
            Command::Masses(args) => &args.common,
            Command::Design(args) => &args.common,
            Command::Decompose(args) => &args.common,
            Command::Streamlines(args) => &args.common,
            Command::View(args) => &args.common,
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
    /// How many times to refine; 0 writes the cage itself
    #[arg(long, short, value_name = "N", default_value_t = 3, value_parser = value_parser!(u8).range(0..=15))]
    pub levels: u8,
    /// Put the result on the limit surface
    #[arg(long)]
    pub limit: bool,
    #[command(flatten)]
    pub writing: Writing,
    #[command(flatten)]
    pub common: Common,
}

#[derive(Debug, clap::Args)]
pub struct Limit {
    /// How many times to refine first; 0 takes the vertices of the cage
    #[arg(long, short, value_name = "N", default_value_t = 2, value_parser = value_parser!(u8).range(0..=15))]
    pub level: u8,
    #[command(flatten)]
    pub writing: Writing,
    #[command(flatten)]
    pub common: Common,
}

/// What a refined mesh carries, and where it goes.
#[derive(Debug, clap::Args)]
pub struct Writing {
    /// Forms on the control cage, as JSON, instead of those that the mesh file holds
    #[arg(long, value_name = "FIELD.json")]
    pub field: Option<PathBuf>,
    /// The file to write: .usda, .glb, .gltf, .obj, .json or .npz
    #[arg(long, short, value_name = "OUT")]
    pub output: PathBuf,
    /// USD: the time samples to refine: `all`, a range `1:24`, or one time `12.5`
    #[arg(long, value_name = "TIMES", value_parser = frames)]
    pub frames: Option<Frames>,
    /// Also write the direction of the 1-form: TANGENT in glTF, primvars:combDir in USD, for fur
    #[arg(long)]
    pub tangents: bool,
}

#[derive(Debug, clap::Args)]
pub struct Evaluate {
    /// Forms on the control cage, as JSON
    #[arg(long, value_name = "FIELD.json")]
    pub field: Option<PathBuf>,
    /// The points, as JSON
    #[arg(long, value_name = "P.json", conflicts_with = "per_face", required_unless_present = "per_face")]
    pub points: Option<PathBuf>,
    /// K x K points in every face
    #[arg(long, value_name = "K", value_parser = value_parser!(u32).range(1..=1000))]
    pub per_face: Option<u32>,
    /// The file to write: .json or .npz
    #[arg(long, short, value_name = "OUT")]
    pub output: PathBuf,
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

    /// The scheme with these weights.
    pub fn with(self, doo_sabin: DooSabin, half_box: BoundaryRule) -> Scheme {
        match self {
            SchemeName::Catmark => Scheme::Catmark(doo_sabin),
            SchemeName::Loop => Scheme::Loop(Variant::Loop, half_box),
            SchemeName::ModifiedLoop => Scheme::Loop(Variant::ModifiedLoop, half_box),
            SchemeName::Whitney => Scheme::Whitney,
            SchemeName::Bilinear => Scheme::Bilinear,
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
        self.scheme.unwrap_or(default).with(self.doo_sabin, self.half_box)
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

pub(super) fn choice<T: Clone + Send + Sync + 'static>(names: Names<T>) -> impl TypedValueParser<Value = T> {
    let parser = PossibleValuesParser::new(names.iter().map(|(name, _)| *name));
    parser.try_map(move |typed| {
        let found = names.iter().find(|(name, _)| *name == typed);
        found.map(|(_, value)| value.clone()).ok_or("not one of the values")
    })
}
