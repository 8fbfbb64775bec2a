//! What a scheme does round one vertex: the matrices that map its rings to themselves, their eigenvalues, and the
//! characteristic map.
//!
//! Cells far enough from everything else that is irregular are refined alike on every level, so the behaviour of the
//! limit at a vertex is that of the powers of three square matrices: `S0`, `S1` and `S2` on the `r` rings of faces
//! round it, from one level to the next ([`Ring`]). They are the rows of the ordinary operators on a model cage; nothing is
//! written down twice.
//!
//! On a disk the complex of vertices, edges and faces is exact, so that with `d S = S d` the eigenvalues of `S1` are those of
//! `S0` without the 1 of the constants, with differentials of its eigenvectors, and those of `S2` (Ke Wang's thesis, Lemma
//! 3.32). [`Spectrum`] computes the three independently of each other and says which is which.
//!
//! The rings are symmetric, and the matrices are split by it first: at an interior vertex by Fourier modes, at a boundary
//! vertex into an even and an odd part ([`Symmetry`]). So equal eigenvalues of different modes stay apart, and every
//! eigenvalue is known with its mode.
//!
//! [`CharacteristicMap`] is the limit surface whose control points are the subdominant eigenvectors of `S0` (Reif 1995),
//! evaluated exactly. Surfaces look like it near the vertex, up to an affine map, so forms are drawn on it.

mod charmap;
mod lattice;
mod ring;
mod spectrum;
mod symmetry;

pub use charmap::{CharacteristicMap, Regularity, Sample};
pub use ring::Ring;
pub use spectrum::{EdgeEigenvalue, Eigenvalue, Spectrum};
pub use symmetry::{Block, Symmetry};

use crate::hierarchy::HierarchyError;
use crate::limit::SurfaceError;

/// Why a vertex cannot be analysed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)] // the messages say what the fields are
pub enum AnalysisError {
    #[error("valence {faces}: an interior vertex has from 3 to {most} faces, a boundary vertex from 1")]
    Valence { faces: usize, most: usize },
    #[error("{rings} rings: from 2 to {most} map to themselves and fit memory")]
    Rings { rings: usize, most: usize },
    #[error("the eigenvalues of a block of {size} rows did not converge: choose another valence")]
    NoConvergence { size: usize },
    #[error(
        "there is no characteristic map: a subdominant eigenvalue has more than one eigenvector, or a chain of them; choose another valence or scheme"
    )]
    NoCharacteristicMap,
    #[error(transparent)]
    Hierarchy(#[from] HierarchyError),
    #[error(transparent)]
    Surface(#[from] SurfaceError),
}
