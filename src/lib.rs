//! Smooth differential forms on subdivision surfaces, for OpenSubdiv pipelines.
//!
//! OpenSubdiv refines values on vertices (0-forms). This crate also refines values on oriented edges
//! (1-forms: tangent vector fields, circulations) and on faces (2-forms: fluxes, densities), so that the
//! three commute with the exterior derivative exactly:
//!
//! ```text
//! d0' S0 = S1 d0        d1' S1 = S2 d1
//! ```
//!
//! It follows Ke Wang, "A Subdivision Approach to the Construction of Smooth Differential Forms" (PhD
//! thesis, 2008), and covers every mesh that OpenSubdiv's Catmull-Clark, Loop and bilinear schemes take.
//!
//! # A tour
//!
//! A [`topology::Cage`] is a checked control mesh. A [`hierarchy::Hierarchy`] refines it and carries
//! [`cochain::Cochain`]s from level to level, without storing matrices; [`hierarchy::Hierarchy::operators`]
//! gives the matrices to those who want them.
//!
//! ```
//! use formwork::cochain::Cochain;
//! use formwork::hierarchy::Hierarchy;
//! use formwork::scheme::Scheme;
//! use formwork::topology::{Cage, Descriptor};
//!
//! let cube = Cage::new(Descriptor {
//!     num_vertices: 8,
//!     face_sizes: vec![4; 6],
//!     face_vertices: vec![0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 1, 3, 7, 5, 3, 2, 6, 7, 2, 0, 4, 6],
//!     ..Default::default()
//! })?;
//! let hierarchy = Hierarchy::new(&cube, Scheme::default(), 2)?;
//!
//! // A circulation of 1 along every edge of the cube, in the edge's direction.
//! let form = Cochain::<1>::new(vec![1.0; 12]);
//! let smooth = hierarchy.subdivide(&form);
//! assert_eq!(smooth.len(), hierarchy.finest().mesh().num_edges());
//!
//! // Refining its derivative is deriving its refinement.
//! let a = hierarchy.subdivide(&form.exterior_derivative(hierarchy.level(0).mesh()));
//! let b = smooth.exterior_derivative(hierarchy.finest().mesh());
//! assert!(a.values().iter().zip(b.values()).all(|(a, b)| (a - b).abs() < 1e-14));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A [`limit::Limit`] says what a cochain becomes in the limit of refinement, and a [`limit::LimitSurface`] evaluates it,
//! and the surface, at points. On it, [`fem`] has the inner products of forms, and [`design`] decomposes fields and
//! makes new ones.
//!
//! [`analysis`] has the spectra of a scheme at a vertex, and characteristic maps.
//! [`view`] shows all of it, as a page for a browser and as a picture.
//!
//! In space, [`octet`] does the same for 0-, 1-, 2- and 3-forms on tetrahedra and octahedra.
//!
//! Modules import downwards only: `memory`, `sparse`, `symbol`, `topology`, `osd`; then `cochain`, `field`, `io`; then
//! `scheme`; `hierarchy`, `octet`; `limit`; `laws`, `analysis`, `fem`, `design`; `view`. `ARCHITECTURE.md` draws
//! them.

#![deny(unsafe_code)]
#![warn(missing_docs)]

pub mod analysis;
pub mod cochain;
pub mod design;
pub mod fem;
pub mod field;
pub mod hierarchy;
pub mod io;
pub mod laws;
pub mod limit;
pub mod memory;
pub mod octet;
pub mod osd;
pub mod scheme;
pub mod sparse;
pub mod symbol;
pub mod topology;
pub mod view;

/// The crate of the vectors in the public API, for callers to use in the same version.
pub use nalgebra;
/// The crate of the matrices in the public API, likewise.
pub use sprs;

/// Runs the examples of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

/// Runs the examples of the book in `docs/`.
#[cfg(doctest)]
mod book {
    #[doc = include_str!("../docs/src/vertex.md")]
    struct Vertex;
    #[doc = include_str!("../docs/src/from-opensubdiv.md")]
    struct FromOpenSubdiv;
    #[doc = include_str!("../docs/src/from-a-paper.md")]
    struct FromAPaper;
}
