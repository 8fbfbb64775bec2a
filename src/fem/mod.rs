//! Finite elements whose basis are the smooth forms of a subdivision surface: masses and stiffnesses in the metric of
//! the limit surface.
//!
//! With `phi_v`, `omega_e`, `rho_f` the limit forms of one vertex, edge and face (all other coefficients 0) and `g` the
//! metric of the limit surface in the parameters of a face,
//!
//! ```text
//! M0 = int phi_v phi_w sqrt(g)        M1 = int g^ij omega_i omega'_j sqrt(g)        M2 = int rho_f rho_h / sqrt(g)
//! ```
//!
//! are the inner products of forms, over the cochains of the control cage. The spaces are a complex, `d` is `d0` and `d1`
//! on coefficients, so the stiffnesses are `d0' M1 d0` (Laplace's) and `d1' M2 d1` ([`stiffness`]) and nothing else is
//! integrated.
//!
//! An element is a face of the finest level of a [`LimitSurface`](crate::limit::LimitSurface): [`Elements::local`] is its matrix, by quadrature of
//! basis forms that all faces with like surroundings share. Rows are then gathered from elements in the order of the
//! elements, so the sums are bitwise the same for any number of threads, and symmetric to the bit. Where the surface
//! had to be refined, matrices `M` of the finest level are pulled back to the cage by its own `S`, as `S' M S`.
//!
//! Metrics other than the surface's own are [`Metric`]s; domains are faces, [`Elements::within`]. The forms are smooth enough
//! for the energies of `Delta` and of `Delta Delta`, so boundary value problems with all of a form prescribed can be solved
//! for it alone ([`BoundaryProblem`]); [`MixedProblem`] is right with natural data and at any corner, and [`study`] measures
//! how fast either converges.
//!
//! Matrices are singular on purpose where the basis is dependent: on regular triangle meshes some combinations of
//! edges (`1, 1, -1` along the three directions), and the 2-forms they bound, have the limit 0. `d0' M1 d0` has
//! nothing in its kernel but constants.

mod bvp;
mod complex;
mod diffusion;
mod element;
mod error;
mod laplace;
mod metric;
mod pcg;
mod problem;
mod quadrature;
mod resolvent;
mod spectrum;
pub mod study;

pub use bvp::{
    BoundaryProblem, Data, Errors, Imposed, MixedErrors, MixedProblem, MixedSolution, Operator, Solved,
    SpaceForm,
};
pub use complex::{HilbertComplex, interior};
pub use diffusion::{Diffusion, TimeRule};
pub use element::Elements;
pub use error::FemError;
pub use laplace::{HodgeLaplace, Solution, poisson};
pub use metric::Metric;
pub use pcg::{Iterated, conjugate_gradients};
pub use problem::{Problem, ProblemError, Task};
pub use quadrature::{Quadrature, gauss, square, triangle};
pub use resolvent::Resolvent;
pub use spectrum::Spectrum;

use crate::sparse::{Csr, multiply};

/// `d' M d`: the stiffness of a mass and an exterior derivative.
///
/// # Panics
/// If the matrices do not fit.
pub fn stiffness(mass: &Csr, d: &Csr) -> Csr {
    sandwich(d, mass)
}

/// `a' M a`.
pub(crate) fn sandwich(a: &Csr, mass: &Csr) -> Csr {
    multiply(&transpose(a), &multiply(mass, a))
}

/// The transpose, by rows.
pub(crate) fn transpose(a: &Csr) -> Csr {
    a.transpose_view().to_csr()
}
