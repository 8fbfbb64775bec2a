//! The regular rows of `S1` and `S2` on triangles, each on a list of cells that several rows share. They are box-spline
//! convolution, see [`crate::symbol`].

use crate::topology::{HalfEdge, Mesh};

const fn over_32<const N: usize>(mut weights: [f64; N]) -> [f64; N] {
    let mut i = 0;
    while i < N {
        weights[i] /= 32.0;
        i += 1;
    }
    weights
}

/// On triangles, the row of `S1` of the half `m_e -> v` of an edge, on what [`spokes_and_rims`] gives for the fan of `v`
/// that begins at the edge.
pub const EVEN: [f64; 12] = over_32([-8.0, -2.0, 1.0, 2.0, 1.0, -2.0, 1.0, 1.0, 0.0, 0.0, -1.0, -1.0]);

/// On triangles, the row of `S1` of an odd child edge, on what [`sides_and_across`] gives for its face from its corner on.
pub const ODD: [f64; 9] = over_32([-3.0, 6.0, -3.0, -3.0, 1.0, 0.0, 0.0, 1.0, -3.0]);

/// On triangles, the row of `S2` of the child at a corner, on the faces round its vertex.
pub const CORNER: [f64; 6] = over_32([4.0, 1.0, 1.0, 0.0, 1.0, 1.0]);

/// Round a regular vertex of triangles, from its first corner on: the spokes, and the edges opposite.
#[inline(always)]
pub fn spokes_and_rims(mesh: &Mesh, fan: &[u32; 6]) -> [HalfEdge; 12] {
    let mut edges = [HalfEdge(0); 12];
    for (i, &corner) in fan.iter().enumerate() {
        edges[i] = mesh.corner_half_edge(corner);
        edges[6 + i] = mesh.corner_half_edge(mesh.next_corner(corner));
    }
    edges
}

/// The sides of a triangle, and for each of them the next two in the triangle across; where there is none the side itself.
#[inline(always)]
pub fn sides_and_across(mesh: &Mesh, corners: [u32; 3]) -> [HalfEdge; 9] {
    let side = |i: usize| mesh.corner_half_edge(corners[i]);
    let mut edges = [side(0), side(1), side(2), side(0), side(0), side(1), side(1), side(2), side(2)];
    for i in 0..3 {
        if let Some(across) = mesh.left_corner(edges[i].twin()) {
            edges[3 + 2 * i] = mesh.corner_half_edge(mesh.next_corner(across));
            edges[4 + 2 * i] = mesh.corner_half_edge(mesh.previous_corner(across));
        }
    }
    edges
}
