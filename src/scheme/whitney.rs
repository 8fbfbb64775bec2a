//! The Whitney schemes of the two splits: the lowest-order rules, which commute by themselves.
//!
//! `W0` puts midpoints and averages, `W1` halves a value along an edge and lifts it inside a face, `W2`
//! gives each child an equal share. On quads and n-gons `W0` is OpenSubdiv's bilinear scheme. Rules are handed out as
//! terms through a `visit` closure, so that assembling a matrix and applying it share them.

use crate::topology::{ChildEdge, HalfEdge, Mesh, Parent, SplitKind};

/// `W0`: the Whitney position of a child vertex, as vertices with weights. A vertex stays, an edge gives
/// its midpoint, a face its average.
pub fn w0(mesh: &Mesh, child: Parent, mut visit: impl FnMut(u32, f64)) {
    match child {
        Parent::Vertex(v) => visit(v, 1.0),
        Parent::Edge(e) => mesh.edges()[e as usize].iter().for_each(|&v| visit(v, 0.5)),
        Parent::Face(f) => {
            let vertices = mesh.face_vertices(f);
            vertices.iter().for_each(|&v| visit(v, 1.0 / vertices.len() as f64));
        }
    }
}

/// `W1`: the value along a child edge, in its own direction, as half-edges with weights. Half of the
/// parent's along an even edge. Along an odd one, for quads, [`midpoint_to_centre`]; for a triangle
/// `(v, w0, w1)`, (3.13) of the thesis: `m(v,w0) -> m(v,w1)` is `(c_{w0 w1} + c_{v w1} - c_{v w0}) / 4`.
pub fn w1(mesh: &Mesh, split: SplitKind, child: ChildEdge, mut visit: impl FnMut(HalfEdge, f64)) {
    match (child, split) {
        (ChildEdge::Even(h), _) => visit(h.twin(), 0.5),
        (ChildEdge::Odd(corner), SplitKind::Quad) => {
            midpoint_to_centre(mesh, corner, |h, weight| visit(h, -weight));
        }
        (ChildEdge::Odd(corner), SplitKind::Triangle) => {
            let (next, previous) = (mesh.next_corner(corner), mesh.previous_corner(corner));
            visit(mesh.corner_half_edge(next), 0.25);
            visit(mesh.corner_half_edge(previous).twin(), 0.25);
            visit(mesh.corner_half_edge(corner), -0.25);
        }
    }
}

/// `W2`: the share of each child of a face: `1/n` of a polygon split into quads, `1/4` of a triangle split
/// into triangles.
pub fn w2(mesh: &Mesh, split: SplitKind, parent: u32) -> f64 {
    match split {
        SplitKind::Quad => 1.0 / mesh.face_size(parent) as f64,
        SplitKind::Triangle => 0.25,
    }
}

/// `P_{f,v}`, the value from the vertex of a corner to the centre of its face: the value of `p_f - v`
/// lifted to the boundary of the face, both ways round with equal weight. Walking counter-clockwise from
/// `v` over the edges `t = 0 .. n-1`, edge `t` has weight `(n - 1 - 2t) / (2n)`.
pub fn vertex_to_centre(mesh: &Mesh, corner: u32, mut visit: impl FnMut(HalfEdge, f64)) {
    walk(mesh, corner, |t, n, h| visit(h, (n - 1.0 - 2.0 * t) / (2.0 * n)));
}

/// `Pbar_{f,e} = (P_{f,a} + P_{f,b}) / 2`, the value from the midpoint of the edge `a -> b` that leaves a
/// corner to the centre of its face: edge `t` counter-clockwise from there has weight `(n - 2t) / (2n)`,
/// the edge itself none.
pub fn midpoint_to_centre(mesh: &Mesh, corner: u32, mut visit: impl FnMut(HalfEdge, f64)) {
    walk(mesh, corner, |t, n, h| {
        if t > 0.0 {
            visit(h, (n - 2.0 * t) / (2.0 * n));
        }
    });
}

/// The boundary of a corner's face, counter-clockwise from that corner: step, number of steps, half-edge.
fn walk(mesh: &Mesh, corner: u32, mut visit: impl FnMut(f64, f64, HalfEdge)) {
    let face = mesh.corner_face(corner);
    let half_edges = mesh.face_half_edges(face);
    let (before, after) = half_edges.split_at((corner - mesh.corners(face).start) as usize);
    for (t, &h) in after.iter().chain(before).enumerate() {
        visit(t as f64, half_edges.len() as f64, h);
    }
}
