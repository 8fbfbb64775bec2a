use std::ops::Range;

use super::HalfEdge;
use super::faces::Faces;
use crate::sparse::{Csr, assemble};

/// No corner.
pub(super) const NONE: u32 = u32::MAX;

/// A polygon complex: vertices, oriented edges, oriented faces, and the fans round every vertex.
///
/// A **corner** is a face together with one of its vertices; corners are numbered face after face, so
/// that corner `offset(f) + i` lies at vertex `i` of face `f`. Corner `c` also names the half-edge that
/// leaves its vertex along the face.
///
/// Invariants: consecutive vertices of a face are the ends of the edge named there; no face repeats a
/// vertex; every edge has a face. Numbering and edge directions are OpenSubdiv's at every level.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    pub(super) num_vertices: usize,
    pub(super) faces: Faces,
    pub(super) corner_vertex: Vec<u32>,
    pub(super) corner_half_edge: Vec<HalfEdge>,
    pub(super) edge_vertices: Vec<[u32; 2]>,
    /// For each edge its number of faces.
    pub(super) edge_faces: Vec<u32>,
    /// For each half-edge the corner of the face on its left; `NONE` on a boundary side and on both
    /// sides of a non-manifold edge.
    pub(super) left_corner: Vec<u32>,
    /// For each vertex the half-edges that leave it, ascending.
    pub(super) vertex_offsets: Vec<u32>,
    pub(super) vertex_half_edges: Vec<HalfEdge>,
    /// Fan `i` is `fan_corners[fan_offsets[i]..fan_offsets[i + 1]]`; vertex `v` has the fans
    /// `vertex_fans[v]..vertex_fans[v + 1]`.
    pub(super) vertex_fans: Vec<u32>,
    pub(super) fan_offsets: Vec<u32>,
    pub(super) fan_cyclic: Vec<bool>,
    pub(super) fan_corners: Vec<u32>,
    /// For each corner its position in `fan_corners`.
    pub(super) corner_place: Vec<u32>,
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

impl Fan<'_> {
    /// The corner at a position, which may run on once past the last.
    #[inline]
    pub fn corner(&self, position: usize) -> u32 {
        self.corners[wrap(position, self.corners.len())]
    }
}

/// `i` modulo `n`, for `i` below `2 n`: without a division, which costs more than a row.
#[inline]
pub(crate) fn wrap(i: usize, n: usize) -> usize {
    if i < n { i } else { i - n }
}

impl Mesh {
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
        self.faces.len()
    }

    /// The number of corners: the sum of the face sizes.
    pub fn num_corners(&self) -> usize {
        self.corner_vertex.len()
    }

    /// The number of sides of every face, if they are all alike.
    pub fn uniform_face_size(&self) -> Option<usize> {
        self.faces.uniform_size()
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
        self.faces.corners(f)
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

    /// The half-edges of all corners: the boundaries of the faces, one after the other.
    pub fn corner_half_edges(&self) -> &[HalfEdge] {
        &self.corner_half_edge
    }

    /// [`Mesh::left_corner`] of all half-edges; `u32::MAX` where there is none.
    pub(crate) fn left_corners(&self) -> &[u32] {
        &self.left_corner
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
        self.faces.of_corner(c)
    }

    /// The corner after `c` in its face, counter-clockwise.
    #[inline]
    pub fn next_corner(&self, c: u32) -> u32 {
        self.faces.next(c)
    }

    /// The corner before `c` in its face, counter-clockwise.
    #[inline]
    pub fn previous_corner(&self, c: u32) -> u32 {
        self.faces.previous(c)
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
    #[inline(always)]
    pub fn fan_of_corner(&self, c: u32) -> (Fan<'_>, usize) {
        let v = self.corner_vertex(c) as usize;
        let place = self.corner_place[c as usize];
        let fans = self.vertex_fans[v] as usize..self.vertex_fans[v + 1] as usize;
        let before = match fans.len() {
            1 => 0,
            _ => self.fan_offsets[fans.start + 1..fans.end].partition_point(|&end| end <= place),
        };
        let i = fans.start + before;
        (self.fan(i), (place - self.fan_offsets[i]) as usize)
    }

    #[inline]
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
