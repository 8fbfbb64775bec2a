//! `spectrum`, `stencil`, `charmap` and `basis`: what a scheme does round one vertex.

use std::path::PathBuf;

use clap::value_parser;
use formwork::scheme::{BoundaryRule, DooSabin, Scheme};

use super::{BOUNDARY_RULES, DOO_SABIN, SCHEMES, SchemeName, choice};

/// A scheme and a vertex.
#[derive(Debug, clap::Args)]
pub struct Vertex {
    /// The subdivision scheme; whitney is that of triangles, bilinear that of quads
    #[arg(long, value_name = "NAME", default_value = "catmark", value_parser = choice(SCHEMES))]
    pub scheme: SchemeName,
    /// A boundary vertex, with the crease rule
    #[arg(long)]
    pub boundary: bool,
    /// catmark: the face weights of 2-forms
    #[arg(long, value_name = "WEIGHTS", default_value = "thesis", value_parser = choice(DOO_SABIN))]
    pub doo_sabin: DooSabin,
    /// loop and modified-loop: the face weights of 2-forms at the boundary
    #[arg(long, value_name = "RULE", default_value = "reflect", value_parser = choice(BOUNDARY_RULES))]
    pub half_box: BoundaryRule,
    /// Print one JSON object on stdout
    #[arg(long)]
    pub json: bool,
    /// No notes
    #[arg(long, short)]
    pub quiet: bool,
}

impl Vertex {
    /// The scheme with its weights.
    pub fn scheme(&self) -> Scheme {
        self.scheme.with(self.doo_sabin, self.half_box)
    }
}

#[derive(Debug, clap::Args)]
pub struct Spectrum {
    /// The number of faces at the vertex
    #[arg(long, short = 'k', value_name = "K", value_parser = value_parser!(u8).range(1..=64))]
    pub valence: u8,
    #[command(flatten)]
    pub vertex: Vertex,
}

#[derive(Debug, clap::Args)]
pub struct CharMap {
    /// The number of faces at the vertex, or several: 3:16
    #[arg(long, short = 'k', value_name = "K", value_parser = valences)]
    pub valence: Valences,
    /// Points along each side of a face at which the Jacobian is sampled
    #[arg(long, value_name = "N", default_value_t = 64, value_parser = value_parser!(u16).range(2..=1000))]
    pub samples: u16,
    /// A picture of the map: .svg or .png
    #[arg(long, short, value_name = "OUT")]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    pub vertex: Vertex,
}

#[derive(Debug, clap::Args)]
pub struct Basis {
    /// The number of faces at the vertex
    #[arg(long, short = 'k', value_name = "K", value_parser = value_parser!(u8).range(1..=64))]
    pub valence: u8,
    #[command(flatten)]
    pub cell: Cell,
    /// The picture: .svg or .png
    #[arg(long, short, value_name = "OUT")]
    pub output: PathBuf,
    #[command(flatten)]
    pub vertex: Vertex,
}

#[derive(Debug, clap::Args)]
pub struct Stencil {
    /// The number of faces at the vertex
    #[arg(long, short = 'k', value_name = "K", value_parser = value_parser!(u8).range(1..=64))]
    pub valence: u8,
    #[command(flatten)]
    pub cell: Cell,
    /// A picture: .svg or .png
    #[arg(long, short, value_name = "OUT")]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    pub vertex: Vertex,
}

/// A cell near the vertex.
#[derive(Debug, clap::Args)]
pub struct Cell {
    /// The degree of the form: 0 on vertices, 1 on edges, 2 on faces
    #[arg(long, value_name = "DEGREE", default_value_t = 1, value_parser = value_parser!(u8).range(0..=2))]
    pub degree: u8,
    /// Its cell, by number; the vertex, the first spoke and the first face are 0
    #[arg(long, value_name = "N", default_value_t = 0, conflicts_with = "edge")]
    pub cell: usize,
    /// Of a 1-form the edge, from one vertex to another: 0-1
    #[arg(long, value_name = "A-B", value_parser = edge)]
    pub edge: Option<[u32; 2]>,
}

/// One valence or a range, both ends included.
#[derive(Clone, Copy, Debug)]
pub struct Valences(pub u8, pub u8);

fn valences(typed: &str) -> Result<Valences, String> {
    let number = |text: &str| text.parse::<u8>().ok().filter(|k| (1..=64).contains(k));
    let found = match typed.split_once(':') {
        None => number(typed).map(|k| Valences(k, k)),
        Some((first, last)) => {
            number(first).zip(number(last)).filter(|(a, b)| a <= b).map(|(a, b)| Valences(a, b))
        }
    };
    found.ok_or_else(|| "write one number from 1 to 64, or two as 3:16".to_owned())
}

fn edge(typed: &str) -> Result<[u32; 2], String> {
    let ends = typed.split_once('-').and_then(|(a, b)| Some([a.parse().ok()?, b.parse().ok()?]));
    ends.ok_or_else(|| "write the numbers of its two vertices as 0-1".to_owned())
}

pub const SPECTRUM: &str = "\
The two rings of faces round a vertex depend, on the next level, on nothing else:
S0, S1 and S2 map them to themselves, and powers of these matrices say what the
limit is like at the vertex. Their eigenvalues are printed from the largest down,
by mode m: turned by one face, an eigenvector is multiplied by exp(2 pi i m / K);
at a boundary vertex, even or odd under reflection. Those of S1 are those of S0
without the 1 of constants (exact: differentials) and those of S2 (faces);
what is neither would be counted as rest.

`x 2` is how often an eigenvalue occurs. If it has fewer eigenvectors than that
the matrix is defective, and it says so.

Examples:
  formwork spectrum --scheme catmark --valence 5
  formwork spectrum --scheme modified-loop --valence 7 --json
  formwork spectrum --scheme loop --valence 4 --boundary";

pub const CHARMAP: &str = "\
The characteristic map is the limit surface of the subdominant eigenvectors of S0,
in the plane: what every surface looks like near such a vertex, but for an affine
map. A scheme is C1 there if it is regular and injective (Reif). Its Jacobian is
evaluated exactly at (N + 1)^2 points to a face, but for those which scaling
repeats; reported are the least and the largest determinant and by how much of a
turn the rim of the first ring runs round the vertex. That is a sample, no proof.

The picture has the control points of two rings and the refined grid on these,
darker on the first.

Examples:
  formwork charmap --scheme catmark --valence 5 -o charmap.svg
  formwork charmap --scheme modified-loop --valence 3:16
  formwork charmap --scheme loop --valence 3 --json -o charmap.png
  formwork charmap --scheme modified-loop --valence 5 --boundary -o half.png";

pub const BASIS: &str = "\
The form of one cell near the vertex, drawn in the characteristic chart: of a
1-form the factors of dx and dy, side by side, of a 0-form its value, of a 2-form
the factor of dx^dy. Blue is below 0, red above, lines are those of equal value.

Vertices are numbered ring by ring and counter-clockwise, 0 in the middle; edges
lead outwards or counter-clockwise. --json lists them.

Examples:
  formwork basis --scheme catmark --valence 5 --edge 0-1 -o spoke.svg
  formwork basis --scheme modified-loop --valence 5 --edge 1-2 -o rim.png
  formwork basis --scheme loop --valence 7 --degree 0 -o hat.png
  formwork basis --scheme catmark --valence 3 --degree 2 --json -o face.png";

pub const STENCIL: &str = "\
What a cell of the next level takes of the cells round the vertex: a row of S0,
S1 or S2, as the operators that refine meshes have it. The cell is named by its
number on the next level, where the rings have the same numbers: 0-1 is the half
of the first spoke at the vertex, 1-2 an edge inside the first face.

The picture shows the control mesh in the characteristic chart, the cell in red
and the weights on the cells that it takes them from, times a common factor;
edges are read in the direction of their arrows.

Examples:
  formwork stencil --scheme loop --valence 6 --edge 0-1
  formwork stencil --scheme catmark --valence 5 --edge 0-1 -o even.svg
  formwork stencil --scheme modified-loop --valence 7 --edge 1-2 -o odd.png
  formwork stencil --scheme loop --valence 3 --boundary --degree 2 -o face.png";
