//! Loop with half-box splines: every mesh that OpenSubdiv's `SCHEME_LOOP` takes, and the thesis' modified
//! Loop on the same meshes.
//!
//! With OpenSubdiv's masks (`o_g` the vertex of triangle `g` opposite to `e`)
//!
//! ```text
//! m_e = th_a a + th_b b + sum_g tau_{e,g} o_g          v' = w_v v + sum_i a_i w_i
//! ```
//!
//! the tables are
//!
//! ```text
//! H0(m_e) = sum_g tau_{e,g} (c_{a o_g} + c_{b o_g})/2 + (th_b - th_a)/2 c_ab
//! H0(v')  = sum_i a_i c_{v w_i}
//! H1(v -> m_e): see super::correction, with u_f = 1 and alpha' = (3/16, 1/32, 0, .., 0, 1/32)
//! H1(m(v,w0) -> m(v,w1)) = 1/32 sum over the two edges E of F at v, G across E: (1 - s_E)(D_F - D_G)
//! ```
//!
//! `s_E` being the sharpness of `E` clamped to [0, 1]; OpenSubdiv has blended it into `tau_{E,F} = (1 - s_E)/8`.
//! In the regular interior this is half-box and box-spline convolution, see [`crate::symbol`].

use super::half_box::{BoundaryRule, HalfBox};
use super::modified_loop::modified_masks;
use super::{Homotopy, tables};
use crate::osd::Masks;
use crate::sparse::Row;
use crate::topology::{HalfEdge, Mesh, SplitKind};

/// Which rule vertices follow. Faces are the same for both.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Variant {
    /// Loop's weights, as OpenSubdiv has them.
    #[default]
    Loop,
    /// The thesis' weights, with subdominant eigenvalue 1/2 at every smooth vertex, as on a regular mesh:
    /// see [`super::modified_loop`]. Equal to Loop's where all vertices are regular.
    ModifiedLoop,
}

/// The tables `H0` and `H1` for one split of a triangle mesh; see [`super::Scheme::homotopy`].
///
/// # Panics
/// If a face is not a triangle.
pub fn homotopy(
    mesh: &Mesh,
    masks: &Masks,
    known: &[bool],
    variant: Variant,
    boundary: BoundaryRule,
) -> Homotopy {
    let modified = match variant {
        Variant::Loop => None,
        Variant::ModifiedLoop => Some(modified_masks(mesh, masks)),
    };
    let masks = modified.as_ref().unwrap_or(masks);
    let lift = |corner, visit: &mut dyn FnMut(HalfEdge, f64)| midpoint_to_opposite(mesh, corner, visit);
    let odd = |corner, row: &mut Row| odd_row(mesh, masks, corner, row);
    tables::homotopy(SplitKind::Triangle, mesh, masks, known, lift, HalfBox(boundary), odd)
}

/// `(c_{a o} + c_{b o})/2`, the value from the midpoint of the edge `a -> b` that leaves a corner to the
/// vertex opposite.
pub(super) fn midpoint_to_opposite(mesh: &Mesh, corner: u32, mut visit: impl FnMut(HalfEdge, f64)) {
    visit(mesh.corner_half_edge(mesh.previous_corner(corner)).twin(), 0.5);
    visit(mesh.corner_half_edge(mesh.next_corner(corner)), 0.5);
}

fn odd_row(mesh: &Mesh, masks: &Masks, corner: u32, row: &mut Row) {
    let face = mesh.corner_face(corner);
    for side in [corner, mesh.previous_corner(corner)] {
        let across = mesh.left_corner(mesh.corner_half_edge(side).twin());
        let weight = masks.edge_face[side as usize] / 4.0;
        if let Some(across) = across.filter(|_| weight != 0.0) {
            row.add(face, weight);
            row.add(mesh.corner_face(across), -weight);
        }
    }
}
