//! Schemes: what makes a subdivision of forms smooth, as two small tables over the Whitney scheme.
//!
//! For **any** local `H0: C1(K) -> C0(K')` and `H1: C2(K) -> C1(K')`, with `W0, W1, W2` the lowest-order
//! (Whitney) scheme of the split,
//!
//! ```text
//! S0 = W0 + H0 d0        S1 = W1 + d0' H0 + H1 d1        S2 = W2 + d1' H1            (A)
//! ```
//!
//! commutes with the exterior derivative identically, `d0' S0 = S1 d0` and `d1' S1 = S2 d1`, because
//! `d d = 0`; and the columns of `S2` sum to 1 because those of `W2` do. Conversely `S0` determines `H0`
//! (the displacement of each child vertex from its Whitney position, lifted to edges) and `H1` is the
//! freedom that shapes `S2`. So a scheme *is* the two tables of its [`Homotopy`]: nothing is solved, and
//! irregular vertices may lie side by side. Ke Wang's thesis states the commutative relations as (3.56).
//!
//! - [`whitney`]: `W0, W1, W2` and the lifts of a face.
//! - [`catmark`]: Catmull-Clark with Doo-Sabin; [`doo_sabin`]: its face weights.
//! - [`loop_`]: Loop with half-box splines; [`half_box`]: its face weights; [`modified_loop`]: the
//!   thesis' vertex rule.
//! - [`correction`]: the part of `H1` at a vertex that reaches the wanted face weights, by sectors.

pub mod catmark;
pub mod correction;
pub mod doo_sabin;
pub mod half_box;
pub mod loop_;
pub mod modified_loop;
pub(crate) mod sector;
mod tables;
pub mod whitney;

pub(crate) use correction::FaceRows;
pub use doo_sabin::DooSabin;
pub use half_box::BoundaryRule;
pub use loop_::Variant;

use crate::osd::{Masks, OsdScheme};
use crate::sparse::{Csr, assemble};
use crate::topology::{Mesh, Split, SplitKind};

/// A subdivision scheme for 0-, 1- and 2-forms.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheme {
    /// Catmull-Clark on vertices (OpenSubdiv's `SCHEME_CATMARK`, every option), Doo-Sabin on faces.
    Catmark(DooSabin),
    /// Loop on the vertices of a triangle mesh (OpenSubdiv's `SCHEME_LOOP`, every option) or the thesis'
    /// modification of it, half-box splines on faces, with a rule for the faces at boundaries and creases.
    Loop(Variant, BoundaryRule),
    /// The lowest-order scheme, piecewise linear: triangles into four, if all faces are triangles, else
    /// quads into four.
    Whitney,
    /// OpenSubdiv's `SCHEME_BILINEAR`: the lowest-order scheme of the quad split, on any polygons.
    Bilinear,
}

impl Default for Scheme {
    fn default() -> Self {
        Scheme::Catmark(DooSabin::default())
    }
}

/// A mesh that a scheme does not take.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)] // the messages say what the fields are
pub enum SchemeError {
    #[error(
        "face {face} has {size} vertices: Loop's schemes take triangles only, use catmark or triangulate the mesh"
    )]
    NotATriangle { face: u32, size: u32 },
    #[error(
        "face {face} has {size} vertices: the Whitney scheme takes all triangles or all quads, use bilinear for other meshes"
    )]
    Mixed { face: u32, size: u32 },
}

impl SchemeError {
    /// The face that the scheme does not take.
    pub fn face(&self) -> u32 {
        match *self {
            SchemeError::NotATriangle { face, .. } | SchemeError::Mixed { face, .. } => face,
        }
    }
}

/// The two tables of a scheme from one level to the next, over the Whitney scheme of the split.
#[derive(Clone, Debug)]
pub struct Homotopy {
    /// `(|V'|, |E|)`: the displacement of each child vertex from its Whitney position, as a combination of
    /// oriented edges.
    pub h0: Csr,
    /// `(|E'|, |F|)`: what each child edge (in its own direction) takes of the faces beside it.
    pub h1: Csr,
}

impl Scheme {
    /// How this scheme splits a mesh whose faces have these sizes.
    ///
    /// # Errors
    /// If the scheme does not take a face.
    pub fn split(self, face_sizes: &[u32]) -> Result<SplitKind, SchemeError> {
        let other_than =
            |n: u32| face_sizes.iter().position(|&size| size != n).map(|f| (f as u32, face_sizes[f]));
        match self {
            Scheme::Catmark(_) | Scheme::Bilinear => Ok(SplitKind::Quad),
            Scheme::Loop(..) => match other_than(3) {
                None => Ok(SplitKind::Triangle),
                Some((face, size)) => Err(SchemeError::NotATriangle { face, size }),
            },
            Scheme::Whitney => match (other_than(3), other_than(4)) {
                (None, _) => Ok(SplitKind::Triangle),
                (_, None) => Ok(SplitKind::Quad),
                (Some(_), Some((face, size))) => Err(SchemeError::Mixed { face, size }),
            },
        }
    }

    /// The scheme of OpenSubdiv that refines the topology for this one, and gives it its weights.
    pub fn opensubdiv(self, split: SplitKind) -> OsdScheme {
        match (self, split) {
            (Scheme::Catmark(_), _) => OsdScheme::Catmark,
            (Scheme::Loop(..), _) | (Scheme::Whitney, SplitKind::Triangle) => OsdScheme::Loop,
            (Scheme::Bilinear, _) | (Scheme::Whitney, SplitKind::Quad) => OsdScheme::Bilinear,
        }
    }

    /// Whether `S0` is that scheme of OpenSubdiv, or one of our own on the same topology.
    pub fn is_opensubdivs(self, split: SplitKind) -> bool {
        match self {
            Scheme::Catmark(_) | Scheme::Bilinear => true,
            Scheme::Loop(variant, _) => variant == Variant::Loop,
            Scheme::Whitney => split == SplitKind::Quad,
        }
    }

    /// The tables of this scheme for one split of `mesh`, with OpenSubdiv's weights `masks`.
    ///
    /// # Panics
    /// If the scheme does not take the mesh.
    pub fn homotopy(self, split: SplitKind, mesh: &Mesh, masks: &Masks) -> Homotopy {
        match self {
            Scheme::Catmark(weights) => catmark::homotopy(mesh, masks, weights),
            Scheme::Loop(variant, boundary) => loop_::homotopy(mesh, masks, variant, boundary),
            Scheme::Whitney | Scheme::Bilinear => {
                let split = Split::new(split, mesh);
                Homotopy {
                    h0: assemble((split.num_children(0), mesh.num_edges()), |_, _| ()),
                    h1: assemble((split.num_children(1), mesh.num_faces()), |_, _| ()),
                }
            }
        }
    }
}
