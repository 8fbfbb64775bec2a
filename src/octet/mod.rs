//! Differential forms in space: octet subdivision of 0-, 1-, 2- and 3-forms on solids.
//!
//! A solid is a complex of tetrahedra and octahedra ([`Complex`]). The split makes four tetrahedra and an octahedron of a
//! tetrahedron, six octahedra and eight tetrahedra of an octahedron ([`Complex::split`], numbered as [`Parent`] says). Four
//! schemes `S0 .. S3` refine values on vertices, oriented edges, oriented triangles and oriented cells, so that
//!
//! ```text
//! d0' S0 = S1 d0        d1' S1 = S2 d1        d2' S2 = S3 d2
//! ```
//!
//! on every complex, with any boundary and any orientation, to rounding. This is chapter 6 and section 7.2 of Ke Wang's
//! thesis, "A Subdivision Approach to the Construction of Smooth Differential Forms"; where its printed formulas do not
//! hold, those here do, and the difference is named.
//!
//! # Linear schemes
//!
//! [`Linear`] states `S0 .. S3`, a family with one parameter `c`, by default -5. Inside a tetrahedron of the control mesh they
//! give its Whitney forms ([`WhitneyTet`]) exactly, for every `c`; inside an octahedron that is an affine image of the
//! regular one they reproduce `a + b x p` (1-forms) and `a + k p` (2-forms). Their limits are bounded for
//! -7 <= c <= 1 ([`spectra`]), but not continuous at the vertices of octahedra.
//!
//! # Smooth schemes
//!
//! After each split, `C_r = I + d K_{r-1} + K_r d` smooths ([`Smoothing`]). It commutes with `d` whatever `K` is, because
//! `d d = 0`:
//!
//! ```text
//! d C_r = d + d K_r d = C_{r+1} d
//! ```
//!
//! Where the complex is combinatorially the regular lattice, `K` is the homotopy of the lattice and `C_r` one and the
//! same convolution for all four degrees (7.1): in symbols `C(z) P_r(z)` with
//! `d(z) C(z) P_r(z) = C(z) P_{r+1}(z) d(z^2)` ([`regular`]; the thesis prints `d(z)` on both sides). That is so inside the
//! cells of the control mesh, away from their sides ([`Smoothing::is_regular_edge`] tells), and across the side between a
//! tetrahedron and an octahedron. Across the side of two tetrahedra it is not: they are mirror images.
//!
//! # How smooth it is
//!
//! Not proven here: commuting says nothing about smoothness. Measured (`cargo test --test octet jumps -- --nocapture`): the
//! largest jump between the Whitney forms of the tetrahedra at a vertex, from level to level, random forms.
//!
//! - On the lattice, so inside cells, the jumps of 1-, 2- and 3-forms halve on every level, as they do for forms with
//!   bounded derivatives.
//! - In the middle of a control edge with four to six tetrahedra round it they shrink too, but by less than half a level: from
//!   level 2 to 4 those of 1-forms by factors 0.71, 0.57 and 0.48, those of 2-forms by 0.60, 0.48 and 0.41. Whether they
//!   tend to 0 is open.
//! - At edges of three tetrahedra the jumps of 1-forms stay and those of 2- and 3-forms **grow**. Do not rely on
//!   continuous forms there.
//!
//! On the boundary, [`Boundary`] chooses between Loop's surface scheme and leaving it where it is.
//!
//! # From files to points
//!
//! [`Solid`] reads a grid of [`crate::io::volume`], [`to_grid`] writes one. [`Sampler`] evaluates forms at points: values, the
//! vector of a 1-form, the flux field of a 2-form, densities; curl and divergence are those of `d1` and `d2`. [`laws`]
//! measures.
//!
//! ```
//! use formwork::cochain::Cochain;
//! use formwork::octet::{Boundary, Complex, Hierarchy, Scheme};
//!
//! // Two tetrahedra on one face, refined twice and smoothed.
//! let complex = Complex::new(5, vec![[0, 1, 2, 3], [1, 2, 3, 4]], vec![])?;
//! let scheme = Scheme { smoothing: Some(Boundary::Loop), ..Scheme::default() };
//! let levels = Hierarchy::new(complex, scheme, 2)?;
//! let flux = Cochain::<2>::new(vec![1.0; levels.level(0).num_cells(2)]);
//!
//! // Refining its divergence is the divergence of its refinement.
//! let a = levels.subdivide(&flux.exterior_derivative(levels.level(0)));
//! let b = levels.subdivide(&flux).exterior_derivative(levels.finest());
//! assert!(a.values().iter().zip(b.values()).all(|(a, b)| (a - b).abs() < 1e-14));
//! # Ok::<(), formwork::octet::ComplexError>(())
//! ```

mod complex;
pub mod field;
mod hierarchy;
mod incidence;
mod lattice;
pub mod laws;
mod linear;
mod lookup;
mod patch;
pub mod regular;
mod sample;
mod smooth;
mod solid;
pub mod spectra;
mod split;
mod whitney;

pub use complex::{Complex, ComplexError, HalfFace, OCT_EDGES, OCT_FACES, TET_EDGES, TET_FACES};
pub use hierarchy::{Hierarchy, Scheme};
pub use linear::Linear;
pub use sample::Sampler;
pub use smooth::{Boundary, Smoothing};
pub use solid::{Solid, SolidError, SolidFields, to_grid};
pub use split::Parent;
pub use whitney::WhitneyTet;

/// No cell.
pub(crate) const NONE: u32 = u32::MAX;
