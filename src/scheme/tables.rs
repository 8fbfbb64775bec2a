//! The shape that the tables of all schemes share: `H0` from the masks and two lifts, `H1` from the
//! correction and the rows of the odd edges.

use super::correction::{Correction, FaceWeights};
use super::regular::Regular;
use super::regular_cells::RegularCells;
use super::{Homotopy, whitney};
use crate::osd::Masks;
use crate::sparse::{Exceptions, Row};
use crate::topology::{ChildEdge, HalfEdge, Mesh, Parent, Split, SplitKind};

/// Both tables. `lift(corner, visit)` hands out the value from the midpoint of the edge that leaves a corner
/// to the point that its face stands for in the mask of that midpoint; `odd(corner, row)` fills the row of
/// `H1` of the odd edge at a corner.
pub(super) fn homotopy(
    kind: SplitKind,
    mesh: &Mesh,
    masks: &Masks,
    known: &[bool],
    lift: impl Fn(u32, &mut dyn FnMut(HalfEdge, f64)) + Sync,
    weights: impl FaceWeights,
    odd: impl Fn(u32, &mut Row) + Sync,
) -> Homotopy {
    let split = Split::new(kind, mesh);
    let regular = RegularCells::of(kind, mesh, masks, known);
    let correction = Correction::new(mesh, &masks.edge_face, &masks.rules, weights);
    let h1 = Exceptions::listed(
        (split.num_children(1), mesh.num_faces()),
        regular.other_child_edges(&split, mesh),
        |edge, row| match split.edge_parent(edge) {
            // The child edge is directed m_e -> v.
            ChildEdge::Even(h) => correction.add_row(h, -1.0, row),
            ChildEdge::Odd(corner) => odd(corner, row),
        },
    );
    let formula = match kind {
        SplitKind::Quad => Regular::Catmark,
        SplitKind::Triangle => Regular::Loop,
    };
    Homotopy { regular: formula, h0: h0(split, mesh, masks, &regular, lift), h1 }
}

/// ```text
/// H0(p_f) = 0
/// H0(m_e) = sum_g tau_{e,g} lift(e, g) + (th_b - th_a)/2 c_ab
/// H0(v')  = sum_i a_i c_{v w_i} + sum_i b_i P_{f_i,v}
/// ```
fn h0(
    split: Split,
    mesh: &Mesh,
    masks: &Masks,
    regular: &RegularCells,
    lift: impl Fn(u32, &mut dyn FnMut(HalfEdge, f64)) + Sync,
) -> Exceptions {
    let is_exception = |vertex| match split.vertex_parent(vertex) {
        Parent::Vertex(v) => !regular.vertices[v as usize],
        Parent::Edge(e) => !regular.edges[e as usize],
        Parent::Face(_) => false,
    };
    let shape = (split.num_children(0), mesh.num_edges());
    Exceptions::collect(shape, is_exception, |vertex, row| match split.vertex_parent(vertex) {
        Parent::Vertex(v) => vertex_displacement(mesh, masks, v, row),
        Parent::Edge(e) => midpoint_displacement(mesh, masks, e, &lift, row),
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

fn midpoint_displacement(
    mesh: &Mesh,
    masks: &Masks,
    e: u32,
    lift: impl Fn(u32, &mut dyn FnMut(HalfEdge, f64)),
    row: &mut Row,
) {
    let sides = [HalfEdge::new(e, true), HalfEdge::new(e, false)];
    // A non-manifold edge has no sides here; it is sharp, so its faces have no weight.
    for corner in sides.into_iter().filter_map(|side| mesh.left_corner(side)) {
        let tau = masks.edge_face[corner as usize];
        if tau != 0.0 {
            lift(corner, &mut |h, weight| add(row, h, tau * weight));
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
