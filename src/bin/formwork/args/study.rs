use std::path::PathBuf;

use formwork::fem::study::Cells;

use super::{Names, choice};

const CELLS: Names<Cells> = &[("quads", Cells::Quads), ("triangles", Cells::Triangles)];

pub const HELP: &str = "\
A problem of the thesis by name, I, II, I-F, II-F, I-Fsym, II-Fsym, I-thesis,
I-mixed, I-F-mixed, lshape-smooth, lshape-singular, lshape-one, bilaplace; or
your own, as JSON. All but the solution may be left out:
  {\"name\": \"mine\", \"domain\": \"square\" | \"lshape\",
   \"method\": \"hodge-laplace\" | \"bi-laplace\" | \"mixed\",
   \"solution\": [\"sin(pi*x)*y\", \"x^2\"], \"load\": [\"..\", \"..\"],
   \"map\": [\"x\", \"y\", \"x*y\"] or \"metric\": [\"g11\", \"g12\", \"g22\"],
   \"boundary\": \"nitsche\" | \"strong\" | \"means\" | \"penalty\" | \"nearest\",
   \"factor\": 25, \"rule\": 4, \"boundary-points\": 5,
   \"elements\": [\"quads\", \"triangles\"], \"cells\": [4, 8, 16, 32]}
The solution is a 1-form, by its components along dx and dy. The load (Delta w,
or Delta Delta w, in the metric) and the boundary data are derived from it,
exactly, so that any formula is a test with a known answer. Formulas have x, y,
pi, + - * / ^, sin, cos, exp, ln, sqrt, atan2(y, x). The metric is that of the image of a map, or
given, or flat.

Errors are norms in the metric over the domain: of w itself (L2), of its first
derivatives (energy, H1), of its second ones (H2). h is the size of a cell.

Examples:
  formwork study I --cells 4,8
  formwork study bilaplace --elements quads --cells 4,8 --json
  formwork study assets/mine.study.json --cells 4,8 -o mine.svg";

#[derive(Debug, clap::Args)]
pub struct Study {
    /// A problem by name, or a file
    #[arg(value_name = "PROBLEM")]
    pub problem: String,
    /// The cells along a unit of length, one number for each lattice
    #[arg(long, value_name = "N,N,..", value_delimiter = ',')]
    pub cells: Vec<u32>,
    /// One kind of cells only
    #[arg(long, value_name = "KIND", value_parser = choice(CELLS))]
    pub elements: Option<Cells>,
    /// Also write the tables (.json) or their picture (.svg); may be repeated
    #[arg(long, short, value_name = "OUT")]
    pub output: Vec<PathBuf>,
    /// Print one JSON object on stdout
    #[arg(long)]
    pub json: bool,
    /// No progress bar
    #[arg(long, short)]
    pub quiet: bool,
}
