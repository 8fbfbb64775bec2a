//! The split: a tetrahedron becomes four and an octahedron, an octahedron six octahedra and eight tetrahedra.
//! Children are numbered by rule, so that the fine complex is written down without searching.

use std::array::from_fn;

use rayon::prelude::*;

use super::complex::{
    Complex, ComplexError, HalfFace, OCT_EDGES, OCT_FACES, TET_EDGES, TET_FACES, check_size,
};
use crate::topology::HalfEdge;

/// What a fine cell is a child of, and which child: the order below is that of the numbering.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parent {
    /// A vertex that stays.
    Vertex(u32),
    /// The midpoint of an edge (vertex), or its half at the first or second vertex (edge).
    Edge(u32, usize),
    /// The edge at corner `k` of a triangle `(.., v_k, v_k+1, v_k+2, ..)`, from the midpoint towards `v_k+1` to that
    /// towards `v_k+2`; the triangle at corner `k`, `(v_k, m_k,k+1, m_k,k+2)`; or, `k = 3`, the middle one
    /// `(m_12, m_20, m_01)`.
    Triangle(u32, usize),
    /// The triangle that cuts off vertex `i` of a tetrahedron, outward from the child at `v_i`; the child at `v_i`;
    /// or the octahedron in the middle, `(m_23, m_13, m_12, m_01, m_02, m_03)`.
    Tet(u32, usize),
    /// Of an octahedron with centroid `g`: its centroid; the edge from the midpoint of edge `j` of [`OCT_EDGES`] to
    /// `g`; the triangle `(g, m_ik, m_ij)` for corner `s` of face `f` of [`OCT_FACES`], `f = (.., i, j, k, ..)`, whose
    /// number is `3f + s`; the octahedron at vertex `i`, with `g` opposite it; or the tetrahedron
    /// `(g, m_bc, m_ca, m_ab)` at face `f = (a, b, c)`.
    Oct(u32, usize),
}

/// The numbers of the pair `(i, j)` in [`OCT_EDGES`].
pub(super) fn oct_edge_number(i: usize, j: usize) -> usize {
    const NUMBERS: [[u8; 6]; 6] = numbers();
    usize::from(NUMBERS[i][j])
}

const fn numbers() -> [[u8; 6]; 6] {
    let mut numbers = [[u8::MAX; 6]; 6];
    let mut j = 0;
    while j < 12 {
        let [a, b] = OCT_EDGES[j];
        numbers[a][b] = j as u8;
        numbers[b][a] = j as u8;
        j += 1;
    }
    numbers
}

/// Face `f` of the octahedron in a tetrahedron: the face in whose middle it lies, if `f` has an even number of bits,
/// else the vertex that it cuts off.
const INNER: [usize; 8] = [0, 1, 2, 3, 3, 2, 1, 0];

impl Complex {
    /// The number of `r`-cells after splitting.
    ///
    /// # Panics
    /// If `r > 3`.
    pub fn num_children(&self, r: usize) -> u128 {
        let [v, e, t] = [0, 1, 2].map(|r| self.num_cells(r) as u128);
        let (tets, octs) = (self.tets.len() as u128, self.octs.len() as u128);
        [v + e + octs, 2 * e + 3 * t + 12 * octs, 4 * (t + tets) + 24 * octs, 5 * tets + 14 * octs][r]
    }

    /// What fine `r`-cell `i` is a child of.
    ///
    /// # Panics
    /// If there is no such cell, or `r > 3`.
    pub fn parent(&self, r: usize, i: usize) -> Parent {
        let (v, e, t) = (self.num_vertices, self.edges.len(), self.triangles.len());
        let (tets, octs) = (self.tets.len(), self.octs.len());
        // For each kind of parent how many there are and how many children of this dimension each has.
        let kinds: [[usize; 2]; 6] = match r {
            0 => [[v, 1], [e, 1], [0, 1], [0, 1], [octs, 1], [0, 1]],
            1 => [[0, 1], [e, 2], [t, 3], [0, 1], [octs, 12], [0, 1]],
            2 => [[0, 1], [0, 1], [t, 4], [tets, 4], [octs, 24], [0, 1]],
            _ => [[0, 1], [0, 1], [tets, 4], [octs, 8], [tets, 1], [octs, 6]],
        };
        let mut rest = i;
        for (kind, [number, children]) in kinds.into_iter().enumerate() {
            if rest < number * children {
                let (parent, child) = ((rest / children) as u32, rest % children);
                return match (r, kind) {
                    (3, 2) => Parent::Tet(parent, child),
                    (3, 3) => Parent::Oct(parent, 6 + child),
                    (3, 4) => Parent::Tet(parent, 4),
                    (3, _) => Parent::Oct(parent, child),
                    (_, 0) => Parent::Vertex(parent),
                    (_, 1) => Parent::Edge(parent, child),
                    (_, 2) => Parent::Triangle(parent, child),
                    (_, 3) => Parent::Tet(parent, child),
                    _ => Parent::Oct(parent, child),
                };
            }
            rest -= number * children;
        }
        panic!("no {r}-cell {i} after splitting")
    }

    /// The next level. Children inherit the orientation of their parents; [`Parent`] says how they are numbered.
    ///
    /// # Errors
    /// [`ComplexError::TooLarge`] if it cannot be indexed.
    pub fn split(&self) -> Result<Complex, ComplexError> {
        for (kind, r) in [("vertices", 0), ("edges", 1), ("triangles", 2), ("cells", 3)] {
            check_size(kind, self.num_children(r))?;
        }
        let (tets, octs, tet_faces, oct_faces) = self.child_cells();
        Ok(Complex {
            num_vertices: self.num_children(0) as usize,
            edges: self.child_edges(),
            triangles: self.child_triangles(),
            tets,
            octs,
            tet_faces,
            oct_faces,
        })
    }

    /// The midpoint of an edge.
    #[inline]
    fn midpoint(&self, h: HalfEdge) -> u32 {
        self.num_vertices as u32 + h.edge()
    }

    #[inline]
    fn centroid(&self, o: usize) -> u32 {
        (self.num_vertices + self.edges.len() + o) as u32
    }

    /// The fine edge at corner `k` of a triangle.
    #[inline]
    fn corner_edge(&self, t: u32, k: usize) -> HalfEdge {
        HalfEdge::new(2 * self.edges.len() as u32 + 3 * t + k as u32, true)
    }

    /// The fine edge from the midpoint of edge `(i, j)` of an octahedron to its centroid.
    #[inline]
    fn inner_edge(&self, o: usize, i: usize, j: usize) -> HalfEdge {
        let first = 2 * self.edges.len() + 3 * self.triangles.len() + 12 * o;
        HalfEdge::new((first + oct_edge_number(i, j)) as u32, true)
    }

    /// Which corner of a triangle a vertex is.
    #[inline]
    pub(super) fn corner_at(&self, t: u32, vertex: u32) -> usize {
        let [x, y, _] = self.triangles[t as usize];
        if self.tail(x) == vertex {
            0
        } else if self.tail(y) == vertex {
            1
        } else {
            2
        }
    }

    /// The fine edge that cuts off corner `a` of a triangle, from the midpoint towards `b`.
    #[inline]
    fn across_corner(&self, t: u32, a: u32, b: u32) -> HalfEdge {
        let k = self.corner_at(t, a);
        let edge = self.corner_edge(t, k);
        let along = self.tail(self.triangles[t as usize][(k + 1) % 3]) == b;
        if along { edge } else { edge.twin() }
    }

    fn child_edges(&self) -> Vec<[u32; 2]> {
        let (e, t) = (self.edges.len(), self.triangles.len());
        let mut fine = vec![[0; 2]; 2 * e + 3 * t + 12 * self.octs.len()];
        let (halves, rest) = fine.split_at_mut(2 * e);
        let (corners, inner) = rest.split_at_mut(3 * t);
        halves.par_chunks_exact_mut(2).zip(&self.edges).enumerate().for_each(|(e, (halves, &[a, b]))| {
            let m = (self.num_vertices + e) as u32;
            halves.copy_from_slice(&[[a, m], [m, b]]);
        });
        corners.par_chunks_exact_mut(3).zip(&self.triangles).for_each(|(edges, sides)| {
            let [x, y, z] = sides.map(|h| self.midpoint(h));
            edges.copy_from_slice(&[[x, z], [y, x], [z, y]]);
        });
        inner.par_chunks_exact_mut(12).enumerate().for_each(|(o, edges)| {
            for (edge, [i, j]) in edges.iter_mut().zip(OCT_EDGES) {
                *edge = [self.midpoint(self.oct_edge(o, i, j)), self.centroid(o)];
            }
        });
        fine
    }

    fn child_triangles(&self) -> Vec<[HalfEdge; 3]> {
        let (t, tets) = (self.triangles.len(), self.tets.len());
        let mut fine = vec![[HalfEdge(0); 3]; 4 * (t + tets) + 24 * self.octs.len()];
        let (parts, rest) = fine.split_at_mut(4 * t);
        let (cuts, inner) = rest.split_at_mut(4 * tets);
        parts.par_chunks_exact_mut(4).zip(&self.triangles).enumerate().for_each(|(t, (parts, sides))| {
            let corner = |k: usize| self.corner_edge(t as u32, k);
            for k in 0..3 {
                parts[k] = [first_half(sides[k]), corner(k), second_half(sides[(k + 2) % 3])];
            }
            parts[3] = [2, 0, 1].map(|k| corner(k).twin());
        });
        cuts.par_chunks_exact_mut(4).enumerate().for_each(|(t, cuts)| {
            let (v, faces) = (&self.tets[t], &self.tet_faces[t]);
            for (i, cut) in cuts.iter_mut().enumerate() {
                let [x, y, z] = TET_FACES[i];
                // From the midpoint towards `a` to the next one, in the face opposite `c`.
                let side = |a: usize, c: usize| self.across_corner(faces[c].triangle(), v[i], v[a]);
                *cut = [side(x, z), side(y, x), side(z, y)];
            }
        });
        inner.par_chunks_exact_mut(24).enumerate().for_each(|(o, inner)| {
            let (v, faces) = (&self.octs[o], &self.oct_faces[o]);
            for (number, triangle) in inner.iter_mut().enumerate() {
                let (f, s) = (number / 3, number % 3);
                let [i, j, k] = [0, 1, 2].map(|n| OCT_FACES[f][(s + n) % 3]);
                *triangle = [
                    self.inner_edge(o, i, k).twin(),
                    self.across_corner(faces[f].triangle(), v[i], v[k]),
                    self.inner_edge(o, i, j),
                ];
            }
        });
        fine
    }

    #[allow(clippy::type_complexity)] // the four arrays of cells
    fn child_cells(&self) -> (Vec<[u32; 4]>, Vec<[u32; 6]>, Vec<[HalfFace; 4]>, Vec<[HalfFace; 8]>) {
        let (num_tets, num_octs) = (self.tets.len(), self.octs.len());
        let cuts = 4 * self.triangles.len();
        let inner = cuts + 4 * num_tets;
        // The part of a side at one of its vertices, and its middle, turned as the side is.
        let corner = |face: HalfFace, vertex: u32| {
            let k = self.corner_at(face.triangle(), vertex) as u32;
            HalfFace::new(4 * face.triangle() + k, face.sign() > 0.0)
        };
        let middle = |face: HalfFace| HalfFace::new(4 * face.triangle() + 3, face.sign() > 0.0);

        let (tets, octs) = (4 * num_tets + 8 * num_octs, num_tets + 6 * num_octs);
        let (mut tets, mut tet_faces) = (vec![[0; 4]; tets], vec![[HalfFace(0); 4]; tets]);
        let (mut octs, mut oct_faces) = (vec![[0; 6]; octs], vec![[HalfFace(0); 8]; octs]);
        let (tets_of_tets, tets_of_octs) = tets.split_at_mut(4 * num_tets);
        let (tet_faces_of_tets, tet_faces_of_octs) = tet_faces.split_at_mut(4 * num_tets);
        let (octs_of_tets, octs_of_octs) = octs.split_at_mut(num_tets);
        let (oct_faces_of_tets, oct_faces_of_octs) = oct_faces.split_at_mut(num_tets);

        let tets_and_faces =
            tets_of_tets.par_chunks_exact_mut(4).zip(tet_faces_of_tets.par_chunks_exact_mut(4));
        let of_tets = tets_and_faces.zip(octs_of_tets.par_iter_mut().zip(oct_faces_of_tets)).enumerate();
        of_tets.for_each(|(t, ((tets, tet_faces), (oct, oct_faces)))| {
            let (v, faces) = (&self.tets[t], &self.tet_faces[t]);
            let cut = |i: usize, outward| HalfFace::new((cuts + 4 * t + i) as u32, outward);
            let [m01, m02, m03, m12, m13, m23] =
                TET_EDGES.map(|[i, j]| self.midpoint(self.tet_edge(t, i, j)));
            let m =
                [[v[0], m01, m02, m03], [m01, v[1], m12, m13], [m02, m12, v[2], m23], [m03, m13, m23, v[3]]];
            tets.copy_from_slice(&m);
            for (i, tet_faces) in tet_faces.iter_mut().enumerate() {
                let side = |k: usize| if k == i { cut(i, true) } else { corner(faces[k], v[i]) };
                *tet_faces = from_fn(side);
            }
            *oct = [m23, m13, m12, m01, m02, m03];
            *oct_faces = from_fn(|f| match f.count_ones() % 2 {
                0 => middle(faces[INNER[f]]),
                _ => cut(INNER[f], false),
            });
        });

        let tets_and_faces =
            tets_of_octs.par_chunks_exact_mut(8).zip(tet_faces_of_octs.par_chunks_exact_mut(8));
        let octs_and_faces =
            octs_of_octs.par_chunks_exact_mut(6).zip(oct_faces_of_octs.par_chunks_exact_mut(6));
        tets_and_faces.zip(octs_and_faces).enumerate().for_each(
            |(o, ((tets, tet_faces), (octs, oct_faces)))| {
                let (v, faces, g) = (&self.octs[o], &self.oct_faces[o], self.centroid(o));
                let m = |i: usize, j: usize| self.midpoint(self.oct_edge(o, i, j));
                let inside =
                    |f: usize, s: usize, outward| HalfFace::new((inner + 24 * o + 3 * f + s) as u32, outward);
                for (f, (tet, sides)) in tets.iter_mut().zip(tet_faces).enumerate() {
                    let [a, b, c] = OCT_FACES[f];
                    *tet = [g, m(b, c), m(c, a), m(a, b)];
                    *sides =
                        [middle(faces[f]), inside(f, 0, false), inside(f, 1, false), inside(f, 2, false)];
                }
                for (i, (oct, sides)) in octs.iter_mut().zip(oct_faces).enumerate() {
                    let axis = i % 3;
                    let vertex = |j: usize| match j {
                        _ if j == i => v[i],
                        _ if j % 3 == axis => g,
                        _ => m(i, j),
                    };
                    let side = |f: usize| {
                        let own = (f >> axis & 1 == 1) == (i >= 3);
                        let f = if own { f } else { f ^ (1 << axis) };
                        let s = OCT_FACES[f].iter().position(|&j| j == i).unwrap_or(0);
                        if own { corner(faces[f], v[i]) } else { inside(f, s, true) }
                    };
                    (*oct, *sides) = (from_fn(vertex), from_fn(side));
                }
            },
        );
        (tets, octs, tet_faces, oct_faces)
    }
}

/// The fine edge from the tail of a half-edge to its midpoint.
#[inline]
pub(super) fn first_half(h: HalfEdge) -> HalfEdge {
    HalfEdge::new(2 * h.edge() + (h.0 & 1), h.0 & 1 == 0)
}

/// The fine edge from the midpoint of a half-edge to its head.
#[inline]
pub(super) fn second_half(h: HalfEdge) -> HalfEdge {
    HalfEdge::new(2 * h.edge() + 1 - (h.0 & 1), h.0 & 1 == 0)
}
