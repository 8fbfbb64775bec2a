//! Combinatorics without positions: the control cage, the oriented complex, its fans and its split.
//!
//! - [`Descriptor`]: what a user hands in, plain data. [`Cage`]: the same, checked.
//! - [`Mesh`]: vertices, oriented edges and oriented faces of one level, with the ordered fans round
//!   every vertex and the exterior derivatives `d0`, `d1`.
//! - [`Split`]: how the cells of one level become those of the next, and how they are numbered.
//! - [`Survey`]: counts, Euler characteristic, boundary loops, genus.

mod build;
mod cage;
mod descriptor;
mod faces;
mod half_edge;
mod mesh;
mod refine;
mod split;
mod survey;

pub use build::MeshError;
pub use cage::{Cage, Element, MAX_FACE_SIZE, MAX_VALENCE, TopologyError};
pub use descriptor::{
    BoundaryInterpolation, CollapseReport, Corner, Crease, CreasingMethod, Descriptor, TriangleSubdivision,
};
pub use half_edge::HalfEdge;
pub(crate) use mesh::wrap;
pub use mesh::{Fan, Mesh};
pub use split::{ChildEdge, Parent, Split, SplitKind};
pub use survey::Survey;
