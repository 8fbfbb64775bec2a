//! Building a complex from its incidence.

use rayon::prelude::*;

use super::faces::Faces;
use super::mesh::NONE;
use super::{HalfEdge, Mesh};
use crate::memory;

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
        face_vertices: &[u32],
        face_edges: &[u32],
        edge_vertices: Vec<[u32; 2]>,
    ) -> Result<Self, MeshError> {
        let num_corners: usize = face_sizes.iter().map(|&n| n as usize).sum();
        for (what, actual) in [("face vertices", face_vertices.len()), ("face edges", face_edges.len())] {
            if actual != num_corners {
                return Err(MeshError::Length { what, expected: num_corners, actual });
            }
        }
        let mut corner_half_edge = memory::with_capacity(num_corners);
        for (face, &size) in face_sizes.iter().enumerate() {
            let start = corner_half_edge.len();
            for i in 0..size as usize {
                let vertices = [face_vertices[start + i], face_vertices[start + (i + 1) % size as usize]];
                let edge = face_edges[start + i];
                let ends = edge_vertices.get(edge as usize).copied();
                let along = ends == Some(vertices);
                if !along && ends != Some([vertices[1], vertices[0]]) {
                    return Err(MeshError::EdgeMismatch { face, edge, vertices });
                }
                corner_half_edge.push(HalfEdge::new(edge, along));
            }
        }

        Ok(Self::complete(num_vertices, Faces::new(face_sizes), corner_half_edge, edge_vertices))
    }

    /// What follows from the boundaries of the faces.
    pub(super) fn complete(
        num_vertices: usize,
        faces: Faces,
        corner_half_edge: Vec<HalfEdge>,
        edge_vertices: Vec<[u32; 2]>,
    ) -> Self {
        let corner_vertex = tails(&corner_half_edge, &edge_vertices);
        let mut edge_faces = memory::zeros(edge_vertices.len());
        let mut left_corner = memory::filled(NONE, 2 * edge_vertices.len());
        for (c, h) in corner_half_edge.iter().enumerate() {
            edge_faces[h.edge() as usize] += 1;
            left_corner[h.index()] = c as u32;
        }
        for (e, sides) in left_corner.chunks_exact_mut(2).enumerate() {
            let one_sided = sides[0] == NONE || sides[1] == NONE;
            if edge_faces[e] > 2 || (edge_faces[e] == 2 && one_sided) {
                sides.fill(NONE);
            }
        }

        let (vertex_offsets, vertex_half_edges) =
            group_by(num_vertices, edge_vertices.as_flattened().iter().copied(), HalfEdge);
        let mut mesh = Mesh {
            num_vertices,
            faces,
            corner_place: memory::filled(NONE, corner_vertex.len()),
            fan_corners: memory::with_capacity(corner_vertex.len()),
            corner_vertex,
            corner_half_edge,
            edge_vertices,
            edge_faces,
            left_corner,
            vertex_offsets,
            vertex_half_edges,
            vertex_fans: memory::with_capacity(num_vertices + 1),
            fan_offsets: memory::with_capacity(num_vertices + 1),
            fan_cyclic: memory::with_capacity(num_vertices),
        };
        mesh.order_fans();
        mesh
    }

    /// Walks round every vertex: first the open fans, each from the corner that has no predecessor, then
    /// what is left, which is cyclic and starts at its lowest corner.
    fn order_fans(&mut self) {
        let (offsets, at_vertex) = group_by(self.num_vertices, self.corner_vertex.iter().copied(), |c| c);
        self.vertex_fans.push(0);
        self.fan_offsets.push(0);
        for v in 0..self.num_vertices {
            let here = &at_vertex[offsets[v] as usize..offsets[v + 1] as usize];
            let end = self.fan_corners.len() + here.len();
            for &start in here {
                if self.left_corner(self.corner_half_edge(start).twin()).is_none() {
                    self.walk_fan(start, false);
                }
            }
            for &start in here {
                if self.fan_corners.len() == end {
                    break;
                }
                if self.corner_place[start as usize] == NONE {
                    self.walk_fan(start, true);
                }
            }
            self.vertex_fans.push(self.fan_cyclic.len() as u32);
        }
    }

    fn walk_fan(&mut self, start: u32, cyclic: bool) {
        let mut next = Some(start);
        while let Some(c) = next.filter(|&c| self.corner_place[c as usize] == NONE) {
            self.corner_place[c as usize] = self.fan_corners.len() as u32;
            self.fan_corners.push(c);
            next = self.next_round_vertex(c);
        }
        self.fan_offsets.push(self.fan_corners.len() as u32);
        self.fan_cyclic.push(cyclic);
    }

    /// The corner of the same vertex in the next face counter-clockwise.
    fn next_round_vertex(&self, corner: u32) -> Option<u32> {
        self.left_corner(self.corner_half_edge(self.previous_corner(corner)).twin())
    }
}

/// The vertices that half-edges leave.
pub(super) fn tails(half_edges: &[HalfEdge], edge_vertices: &[[u32; 2]]) -> Vec<u32> {
    memory::collect(half_edges.par_iter().map(|h| edge_vertices[h.edge() as usize][h.index() & 1]))
}

/// Sorts the numbers `0 ..` of keys by key, stable, in linear time: those of key `k` are, as items,
/// `items[offsets[k]..offsets[k + 1]]`.
fn group_by<T: Copy>(
    num_keys: usize,
    keys: impl ExactSizeIterator<Item = u32> + Clone,
    item: impl Fn(u32) -> T,
) -> (Vec<u32>, Vec<T>) {
    let mut offsets = memory::zeros(num_keys + 1);
    for key in keys.clone() {
        offsets[key as usize + 1] += 1;
    }
    for k in 0..num_keys {
        offsets[k + 1] += offsets[k];
    }
    let mut next = memory::with_capacity(offsets.len());
    next.extend_from_slice(&offsets);
    let mut items = memory::filled(item(0), keys.len());
    for (i, key) in keys.enumerate() {
        items[next[key as usize] as usize] = item(i as u32);
        next[key as usize] += 1;
    }
    (offsets, items)
}
