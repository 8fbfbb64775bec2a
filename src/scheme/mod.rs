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
//! - [`regular`]: what all this comes to where the mesh is regular.
//! - [`correction`]: the part of `H1` at a vertex that reaches the wanted face weights, by sectors.

pub mod catmark;
pub mod correction;
pub mod doo_sabin;
pub mod half_box;
pub mod loop_;
pub mod modified_loop;
pub mod regular;
mod regular_cells;
pub(crate) mod sector;
mod tables;
pub(crate) mod triangle_rows;
pub mod whitney;

pub(crate) use correction::FaceRows;
pub use doo_sabin::DooSabin;
pub use half_box::BoundaryRule;
pub use loop_::Variant;
pub use regular::Regular;

use rayon::prelude::*;

use crate::memory;
use crate::osd::{Masks, OsdScheme};
use crate::sparse::{Exceptions, Row};
use crate::topology::{ChildEdge, HalfEdge, Mesh, Parent, Split, SplitKind};

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

/// The two tables of a scheme from one level to the next, over the Whitney scheme of the split: a formula,
/// and the rows that are exceptions to it.
#[derive(Clone, Debug)]
pub struct Homotopy {
    /// The rows of regular cells.
    pub regular: Regular,
    /// `(|V'|, |E|)`: the displacement of each child vertex from its Whitney position, as a combination of
    /// oriented edges.
    pub h0: Exceptions,
    /// `(|E'|, |F|)`: what each child edge (in its own direction) takes of the faces beside it.
    pub h1: Exceptions,
}

impl Homotopy {
    /// Adds `scale` times the row of `H0` of the child vertex of a cell.
    pub fn add_h0_row(&self, mesh: &Mesh, split: &Split, child: Parent, scale: f64, row: &mut Row) {
        self.for_each_h0(mesh, split, child, |h, weight| row.add(h.edge(), scale * weight * h.sign()));
    }

    /// Adds `scale` times the row of `H1` of a child edge.
    pub fn add_h1_row(&self, mesh: &Mesh, split: &Split, child: ChildEdge, scale: f64, row: &mut Row) {
        self.for_each_h1(mesh, split, child, |face, weight| row.add(face, scale * weight));
    }

    /// Visits the terms of the row of `H1` of a child edge.
    pub(crate) fn for_each_h1(
        &self,
        mesh: &Mesh,
        split: &Split,
        child: ChildEdge,
        mut visit: impl FnMut(u32, f64),
    ) {
        match self.h1.get(split.edge_of(child) as usize) {
            Some((faces, weights)) => faces.iter().zip(weights).for_each(|(&f, &weight)| visit(f, weight)),
            None => self.regular.h1(mesh, child, visit),
        }
    }

    /// Visits the terms of the row of `H0` of a child vertex, as half-edges.
    pub(crate) fn for_each_h0(
        &self,
        mesh: &Mesh,
        split: &Split,
        child: Parent,
        mut visit: impl FnMut(HalfEdge, f64),
    ) {
        match self.h0.get(split.vertex_of(child) as usize) {
            Some((edges, weights)) => {
                edges.iter().zip(weights).for_each(|(&e, &weight)| visit(HalfEdge::new(e, true), weight));
            }
            None => self.regular.h0(mesh, child, visit),
        }
    }
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

    /// Which child vertices of `mesh` are certain to be regular, before their weights are known: those whose row of `H0`
    /// follows the formula. Sharpness only decays, and rings of children do not meet themselves where those of their parents do
    /// not. Empty if that says nothing.
    pub fn regular_children(self, mesh: &Mesh, split: &Split, homotopy: &Homotopy) -> Vec<bool> {
        let tells = match self {
            Scheme::Catmark(_) => mesh.uniform_face_size() == Some(4),
            Scheme::Loop(variant, _) => variant == Variant::Loop,
            // The modified rules reach from vertices to the edges beside them.
            Scheme::Whitney | Scheme::Bilinear => false,
        };
        let vertices = if tells { split.num_children(0) } else { 0 };
        let regular = |vertex| homotopy.h0.position(vertex).is_none();
        memory::collect((0..vertices).into_par_iter().map(regular))
    }

    /// The tables of this scheme for one split of `mesh`, with OpenSubdiv's weights `masks`, in which those of vertices
    /// `known` to be regular ([`Scheme::regular_children`] of the level above; empty if none is) may be missing.
    ///
    /// # Panics
    /// If the scheme does not take the mesh.
    pub fn homotopy(self, split: SplitKind, mesh: &Mesh, masks: &Masks, known: &[bool]) -> Homotopy {
        match self {
            Scheme::Catmark(weights) => catmark::homotopy(mesh, masks, known, weights),
            Scheme::Loop(variant, boundary) => loop_::homotopy(mesh, masks, known, variant, boundary),
            Scheme::Whitney | Scheme::Bilinear => {
                let split = Split::new(split, mesh);
                let none = |rows, columns| Exceptions::collect((rows, columns), |_| false, |_, _| ());
                Homotopy {
                    regular: Regular::Whitney,
                    h0: none(split.num_children(0), mesh.num_edges()),
                    h1: none(split.num_children(1), mesh.num_faces()),
                }
            }
        }
    }
}
