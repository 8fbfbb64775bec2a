//! The boundary of a domain of faces.

use crate::fem::Elements;
use crate::topology::SplitKind;

/// The corners of a face in its parameters, from its origin.
fn corners(kind: SplitKind) -> &'static [[f64; 2]] {
    match kind {
        SplitKind::Quad => &[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
        SplitKind::Triangle => &[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]],
    }
}

/// The start and the direction of side `i` of a face, with the face to the left.
pub fn side(kind: SplitKind, i: usize) -> ([f64; 2], [f64; 2]) {
    let corners = corners(kind);
    let (from, to) = (corners[i], corners[(i + 1) % corners.len()]);
    (from, [to[0] - from[0], to[1] - from[1]])
}

/// For each face of the finest level the sides beyond which nothing counts, as bits from the side that leaves its origin:
/// 0 on faces that do not count themselves.
pub fn sides(elements: &Elements) -> Vec<u8> {
    let surface = elements.surface();
    let mesh = surface.hierarchy().finest().mesh();
    let of_face = |face: u32| {
        if !elements.is_inside(face) {
            return 0;
        }
        let (first, size) = (mesh.corners(face).start, mesh.face_size(face) as u32);
        (0..size).fold(0u8, |bits, i| {
            let corner = first + (surface.face_origin(face) + i) % size;
            let beyond = mesh.left_corner(mesh.corner_half_edge(corner).twin());
            let counts = beyond.is_some_and(|corner| elements.is_inside(mesh.corner_face(corner)));
            bits | u8::from(!counts) << i
        })
    };
    (0..mesh.num_faces() as u32).map(of_face).collect()
}
