//! Design of tangent fields: a few features placed by hand, and a smooth 1-form on the whole surface that has them.
//!
//! Every 1-cochain of the control cage is, in one way only,
//!
//! ```text
//! c = d0 a + k + h        exact + coexact + harmonic,        d1 h = 0,        d0' M1 k = d0' M1 h = 0
//! ```
//!
//! orthogonal in an inner product `M1` ([`InnerProduct`]): that of the limit forms on the limit surface, or the thesis'
//! cotangents on the control mesh. Since the limit forms are a complex with `d0` and `d1` on coefficients, `d0' M1 d0` is
//! all that has to be factorised, once ([`Hodge`]):
//!
//! ```text
//! a = (d0' M1 d0)^-1 d0' M1 c        h = sum_i <c, h_i> h_i        k = c - d0 a - h
//! ```
//!
//! with constants pinned at one vertex of each component, and harmonic forms `h_i` made of the generators that a tree and
//! a cotree leave ([`Homology`]). No coexact system is ever solved, and nothing singular.
//!
//! A field with prescribed curl comes the same way: [`Homology::with_curl`] finds some `c` with `d1 c = curl` along the
//! cotree, and what is exact or harmonic in it is replaced by what is wanted. [`Spec`] has the features, [`Hodge::design`]
//! makes the field, [`singularities`] finds its zeros and [`streamlines`] follows it.

mod boundary;
mod constraints;
mod file;
mod hodge;
mod homology;
mod product;
mod singularities;
mod spec;
mod streamlines;
mod wishes;

pub use boundary::{Condition, boundary_loops};
pub use constraints::Field;
pub use file::SpecError;
pub use hodge::{Decomposition, Hodge};
pub use homology::Homology;
pub use product::{InnerProduct, Metric};
pub use singularities::{Singularities, Singularity, singularities};
pub use spec::{EdgeValue, Place, Region, Source, Spec, VectorAt, Vortex};
pub use streamlines::{End, Streamline, Tracing, seeds, streamlines};

use crate::hierarchy::HierarchyError;
use crate::limit::PointError;

/// Why a field cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)] // the messages say what the fields are
pub enum DesignError {
    #[error(
        "edge ({}, {}) has {faces} faces, or two that disagree in direction: fields are designed on manifold surfaces, separate the sheets",
        .vertices[0], .vertices[1]
    )]
    NonManifold { vertices: [u32; 2], faces: usize },
    #[error("face {face} has no area: move its vertices apart")]
    NoArea { face: u32 },
    #[error(
        "the surface has a sliver or a fold that makes its energy singular near vertex {vertex}: mend the cage"
    )]
    Singular { vertex: u32 },
    #[error(
        "the {what} of the component of {cell} sum to {sum}, where nothing can leave it: take {sum} off, or ask for balance"
    )]
    Unbalanced { what: &'static str, cell: String, sum: f64 },
    #[error("there is no {what} {number}: the cage has {count}, numbered from 0")]
    NoCell { what: &'static str, number: u32, count: usize },
    #[error("vertices {} and {} share no edge: name the ends of an edge", .vertices[0], .vertices[1])]
    NoEdge { vertices: [u32; 2] },
    #[error(
        "the vector at face {face} has no part along the surface, or there is no tangent plane: give another"
    )]
    NoTangent { face: u32 },
    #[error("{what} {index}: {value} is not a number that can be used here: correct it")]
    BadNumber { what: &'static str, index: usize, value: f64 },
    #[error(
        "the prescribed vectors and edge values contradict each other or the boundary conditions (off by {off:.1e}): drop one, or give them weights"
    )]
    Contradiction { off: f64 },
    #[error("boundary loop {number} is given a condition, and there are {count}: loops are numbered from 0")]
    NoLoop { number: usize, count: usize },
    #[error(
        "generator {number} is given a coefficient, and there are {count}: generators are numbered from 0"
    )]
    NoGenerator { number: usize, count: usize },
    #[error(transparent)]
    Point(#[from] PointError),
    #[error(transparent)]
    Hierarchy(#[from] HierarchyError),
}
