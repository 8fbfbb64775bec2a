use crate::sparse::NoFactors;

/// Why a system of finite elements cannot be solved.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)] // the messages say what the fields are
pub enum FemError {
    #[error("edge {edge} has {faces} faces: forms are solved for on manifold surfaces, separate the sheets")]
    NonManifold { edge: u32, faces: usize },
    #[error("there are no {degree}-forms: the boundary condition leaves none, take a finer mesh")]
    Empty { degree: usize },
    #[error(
        "the system is singular: a face has no area, or the basis is dependent (on triangles that are all regular); mend the cage or take quads"
    )]
    Singular,
    #[error("the system is too large for its factors: solve it by iteration, or outside")]
    TooLarge,
    #[error(
        "{found} harmonic {degree}-forms were found where the mesh has {expected}: its masses are not those of a complex, or the surface is degenerate"
    )]
    Harmonic { degree: usize, expected: usize, found: usize },
    #[error(
        "{what} did not converge in {iterations} iterations: the surface is degenerate, or the tolerance too small"
    )]
    NoConvergence { what: &'static str, iterations: usize },
}

impl From<NoFactors> for FemError {
    fn from(error: NoFactors) -> Self {
        match error {
            NoFactors::Singular => FemError::Singular,
            NoFactors::TooLarge => FemError::TooLarge,
        }
    }
}
