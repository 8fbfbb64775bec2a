//! The cells round a vertex and round a face, numbered the same way wherever the same configuration occurs.

use crate::osd::{Rule, Tags};
use crate::scheme::sector::{Place, place};
use crate::topology::{HalfEdge, Mesh};

/// Cells of a mesh in an order of their own.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Cells {
    /// Vertices.
    pub vertices: Vec<u32>,
    /// Edges, each in the direction in which it is counted here.
    pub edges: Vec<HalfEdge>,
    /// Faces.
    pub faces: Vec<u32>,
}

/// What surrounds a corner up to the nearest sharp edges, on a settled level.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Configuration {
    /// The rule of the vertex.
    pub rule: Rule,
    /// Whether nothing cuts the faces off: they close a circle. A dart's circle begins at its sharp edge.
    pub cyclic: bool,
    /// The number of faces.
    pub faces: u32,
    /// The place of the corner's own face among them; 0 where the circle may begin anywhere.
    pub position: u32,
}

/// The configuration of a corner and the corners of its vertex that belong to it, counter-clockwise.
pub fn around_corner(mesh: &Mesh, tags: &Tags, corner: u32) -> (Configuration, Vec<u32>) {
    let (fan, position) = mesh.fan_of_corner(corner);
    let rule = tags.vertex_rule[mesh.corner_vertex(corner) as usize];
    let is_sharp =
        |i: usize| tags.edge_sharpness[mesh.corner_half_edge(fan.corners[i]).edge() as usize] > 0.0;
    let k = fan.corners.len();
    let rotated = |start: usize, n: usize| (0..n).map(|i| fan.corners[(start + i) % k]).collect();
    match place(fan, position, |i| !rule.is_smooth() && is_sharp(i)) {
        Place::Smooth { position } => {
            let start = match rule {
                Rule::Dart => (0..k).find(|&i| is_sharp(i)).unwrap_or(position),
                _ => position,
            };
            let position = ((position + k - start) % k) as u32;
            (Configuration { rule, cyclic: true, faces: k as u32, position }, rotated(start, k))
        }
        Place::Sector { start, faces, spoke } => {
            let configuration =
                Configuration { rule, cyclic: false, faces: faces as u32, position: spoke as u32 };
            (configuration, rotated(start, faces))
        }
    }
}

/// The faces of these corners of one vertex `v`, with their edges and vertices: `v`; then for each face, from
/// its spoke `v -> w_i` on, the spoke and the other edges but the last, counter-clockwise, and their ends;
/// then the last spoke, if the faces do not close a circle.
pub fn fan_cells(mesh: &Mesh, corners: &[u32], cyclic: bool) -> Cells {
    let mut cells = Cells { vertices: vec![mesh.corner_vertex(corners[0])], ..Default::default() };
    for &corner in corners {
        let mut c = corner;
        for _ in 2..=mesh.face_size(mesh.corner_face(corner)) - 1 {
            let h = mesh.corner_half_edge(c);
            cells.edges.push(h);
            cells.vertices.push(mesh.head(h));
            c = mesh.next_corner(c);
        }
        cells.edges.push(mesh.corner_half_edge(c));
        // The head of that edge is the end of the next spoke.
        cells.faces.push(mesh.corner_face(corner));
    }
    if !cyclic {
        let last = mesh.corner_half_edge(mesh.previous_corner(corners[corners.len() - 1])).twin();
        cells.edges.push(last);
        cells.vertices.push(mesh.head(last));
    }
    cells
}
