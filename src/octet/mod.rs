//! octet
mod complex;
mod hierarchy;
mod incidence;
mod lattice;
mod linear;
mod lookup;
mod patch;
mod smooth;
mod split;

pub use complex::{Complex, ComplexError, HalfFace, OCT_EDGES, OCT_FACES, TET_EDGES, TET_FACES};
pub use hierarchy::{Hierarchy, Scheme};
pub use linear::Linear;
pub use smooth::{Boundary, Smoothing};
pub use split::Parent;

/// No cell.
pub(crate) const NONE: u32 = u32::MAX;
