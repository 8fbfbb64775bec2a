use std::ops::Range;

use super::HalfEdge;
use crate::sparse::{Csr, assemble};

const NONE: u32 = u32::MAX;

/// A polygon complex: vertices, oriented edges, oriented faces, and the fans round every vertex.
///
/// A **corner** is a face together with one of its vertices; corners are numbered face after face, so
/// that corner `offset(f) + i` lies at vertex `i` of face `f`. Corner `c` also names the half-edge that
/// leaves its vertex along the face.
///
/// Invariants: consecutive vertices of a face are the ends of the edge named there; no face repeats a
/// vertex; every edge has a face. Numbering and edge directions are OpenSubdiv's at every level.
#[derive(Clone, Debug)]
pub struct Mesh {
    num_vertices: usize,
    face_offsets: Vec<u32>,
    corner_vertex: Vec<u32>,
    corner_half_edge: Vec<HalfEdge>,
    corner_face: Vec<u32>,
    edge_vertices: Vec<[u32; 2]>,
    /// For each edge its number of faces.
    edge_faces: Vec<u32>,
    /// For each half-edge the corner of the face on its left; `NONE` on a boundary side and on both
    /// sides of a non-manifold edge.
    left_corner: Vec<u32>,
    /// For each vertex the half-edges that leave it, ascending.
    vertex_offsets: Vec<u32>,
    vertex_half_edges: Vec<HalfEdge>,
    /// Fan `i` is `fan_corners[fan_offsets[i]..fan_offsets[i + 1]]`; vertex `v` has the fans
    /// `vertex_fans[v]..vertex_fans[v + 1]`.
    vertex_fans: Vec<u32>,
    fan_offsets: Vec<u32>,
    fan_cyclic: Vec<bool>,
    fan_corners: Vec<u32>,
    /// For each corner its position in `fan_corners`.
    corner_place: Vec<u32>,
}

/// The faces round a vertex that hang together, counter-clockwise.
///
/// Corner `corners[i]` lies between spoke `i` (the half-edge it names, leaving the vertex) and spoke
/// `i + 1`. A cyclic fan has as many spokes as corners; an open one, which ends at boundary or
/// non-manifold edges, has one more.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fan<'a> {
    /// The corners, counter-clockwise.
    pub corners: &'a [u32],
    /// Whether the last face meets the first.
    pub cyclic: bool,
}

/// Arrays that are not a complex.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)] // the messages say what the fields are
pub enum MeshError {
    #[error("{what}: {actual} entries where {expected} belong")]
    Length { what: &'static str, expected: usize, actual: usize },
    #[error("face {face}: its edge {edge} does not join its vertices {} and {}", vertices[0], vertices[1])]
    EdgeMismatch { face: usize, edge: u32, vertices: [u32; 2] },
}

impl Mesh {
    /// Builds the complex from the arrays of one level: for each face its size, its vertices
    /// (counter-clockwise) and its edges (edge `i` joins vertices `i` and `i + 1`), and for each edge
    /// its two vertices in the order of its orientation.
    ///
    /// # Errors
    /// If the lengths or the edges do not fit together.
    pub fn from_arrays(
        num_vertices: usize,
        face_sizes: &[u32],
        face_vertices: Vec<u32>,
        face_edges: &[u32],
        edge_vertices: Vec<[u32; 2]>,
    ) -> Result<Self, MeshError> {
        let num_corners: usize = face_sizes.iter().map(|&n| n as usize).sum();
        for (what, actual) in [("face vertices", face_vertices.len()), ("face edges", face_edges.len())] {
            if actual != num_corners {
                return Err(MeshError::Length { what, expected: num_corners, actual });
            }
        }
        let mut face_offsets = Vec::with_capacity(face_sizes.len() + 1);
        face_offsets.push(0);
        let mut corner_face = Vec::with_capacity(num_corners);
        let mut corner_half_edge = Vec::with_capacity(num_corners);
        for (face, &size) in face_sizes.iter().enumerate() {
            let start = corner_face.len();
            for i in 0..size as usize {
                let vertices = [face_vertices[start + i], face_vertices[start + (i + 1) % size as usize]];
                let edge = face_edges[start + i];
                let ends = edge_vertices.get(edge as usize).copied();
                let along = ends == Some(vertices);
                if !along && ends != Some([vertices[1], vertices[0]]) {
                    return Err(MeshError::EdgeMismatch { face, edge, vertices });
                }
                corner_half_edge.push(HalfEdge::new(edge, along));
                corner_face.push(face as u32);
            }
            face_offsets.push(corner_face.len() as u32);
        }

        let mut edge_faces = vec![0; edge_vertices.len()];
        let mut left_corner = vec![NONE; 2 * edge_vertices.len()];
        for (c, h) in corner_half_edge.iter().enumerate() {
            edge_faces[h.edge() as usize] += 1;
            left_corner[h.index()] = c as u32;
        }
        for e in 0..edge_vertices.len() {
            let one_sided = left_corner[2 * e] == NONE || left_corner[2 * e + 1] == NONE;
            if edge_faces[e] > 2 || (edge_faces[e] == 2 && one_sided) {
                left_corner[2 * e] = NONE;
                left_corner[2 * e + 1] = NONE;
            }
        }

        let (vertex_offsets, vertex_half_edges) = group_by(
            num_vertices,
            (0..2 * edge_vertices.len() as u32)
                .map(|h| (edge_vertices[h as usize / 2][h as usize % 2], HalfEdge(h))),
        );
        let mut mesh = Mesh {
            num_vertices,
            face_offsets,
            corner_vertex: face_vertices,
            corner_half_edge,
            corner_face,
            edge_vertices,
            edge_faces,
            left_corner,
            vertex_offsets,
            vertex_half_edges,
            vertex_fans: Vec::with_capacity(num_vertices + 1),
            fan_offsets: vec![0],
            fan_cyclic: Vec::new(),
            fan_corners: Vec::with_capacity(num_corners),
            corner_place: vec![NONE; num_corners],
        };
        mesh.order_fans();
        Ok(mesh)
    }

    /// Walks round every vertex: first the open fans, each from the corner that has no predecessor, then
    /// what is left, which is cyclic and starts at its lowest corner.
    fn order_fans(&mut self) {
        let corners = self.corner_vertex.iter().enumerate().map(|(c, &v)| (v, c as u32));
        let (offsets, at_vertex) = group_by(self.num_vertices, corners);
        self.vertex_fans.push(0);
        for v in 0..self.num_vertices {
            let here = offsets[v] as usize..offsets[v + 1] as usize;
            for cyclic in [false, true] {
                for &start in &at_vertex[here.clone()] {
                    let first = cyclic || self.left_corner(self.corner_half_edge(start).twin()).is_none();
                    if first && self.corner_place[start as usize] == NONE {
                        let mut next = Some(start);
                        while let Some(c) = next.filter(|&c| self.corner_place[c as usize] == NONE) {
                            self.corner_place[c as usize] = self.fan_corners.len() as u32;
                            self.fan_corners.push(c);
                            next = self.next_round_vertex(c);
                        }
                        self.fan_offsets.push(self.fan_corners.len() as u32);
                        self.fan_cyclic.push(cyclic);
                    }
                }
            }
            self.vertex_fans.push(self.fan_cyclic.len() as u32);
        }
    }

    /// The corner of the same vertex in the next face counter-clockwise.
    fn next_round_vertex(&self, corner: u32) -> Option<u32> {
        self.left_corner(self.corner_half_edge(self.previous_corner(corner)).twin())
    }

    /// The number of vertices, isolated ones included.
    pub fn num_vertices(&self) -> usize {
        self.num_vertices
    }

    /// The number of edges.
    pub fn num_edges(&self) -> usize {
        self.edge_vertices.len()
    }

    /// The number of faces.
    pub fn num_faces(&self) -> usize {
        self.face_offsets.len() - 1
    }

    /// The number of corners: the sum of the face sizes.
    pub fn num_corners(&self) -> usize {
        self.corner_vertex.len()
    }

    /// The number of cells of dimension `k`: vertices, edges or faces.
    ///
    /// # Panics
    /// If `k > 2`.
    pub fn num_cells(&self, k: usize) -> usize {
        [self.num_vertices(), self.num_edges(), self.num_faces()][k]
    }

    /// The corners of face `f`.
    #[inline]
    pub fn corners(&self, f: u32) -> Range<u32> {
        self.face_offsets[f as usize]..self.face_offsets[f as usize + 1]
    }

    /// The number of vertices of face `f`.
    #[inline]
    pub fn face_size(&self, f: u32) -> usize {
        self.corners(f).len()
    }

    /// The vertices of face `f`, counter-clockwise.
    #[inline]
    pub fn face_vertices(&self, f: u32) -> &[u32] {
        &self.corner_vertex[as_usize(self.corners(f))]
    }

    /// The boundary of face `f`, counter-clockwise: half-edge `i` leaves vertex `i`.
    #[inline]
    pub fn face_half_edges(&self, f: u32) -> &[HalfEdge] {
        &self.corner_half_edge[as_usize(self.corners(f))]
    }

    /// The vertices of all corners.
    pub fn corner_vertices(&self) -> &[u32] {
        &self.corner_vertex
    }

    /// The vertex at corner `c`.
    #[inline]
    pub fn corner_vertex(&self, c: u32) -> u32 {
        self.corner_vertex[c as usize]
    }

    /// The half-edge that leaves the vertex of corner `c` along its face.
    #[inline]
    pub fn corner_half_edge(&self, c: u32) -> HalfEdge {
        self.corner_half_edge[c as usize]
    }

    /// The face of corner `c`.
    #[inline]
    pub fn corner_face(&self, c: u32) -> u32 {
        self.corner_face[c as usize]
    }

    /// The corner after `c` in its face, counter-clockwise.
    #[inline]
    pub fn next_corner(&self, c: u32) -> u32 {
        let range = self.corners(self.corner_face(c));
        if c + 1 == range.end { range.start } else { c + 1 }
    }

    /// The corner before `c` in its face, counter-clockwise.
    #[inline]
    pub fn previous_corner(&self, c: u32) -> u32 {
        let range = self.corners(self.corner_face(c));
        if c == range.start { range.end - 1 } else { c - 1 }
    }

    /// The two vertices of each edge, in the order of its orientation.
    pub fn edges(&self) -> &[[u32; 2]] {
        &self.edge_vertices
    }

    /// The vertex that half-edge `h` leaves.
    #[inline]
    pub fn tail(&self, h: HalfEdge) -> u32 {
        self.edge_vertices[h.edge() as usize][h.index() & 1]
    }

    /// The vertex that half-edge `h` reaches.
    #[inline]
    pub fn head(&self, h: HalfEdge) -> u32 {
        self.tail(h.twin())
    }

    /// The corner at the tail of `h` in the face on its left; `None` where there is no such face, and on
    /// both sides of a non-manifold edge.
    #[inline]
    pub fn left_corner(&self, h: HalfEdge) -> Option<u32> {
        Some(self.left_corner[h.index()]).filter(|&c| c != NONE)
    }

    /// The number of faces of edge `e`, counted once for each time a face runs along it.
    pub fn num_edge_faces(&self, e: u32) -> usize {
        self.edge_faces[e as usize] as usize
    }

    /// Whether edge `e` has one face.
    pub fn is_boundary_edge(&self, e: u32) -> bool {
        self.edge_faces[e as usize] == 1
    }

    /// Whether edge `e` has three or more faces, or two that run along it in the same direction.
    pub fn is_non_manifold_edge(&self, e: u32) -> bool {
        self.edge_faces[e as usize] > 1 && self.left_corner[2 * e as usize] == NONE
    }

    /// The half-edges that leave vertex `v`, ascending.
    #[inline]
    pub fn vertex_half_edges(&self, v: u32) -> &[HalfEdge] {
        let v = v as usize;
        &self.vertex_half_edges[self.vertex_offsets[v] as usize..self.vertex_offsets[v + 1] as usize]
    }

    /// The fans of vertex `v`: none for an isolated vertex, several where the surface touches itself.
    pub fn fans(&self, v: u32) -> impl ExactSizeIterator<Item = Fan<'_>> {
        (self.vertex_fans[v as usize]..self.vertex_fans[v as usize + 1]).map(|i| self.fan(i as usize))
    }

    /// The fan that corner `c` belongs to, and its position there.
    pub fn fan_of_corner(&self, c: u32) -> (Fan<'_>, usize) {
        let v = self.corner_vertex(c) as usize;
        let place = self.corner_place[c as usize];
        let fans = self.vertex_fans[v] as usize..self.vertex_fans[v + 1] as usize;
        let i = fans.start + self.fan_offsets[fans.start + 1..fans.end].partition_point(|&end| end <= place);
        (self.fan(i), (place - self.fan_offsets[i]) as usize)
    }

    fn fan(&self, i: usize) -> Fan<'_> {
        let range = self.fan_offsets[i] as usize..self.fan_offsets[i + 1] as usize;
        Fan { corners: &self.fan_corners[range], cyclic: self.fan_cyclic[i] }
    }

    /// The half-edge from vertex `a` to vertex `b`, if they share an edge. Costs the valence of `a`;
    /// `None` too if `a` is out of range.
    pub fn find_half_edge(&self, a: u32, b: u32) -> Option<HalfEdge> {
        if a as usize >= self.num_vertices {
            return None;
        }
        self.vertex_half_edges(a).iter().copied().find(|&h| self.head(h) == b)
    }

    /// The exterior derivative of 0-cochains, `(|E|, |V|)`: `(d0 x)(a -> b) = x_b - x_a`.
    pub fn d0(&self) -> Csr {
        assemble((self.num_edges(), self.num_vertices()), |e, row| {
            let [a, b] = self.edge_vertices[e];
            row.add(a, -1.0);
            row.add(b, 1.0);
        })
    }

    /// The exterior derivative of 1-cochains, `(|F|, |E|)`: the sum round the boundary of each face,
    /// counter-clockwise, an edge that is run against its orientation counted negative.
    pub fn d1(&self) -> Csr {
        assemble((self.num_faces(), self.num_edges()), |f, row| {
            for h in self.face_half_edges(f as u32) {
                row.add(h.edge(), h.sign());
            }
        })
    }
}

fn as_usize(range: Range<u32>) -> Range<usize> {
    range.start as usize..range.end as usize
}

/// Sorts items by key, stable, in linear time: item list of key `k` is `items[offsets[k]..offsets[k + 1]]`.
fn group_by<T: Copy>(num_keys: usize, keyed: impl Iterator<Item = (u32, T)> + Clone) -> (Vec<u32>, Vec<T>) {
    let mut offsets = vec![0u32; num_keys + 1];
    for (key, _) in keyed.clone() {
        offsets[key as usize + 1] += 1;
    }
    for k in 0..num_keys {
        offsets[k + 1] += offsets[k];
    }
    let mut next = offsets.clone();
    let mut items: Vec<T> = match keyed.clone().next() {
        Some((_, any)) => vec![any; offsets[num_keys] as usize],
        None => Vec::new(),
    };
    for (key, item) in keyed {
        items[next[key as usize] as usize] = item;
        next[key as usize] += 1;
    }
    (offsets, items)
}
