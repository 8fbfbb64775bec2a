use std::path::PathBuf;

use clap::value_parser;

use super::{Common, Writing};

pub const SOLVE: &str = "\
Problems for the Hodge Laplacian D = d delta + delta d of 0-, 1- or 2-forms on
the limit surface, solved with the smooth forms of the cage refined --level
times. The problem is JSON, one of
  {\"problem\": \"poisson\", \"solver\": \"direct\" or \"iterative\"}
  {\"problem\": \"hodge-laplace\", \"degree\": k}
  {\"problem\": \"eigenforms\", \"degree\": k, \"count\": n, \"show\": i}
  {\"problem\": \"diffusion\", \"degree\": k, \"step\": t, \"steps\": n,
   \"rule\": \"euler\" or \"crank-nicolson\"}
each with \"boundary\": \"natural\" or \"essential\" (functions 0 on it, 1-forms 0
along it). The data, D w = f or the form that diffuses, is the form of that degree
in --field or in the mesh file. What is harmonic in f has no solution; it is set
aside and its size is told. w is orthogonal to the harmonic forms. Factors take
memory: above a few hundred thousand unknowns solve Poisson's problem by
\"iterative\" (conjugate gradients), others from formwork masses, with PETSc.

The solution, the eigenform with number `show` (from 0), or the form after all
steps is written on the limit surface, as by the command limit.

Examples:
  formwork solve assets/genus2.obj --problem assets/genus2.problem.json \\
      --field assets/genus2.field.json -o solved.usda
  formwork solve assets/torus.obj --problem assets/eigenforms.problem.json \\
      --level 0 --json -o eigen.json
  formwork solve assets/genus2.obj --problem assets/diffusion.problem.json \\
      --field assets/genus2.field.json -o smooth.glb";

pub const MASSES: &str = "\
The matrices of the smooth forms on the limit surface, of the cage refined
--level times: derivatives d0 (E, V), d1 (F, E), masses M0, M1, M2, stiffnesses
K0 = d0' M1 d0 and K1 = d1' M2 d1.
  .npz    these, as formwork operators writes matrices, and edges (E, 2),
          face_sizes, face_vertices, positions (V, 3) of the control vertices
  .petsc  a PETSc binary file with d0, d1, M0, M1, M2, K0, K1 in this order, then
          the vectors d0 x, d0 y, d0 z, which hypre's AMS wants to know;
          examples/petsc_ams.py solves with it

Examples:
  formwork masses assets/torus.obj --level 1 -o torus.npz
  formwork masses assets/genus2.obj -o genus2.petsc";

#[derive(Debug, clap::Args)]
pub struct Solve {
    /// What is to be solved, as JSON
    #[arg(long, value_name = "SPEC.json")]
    pub problem: PathBuf,
    /// The data on the control cage, as JSON, instead of that in the mesh file
    #[arg(long, value_name = "FIELD.json")]
    pub field: Option<PathBuf>,
    /// How many times to refine; the solution is one of the finer forms
    #[arg(long, short, value_name = "N", default_value_t = 1, value_parser = value_parser!(u8).range(0..=15))]
    pub level: u8,
    /// The file to write: .usda, .glb, .gltf, .obj, .json or .npz
    #[arg(long, short, value_name = "OUT")]
    pub output: PathBuf,
    #[command(flatten)]
    pub common: Common,
}

impl Solve {
    pub fn writing(&self) -> Writing {
        Writing { field: None, output: self.output.clone(), frames: None, tangents: false }
    }
}

#[derive(Debug, clap::Args)]
pub struct Masses {
    /// How many times to refine
    #[arg(long, short, value_name = "N", default_value_t = 0, value_parser = value_parser!(u8).range(0..=15))]
    pub level: u8,
    /// The file to write: .npz or .petsc
    #[arg(long, short, value_name = "OUT")]
    pub output: PathBuf,
    #[command(flatten)]
    pub common: Common,
}
