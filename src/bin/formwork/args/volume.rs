//! `formwork volume`: solids of tetrahedra and octahedra.

use std::path::PathBuf;

use clap::{Subcommand, value_parser};
use formwork::octet::{Boundary, Linear, Scheme};

use super::{Names, choice};

#[derive(Debug, clap::Args)]
pub struct Volume {
    #[command(subcommand)]
    pub command: VolumeCommand,
}

#[derive(Debug, Subcommand)]
pub enum VolumeCommand {
    /// Count and classify a solid, and say how it will be refined
    #[command(after_help = INSPECT)]
    Inspect(InspectVolume),
    /// Refine a solid, with forms on it, and write the result
    #[command(after_help = SUBDIVIDE)]
    Subdivide(SubdivideVolume),
    /// Measure that refinement commutes with d
    #[command(after_help = VALIDATE)]
    Validate(ValidateVolume),
    /// Draw a form on a plane through a refined solid
    #[command(after_help = SLICE)]
    Slice(SliceVolume),
}

impl VolumeCommand {
    pub fn common(&self) -> &CommonVolume {
        match self {
            VolumeCommand::Inspect(args) => &args.common,
            VolumeCommand::Subdivide(args) => &args.common,
            VolumeCommand::Validate(args) => &args.common,
            VolumeCommand::Slice(args) => &args.common,
        }
    }
}

#[derive(Debug, clap::Args)]
pub struct InspectVolume {
    #[command(flatten)]
    pub common: CommonVolume,
}

#[derive(Debug, clap::Args)]
pub struct SubdivideVolume {
    /// How many times to refine; 0 writes the solid itself
    #[arg(long, short, value_name = "N", default_value_t = 2, value_parser = value_parser!(u8).range(0..=9))]
    pub levels: u8,
    #[command(flatten)]
    pub refining: Refining,
    /// The file to write: .vtu
    #[arg(long, short, value_name = "OUT.vtu")]
    pub output: PathBuf,
    #[command(flatten)]
    pub common: CommonVolume,
}

#[derive(Debug, clap::Args)]
pub struct ValidateVolume {
    /// How many times to refine
    #[arg(long, short, value_name = "N", default_value_t = 2, value_parser = value_parser!(u8).range(1..=9))]
    pub levels: u8,
    #[command(flatten)]
    pub scheme: SchemeOfVolume,
    #[command(flatten)]
    pub common: CommonVolume,
}

#[derive(Debug, clap::Args)]
pub struct SliceVolume {
    /// How many times to refine
    #[arg(long, short, value_name = "N", default_value_t = 2, value_parser = value_parser!(u8).range(0..=9))]
    pub levels: u8,
    #[command(flatten)]
    pub refining: Refining,
    /// The degree of the form to draw [the lowest there is from 1 on, else 0]
    #[arg(long, value_name = "K", value_parser = value_parser!(u8).range(0..=3))]
    pub form: Option<u8>,
    /// What the plane is square to
    #[arg(long, value_name = "X,Y,Z", default_value = "0,0,1", value_parser = direction, allow_hyphen_values = true)]
    pub normal: [f64; 3],
    /// Where the plane is: 0 touches the solid below, 1 above
    #[arg(long, value_name = "T", default_value_t = 0.5, value_parser = part)]
    pub at: f64,
    /// Width and height of the picture in pixels
    #[arg(long, value_name = "PIXELS", default_value_t = 800, value_parser = value_parser!(u32).range(64..=8192))]
    pub size: u32,
    /// The file to write: .png
    #[arg(long, short, value_name = "OUT.png")]
    pub output: PathBuf,
    #[command(flatten)]
    pub common: CommonVolume,
}

/// How to refine, and what.
#[derive(Debug, clap::Args)]
pub struct Refining {
    /// Forms on the solid, as JSON, instead of those that the mesh file holds
    #[arg(long, value_name = "FIELD.json")]
    pub field: Option<PathBuf>,
    #[command(flatten)]
    pub scheme: SchemeOfVolume,
}

#[derive(Debug, clap::Args)]
pub struct SchemeOfVolume {
    /// Smooth after each split; without it refinement is linear
    #[arg(long)]
    pub smooth: bool,
    /// With --smooth: whether the boundary is smoothed by itself, or stays where it is
    #[arg(long, value_name = "RULE", default_value = "loop", value_parser = choice(VOLUME_BOUNDARY))]
    pub boundary: Boundary,
    /// The parameter of the linear schemes in octahedra; 2-forms stay bounded for -7 <= C <= 1
    #[arg(long, value_name = "C", default_value_t = Linear::default().c, value_parser = parameter, allow_hyphen_values = true)]
    pub c: f64,
}

impl SchemeOfVolume {
    pub fn scheme(&self) -> Scheme {
        Scheme { linear: Linear { c: self.c }, smoothing: self.smooth.then_some(self.boundary) }
    }
}

#[derive(Debug, clap::Args)]
pub struct CommonVolume {
    /// The solid: .msh (Gmsh 2.2 or 4.1) or .vtu
    #[arg(value_name = "MESH")]
    pub mesh: PathBuf,
    /// Print one JSON object on stdout
    #[arg(long)]
    pub json: bool,
    /// No progress bar and no notes
    #[arg(long, short)]
    pub quiet: bool,
}

pub const VOLUME_BOUNDARY: Names<Boundary> = &[("loop", Boundary::Loop), ("fixed", Boundary::Fixed)];

fn parameter(typed: &str) -> Result<f64, String> {
    let c = typed.parse::<f64>().ok().filter(|c| (-7.0..=1.0).contains(c));
    c.ok_or_else(|| "write a number from -7 to 1: beyond, refined 2-forms grow without bound".to_owned())
}

fn part(typed: &str) -> Result<f64, String> {
    typed
        .parse::<f64>()
        .ok()
        .filter(|t| (0.0..=1.0).contains(t))
        .ok_or_else(|| "write a number from 0 to 1".to_owned())
}

fn direction(typed: &str) -> Result<[f64; 3], String> {
    let numbers: Vec<f64> = typed.split(',').filter_map(|word| word.trim().parse().ok()).collect();
    let length: f64 = numbers.iter().map(|x| x * x).sum();
    match <[f64; 3]>::try_from(numbers) {
        Ok(direction) if length.is_finite() && length > 0.0 => Ok(direction),
        _ => Err("write three numbers, not all 0, as 0,0,1".to_owned()),
    }
}

pub const HELP: &str = "\
A solid is refined into octahedra and tetrahedra: a tetrahedron into four and an
octahedron, an octahedron into six and eight tetrahedra. Forms of degree 0 to 3
on its vertices, edges, triangles and cells are refined along, so that
d S = S d exactly.

Examples:
  formwork volume inspect assets/ball.msh
  formwork volume subdivide assets/ball.msh \\
      --field assets/ball.field.json --levels 2 -o ball.vtu
  formwork volume validate assets/ball.msh --smooth
  formwork volume slice assets/ball.msh \\
      --field assets/ball.field.json -o ball.png";

const INSPECT: &str = "\
Pyramids are read in pairs: two on one base are an octahedron.

Examples:
  formwork volume inspect assets/ball.msh
  formwork volume inspect assets/octets.vtu --json";

const SUBDIVIDE: &str = "\
The field file is JSON. Indices start at 0; what is not listed has the value 0:
  {\"vertices\":  [[v, value], ...],         0-form
   \"edges\":     [[a, b, value], ...],      1-form: circulation from a to b
   \"triangles\": [[a, b, c, value], ...],   2-form: flux, counter-clockwise side
   \"cells\":     [[cell, value], ...]}      3-form: integral
Without --field, forms of the mesh file are refined: point data form0, cell data
form1 on lines, form2 on triangles, form3 on cells.

What is written: VTK's unstructured grid, for ParaView and meshio. Line cells hold
the 1-form (form1), triangles the 2-form (form2), cells the 3-form (form3) and its
density; form1Vector and form2Vector are vectors at the centroids of cells. An
octahedron is two pyramids, with its number in `octahedron`. NaN where there is no
value.

Examples:
  formwork volume subdivide assets/ball.msh \\
      --field assets/ball.field.json --levels 1 -o ball.vtu
  formwork volume subdivide assets/octets.vtu --smooth -l 1 -o smooth.vtu
  formwork volume subdivide assets/octets.vtu --smooth --boundary fixed \\
      -l 1 -o fixed.vtu";

const VALIDATE: &str = "\
Random cochains are refined and derived in both orders on every level.

Examples:
  formwork volume validate assets/ball.msh --levels 2
  formwork volume validate assets/octets.vtu --smooth --c -6";

const SLICE: &str = "\
Colour is the length of the vector (1- and 2-forms) or the value (0- and 3-forms),
dark for small; the texture runs along the part of the vector in the plane; thin
lines are the cells of the control mesh, where the plane cuts them.

Examples:
  formwork volume slice assets/ball.msh \\
      --field assets/ball.field.json -o ball.png
  formwork volume slice assets/ball.msh --field assets/ball.field.json \\
      --smooth --normal 1,0,0 --at 0.4 --size 300 -o side.png";
