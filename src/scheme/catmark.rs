//! Catmull-Clark with Doo-Sabin: every mesh that OpenSubdiv's `SCHEME_CATMARK` takes.
//!
//! With OpenSubdiv's masks
//!
//! ```text
//! m_e = th_a a + th_b b + sum_g tau_{e,g} p_g          v' = w_v v + sum_i a_i w_i + sum_i b_i p_{f_i}
//! ```
//!
//! the tables are (`P`, `Pbar` the lifts of [`super::whitney`])
//!
//! ```text
//! H0(p_f) = 0
//! H0(m_e) = sum_g tau_{e,g} Pbar_{g,e} + (th_b - th_a)/2 c_ab
//! H0(v')  = sum_i a_i c_{v w_i} + sum_i b_i P_{f_i,v}
//! H1(v -> m_e): see super::correction, with u_f = 1/n_f and alpha' = (3/4, 1/8, 0, .., 0, 1/8)
//! H1(m_e -> p_f) = 0
//! ```
//!
//! In the regular interior this gives the tensor-product spline rules: S1 times 64 is 18 on the edge
//! itself, 6 on the one it continues, 3 and 1 on the parallels beside them (even) and 12, 12, 4, 4 (odd);
//! S2 times 16 is 9, 3, 3, 1 over the parent's value per child. Round an extraordinary vertex on quads it
//! is Appendix C of Ke Wang's thesis.

use super::correction::Correction;
use super::doo_sabin::circulant;
use super::{whitney, DooSabin, Homotopy};
use crate::osd::Masks;
use crate::sparse::{assemble, Csr, Row};
use crate::topology::{ChildEdge, HalfEdge, Mesh, Parent, QuadSplit};

/// The tables `H0` and `H1` for one split.
pub fn homotopy(mesh: &Mesh, masks: &Masks, weights: DooSabin) -> Homotopy {
    Homotopy { h0: h0(mesh, masks), h1: h1(mesh, masks, weights) }
}

fn h0(mesh: &Mesh, masks: &Masks) -> Csr {
    let split = QuadSplit::of(mesh);
    assemble((split.num_children(0), mesh.num_edges()), |vertex, row| match split.vertex_parent(vertex) {
        Parent::Vertex(v) => vertex_displacement(mesh, masks, v, row),
        Parent::Edge(e) => midpoint_displacement(mesh, masks, e, row),
        Parent::Face(_) => {}
    })
}

fn vertex_displacement(mesh: &Mesh, masks: &Masks, v: u32, row: &mut Row) {
    for &h in mesh.vertex_half_edges(v) {
        add(row, h, masks.vertex_edge[h.index()]);
    }
    for &corner in mesh.fans(v).flat_map(|fan| fan.corners) {
        let b = masks.vertex_face[corner as usize];
        if b != 0.0 {
            whitney::vertex_to_centre(mesh, corner, |h, weight| add(row, h, b * weight));
        }
    }
}

fn midpoint_displacement(mesh: &Mesh, masks: &Masks, e: u32, row: &mut Row) {
    let sides = [HalfEdge::new(e, true), HalfEdge::new(e, false)];
    // A non-manifold edge has no sides here; it is sharp, so its faces have no weight.
    for corner in sides.into_iter().filter_map(|side| mesh.left_corner(side)) {
        let tau = masks.edge_face[corner as usize];
        if tau != 0.0 {
            whitney::midpoint_to_centre(mesh, corner, |h, weight| add(row, h, tau * weight));
        }
    }
    let [th_a, th_b] = sides.map(|side| masks.edge_end[side.index()]);
    add(row, sides[0], (th_b - th_a) / 2.0);
}

fn add(row: &mut Row, h: HalfEdge, weight: f64) {
    if weight != 0.0 {
        row.add(h.edge(), weight * h.sign());
    }
}

fn h1(mesh: &Mesh, masks: &Masks, weights: DooSabin) -> Csr {
    let split = QuadSplit::of(mesh);
    let delta = |k: usize| {
        let unmended = circulant(k, 0.75, 0.125, |_| 0.0);
        weights.weights(k).iter().zip(unmended).map(|(alpha, plain)| alpha - plain).collect()
    };
    let correction = Correction::new(mesh, masks, delta, |face| whitney::w2(mesh, face));
    assemble((split.num_children(1), mesh.num_faces()), |edge, row| match split.edge_parent(edge) {
        // The child edge is directed m_e -> v.
        ChildEdge::Even(h) => correction.add_row(h, -1.0, row),
        ChildEdge::Odd(_) => {}
    })
}
