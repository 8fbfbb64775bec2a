//! The refined complex, written down by rule: nothing is searched for and no fan is walked.

use std::ops::Range;

use rayon::prelude::*;

use super::build::tails;
use super::faces::Faces;
use super::mesh::NONE;
use super::{ChildEdge, HalfEdge, Mesh, Split, SplitKind};
use crate::memory;

impl Split {
    /// The refined complex, numbered and directed as this table says, which is as OpenSubdiv does.
    ///
    /// # Panics
    /// If this is not the split of `parent`.
    pub fn refine(&self, parent: &Mesh) -> Mesh {
        let ends = |edge| self.edge_ends(parent, self.edge_parent(edge)).map(|end| self.vertex_of(end));
        let edge_vertices = memory::collect((0..self.num_children(1)).into_par_iter().map(ends));
        let num_faces = self.num_children(2);
        let (faces, half_edges) = match self.kind() {
            SplitKind::Quad => (Faces::Quads(num_faces), self.boundaries::<4>(parent)),
            SplitKind::Triangle => (Faces::Triangles(num_faces), self.boundaries::<3>(parent)),
        };
        if (0..parent.num_edges() as u32).any(|e| parent.is_non_manifold_edge(e)) {
            // The faces at such an edge are not known by it.
            return Mesh::complete(self.num_children(0), faces, half_edges, edge_vertices);
        }
        Children { split: self, parent }.complete(faces, half_edges, edge_vertices)
    }

    /// The boundaries of the child faces, one after the other.
    fn boundaries<const N: usize>(&self, parent: &Mesh) -> Vec<HalfEdge> {
        let faces = (0..self.num_children(2)).into_par_iter();
        memory::collect(faces.map(|f| self.child_boundary::<N>(parent, f))).into_flattened()
    }

    /// The boundary of a child face as it is numbered: OpenSubdiv turns the children of quads and triangles
    /// like their parents, and begins those of other faces at the vertex.
    fn child_boundary<const N: usize>(&self, parent: &Mesh, child: usize) -> [HalfEdge; N] {
        let mut boundary = [HalfEdge(0); N];
        let first = match self.kind() {
            SplitKind::Quad => {
                let face = parent.corner_face(child as u32);
                match parent.face_size(face) {
                    4 => child - parent.corners(face).start as usize,
                    _ => 0,
                }
            }
            SplitKind::Triangle if child % 4 == 3 => 0,
            SplitKind::Triangle => child % 4,
        };
        let mut at = first;
        self.face_boundary(parent, child, |edge, sign| {
            boundary[at % N] = HalfEdge::new(self.edge_of(edge), sign > 0.0);
            at += 1;
        });
        boundary
    }
}

/// The children of a complex without non-manifold edges.
struct Children<'a> {
    split: &'a Split,
    parent: &'a Mesh,
}

impl Children<'_> {
    /// What follows from the boundaries of the faces, as [`Mesh::complete`] finds it.
    fn complete(&self, faces: Faces, corner_half_edge: Vec<HalfEdge>, edge_vertices: Vec<[u32; 2]>) -> Mesh {
        let (split, parent) = (self.split, self.parent);
        let corner_vertex = tails(&corner_half_edge, &edge_vertices);
        let edges = (0..split.num_children(1)).into_par_iter();
        let num_faces = |edge| match split.edge_parent(edge) {
            ChildEdge::Odd(_) => 2,
            ChildEdge::Even(h) => parent.edge_faces[h.edge() as usize],
        };
        let edge_faces = memory::collect(edges.clone().map(num_faces));
        let left_corner = memory::collect(edges.map(|edge| self.left_corners(edge))).into_flattened();

        let (vertex_offsets, vertex_half_edges) = self.spokes();
        let (fan_offsets, fan_corners) = self.fans();
        let mut corner_place = memory::filled(NONE, corner_vertex.len());
        for (place, &corner) in fan_corners.iter().enumerate() {
            corner_place[corner as usize] = place as u32;
        }
        // One fan each for the children of faces and edges.
        let more = split.num_children(0) - parent.num_vertices();
        let mut vertex_fans = memory::with_capacity(split.num_children(0) + 1);
        vertex_fans.extend_from_slice(&parent.vertex_fans);
        let fans = parent.fan_cyclic.len() as u32;
        vertex_fans.extend((1..=more as u32).map(|i| fans + i));
        let mut fan_cyclic = memory::with_capacity(fan_offsets.len() - 1);
        fan_cyclic.extend_from_slice(&parent.fan_cyclic);
        fan_cyclic.resize(fan_cyclic.len() + more - parent.num_edges(), true);
        fan_cyclic.extend(parent.edge_faces.iter().map(|&faces| faces == 2));
        Mesh {
            num_vertices: split.num_children(0),
            faces,
            corner_vertex,
            corner_half_edge,
            edge_vertices,
            edge_faces,
            left_corner,
            vertex_offsets,
            vertex_half_edges,
            vertex_fans,
            fan_offsets,
            fan_cyclic,
            fan_corners,
            corner_place,
        }
    }

    /// The corner `by` further on in the child face at a corner of the parent, from that at the parent's vertex on: the next
    /// lies at the midpoint of the edge that leaves the corner, the last at that of the edge that reaches it.
    #[inline]
    fn corner(&self, corner: u32, by: u32) -> u32 {
        let at = self.split.corner_at(self.parent, corner);
        match self.split.kind() {
            SplitKind::Quad => (at & !3) | ((at + by) & 3),
            SplitKind::Triangle => at - at % 3 + (at + by) % 3,
        }
    }

    /// The corner of the child at a corner of the parent that lies at the midpoint of the edge reaching it.
    #[inline]
    fn last(&self, corner: u32) -> u32 {
        self.corner(corner, if self.split.kind() == SplitKind::Quad { 3 } else { 2 })
    }

    /// [`Mesh::left_corner`] of both half-edges of a child edge.
    #[inline]
    fn left_corners(&self, edge: usize) -> [u32; 2] {
        let (split, parent) = (self.split, self.parent);
        match (split.edge_parent(edge), split.kind()) {
            // m -> v in the face on the right of v -> w, where v is the next corner; v -> m in that on the left.
            (ChildEdge::Even(h), _) => {
                let right = parent.left_corner(h.twin()).map(|c| self.last(parent.next_corner(c)));
                let left = parent.left_corner(h).map(|c| self.corner(c, 0));
                [right.unwrap_or(NONE), left.unwrap_or(NONE)]
            }
            // p -> m in the child at the next corner, m -> p in that at this one.
            (ChildEdge::Odd(c), SplitKind::Quad) => {
                [self.corner(parent.next_corner(c), 2), self.corner(c, 1)]
            }
            // In the child at the corner, and in the middle.
            (ChildEdge::Odd(c), SplitKind::Triangle) => {
                [self.corner(c, 1), split.middle_corner(parent, parent.next_corner(c))]
            }
        }
    }

    /// The half-edges that leave each vertex, ascending, and where they begin.
    fn spokes(&self) -> (Vec<u32>, Vec<HalfEdge>) {
        let (split, parent) = (self.split, self.parent);
        let inside = if split.kind() == SplitKind::Quad { 1 } else { 2 };
        self.round_vertices(
            (&parent.vertex_offsets, &parent.vertex_half_edges),
            |h| HalfEdge::new(split.even_edge(h), false),
            |corner| HalfEdge::new(corner, true),
            |faces| 2 + inside * faces,
            |e, out| {
                let sides = sides_of(e);
                let mut len = 0;
                for corner in sides.into_iter().filter_map(|h| parent.left_corner(h)) {
                    // To the centre; on triangles the child edges at both ends of the side begin or end here.
                    let odd = match split.kind() {
                        SplitKind::Quad => [Some(HalfEdge::new(corner, false)), None],
                        SplitKind::Triangle => {
                            let next = HalfEdge::new(parent.next_corner(corner), false);
                            [Some(HalfEdge::new(corner, true)), Some(next)]
                        }
                    };
                    for h in odd.into_iter().flatten() {
                        out[len] = h;
                        len += 1;
                    }
                }
                out[..len].sort_unstable();
                for (out, h) in out[len..].iter_mut().zip(sides) {
                    *out = HalfEdge::new(split.even_edge(h), true);
                }
            },
        )
    }

    /// The corners of each fan, and where they begin.
    fn fans(&self) -> (Vec<u32>, Vec<u32>) {
        let (split, parent) = (self.split, self.parent);
        let each = if split.kind() == SplitKind::Quad { 2 } else { 3 };
        self.round_vertices(
            (&parent.fan_offsets, &parent.fan_corners),
            |corner| self.corner(corner, 0),
            |corner| self.corner(corner, 2),
            |faces| each * faces,
            |e, out| {
                let mut children = out.chunks_exact_mut(each as usize);
                // Counter-clockwise on either side: the child at the end of the side, the one in the middle, that at its
                // beginning.
                for corner in sides_of(e).into_iter().filter_map(|h| parent.left_corner(h)) {
                    let out = children.next().expect("room for the children of each face");
                    if split.kind() == SplitKind::Triangle {
                        out[1] = split.middle_corner(parent, parent.previous_corner(corner));
                    }
                    out[0] = self.last(parent.next_corner(corner));
                    out[each as usize - 1] = self.corner(corner, 1);
                }
                // What is cyclic starts at its lowest corner.
                if parent.edge_faces[e] == 2 {
                    let lowest = (0..out.len()).min_by_key(|&i| out[i]).unwrap_or(0);
                    out.rotate_left(lowest);
                }
            },
        )
    }

    /// What lies round each child vertex, and where it begins: round those of vertices `at_vertex` of each item of the
    /// parent, round those of faces, if there are any, `at_centre` of each corner, and round those of edges what `at_edge`
    /// fills in, so many as `per_edge` says by the number of faces.
    fn round_vertices<T: Copy + Send + Sync>(
        &self,
        (starts, items): (&[u32], &[T]),
        at_vertex: impl Fn(T) -> T + Sync,
        at_centre: impl Fn(u32) -> T + Sync,
        per_edge: impl Fn(u32) -> u32,
        at_edge: impl Fn(usize, &mut [T]) + Sync,
    ) -> (Vec<u32>, Vec<T>) {
        let parent = self.parent;
        let corners = match self.split.kind() {
            SplitKind::Quad => 0..parent.num_corners() as u32,
            SplitKind::Triangle => 0..0,
        };
        let mut offsets = memory::with_capacity(starts.len() + parent.num_faces() + parent.num_edges());
        offsets.extend_from_slice(starts);
        let mut end = items.len() as u32;
        if !corners.is_empty() {
            offsets.extend((0..parent.num_faces() as u32).map(|f| end + parent.corners(f).end));
            end += corners.end;
        }
        let first_edge = offsets.len() - 1;
        offsets.extend(parent.edge_faces.iter().map(|&faces| {
            end += per_edge(faces);
            end
        }));
        let Some(&nothing) = items.first() else { return (offsets, Vec::new()) };
        let mut all = memory::filled(nothing, end as usize);
        let (of_vertices, rest) = all.split_at_mut(items.len());
        let (of_faces, of_edges) = rest.split_at_mut(corners.len());
        of_vertices.par_iter_mut().zip(items).for_each(|(out, &item)| *out = at_vertex(item));
        of_faces.par_iter_mut().zip(corners).for_each(|(out, corner)| *out = at_centre(corner));
        fill(0..parent.num_edges(), &offsets[first_edge..], of_edges, &at_edge);
        (offsets, all)
    }
}

fn sides_of(edge: usize) -> [HalfEdge; 2] {
    [true, false].map(|along| HalfEdge::new(edge as u32, along))
}

/// Few enough items that a run of them is done at once.
const RUN: usize = 8192;

/// Fills `out[offsets[i] - offsets[items.start]..]`, which belongs to item `i`, for all items, in parallel.
fn fill<T: Send>(
    items: Range<usize>,
    offsets: &[u32],
    out: &mut [T],
    each: &(impl Fn(usize, &mut [T]) + Sync),
) {
    let base = offsets[items.start];
    if items.len() <= RUN {
        for i in items {
            each(i, &mut out[(offsets[i] - base) as usize..(offsets[i + 1] - base) as usize]);
        }
        return;
    }
    let middle = items.start + items.len() / 2;
    let (left, right) = out.split_at_mut((offsets[middle] - base) as usize);
    rayon::join(
        || fill(items.start..middle, offsets, left, each),
        || fill(middle..items.end, offsets, right, each),
    );
}
