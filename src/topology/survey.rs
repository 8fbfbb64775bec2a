use std::collections::BTreeMap;

use serde::Serialize;

use super::Mesh;

/// The counts and invariants of a complex.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Survey {
    /// Vertices, isolated ones included.
    pub vertices: usize,
    /// Edges.
    pub edges: usize,
    /// Faces.
    pub faces: usize,
    /// Vertices without a face.
    pub isolated_vertices: usize,
    /// `V - E + F`, isolated vertices not counted.
    pub euler_characteristic: i64,
    /// Connected components, isolated vertices not counted.
    pub components: usize,
    /// Edges of one face.
    pub boundary_edges: usize,
    /// Closed chains of boundary edges.
    pub boundary_loops: usize,
    /// The number of handles, over all components; none if some part is not manifold.
    pub genus: Option<usize>,
    /// Each number of edges at a vertex that occurs, with the number of its vertices; ascending.
    pub valences: Vec<(usize, usize)>,
    /// Each face size that occurs, with the number of its faces; ascending.
    pub face_sizes: Vec<(usize, usize)>,
    /// Edges of three or more faces, or of two that run along them in the same direction.
    pub non_manifold_edges: usize,
    /// Vertices on a non-manifold edge or with more than one fan.
    pub non_manifold_vertices: usize,
}

impl Survey {
    /// Surveys a mesh.
    pub fn of(mesh: &Mesh) -> Self {
        let vertices = 0..mesh.num_vertices() as u32;
        let edges = 0..mesh.num_edges() as u32;
        let valence = |v: u32| mesh.vertex_half_edges(v).len();
        let isolated_vertices = vertices.clone().filter(|&v| valence(v) == 0).count();
        let non_manifold_edges = edges.clone().filter(|&e| mesh.is_non_manifold_edge(e)).count();
        let non_manifold_vertices = vertices
            .clone()
            .filter(|&v| {
                mesh.fans(v).len() > 1
                    || mesh.vertex_half_edges(v).iter().any(|h| mesh.is_non_manifold_edge(h.edge()))
            })
            .count();
        let euler_characteristic = (mesh.num_vertices() - isolated_vertices) as i64 - mesh.num_edges() as i64
            + mesh.num_faces() as i64;

        let mut connected = Partition::new(mesh.num_vertices());
        mesh.edges().iter().for_each(|&[a, b]| connected.join(a, b));
        let components = connected.parts() - isolated_vertices;

        // A boundary chain goes on from edge to edge through the open fan between them.
        let mut chains = Partition::new(mesh.num_edges());
        let boundary_edges = edges.filter(|&e| mesh.is_boundary_edge(e)).count();
        for fan in vertices.clone().flat_map(|v| mesh.fans(v)).filter(|fan| !fan.cyclic) {
            let last = mesh.previous_corner(fan.corners[fan.corners.len() - 1]);
            let ends = [fan.corners[0], last].map(|c| mesh.corner_half_edge(c).edge());
            if ends.iter().all(|&e| mesh.is_boundary_edge(e)) {
                chains.join(ends[0], ends[1]);
            }
        }
        let boundary_loops = chains.parts() - (mesh.num_edges() - boundary_edges);

        // chi = 2 - 2 genus - loops, summed over the components.
        let manifold = non_manifold_edges == 0 && non_manifold_vertices == 0;
        let handles = (2 * components as i64 - boundary_loops as i64 - euler_characteristic) / 2;

        Survey {
            vertices: mesh.num_vertices(),
            edges: mesh.num_edges(),
            faces: mesh.num_faces(),
            isolated_vertices,
            euler_characteristic,
            components,
            boundary_edges,
            boundary_loops,
            genus: manifold.then_some(handles as usize),
            valences: count(vertices.map(valence).filter(|&k| k > 0)),
            face_sizes: count((0..mesh.num_faces() as u32).map(|f| mesh.face_size(f))),
            non_manifold_edges,
            non_manifold_vertices,
        }
    }
}

fn count(values: impl Iterator<Item = usize>) -> Vec<(usize, usize)> {
    let mut counts = BTreeMap::new();
    values.for_each(|value| *counts.entry(value).or_insert(0) += 1);
    counts.into_iter().collect()
}

/// Disjoint sets, joined pair by pair.
struct Partition {
    parent: Vec<u32>,
    parts: usize,
}

impl Partition {
    fn new(len: usize) -> Self {
        Partition { parent: (0..len as u32).collect(), parts: len }
    }

    fn root(&mut self, mut i: u32) -> u32 {
        while self.parent[i as usize] != i {
            self.parent[i as usize] = self.parent[self.parent[i as usize] as usize];
            i = self.parent[i as usize];
        }
        i
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        if a != b {
            self.parent[a as usize] = b;
            self.parts -= 1;
        }
    }

    fn parts(&self) -> usize {
        self.parts
    }
}
