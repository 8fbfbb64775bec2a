//! The Whitney-type schemes of the split, row by row.

use super::complex::{Complex, OCT_EDGES, OCT_FACES};
use super::split::Parent;
use crate::topology::HalfEdge;

/// The schemes `S0 .. S3` of the split, a family with one parameter `c`.
///
/// With `w(i -> j)` the value along an edge and `F(..)` the flux through a triangle, outward from its parent cell:
///
/// ```text
/// S0  old vertex 1, midpoint 1/2 1/2, centroid of an octahedron 1/6 of each
/// S1  half of an edge 1/2;  in a triangle (m_ab -> m_ac) = 1/4 (w(b->c) + w(b->a) + w(a->c))
///     in an octahedron, k over the two vertices other than i, j and their opposites i', j':
///     (m_ij -> g) = a3 sum_k (w(i->k) + w(j->k)) + a4 sum_k (w(k->i') + w(k->j')) + a1 (w(i->j') + w(j->i'))
/// S2  in a triangle 1/4 each;  in a tetrahedron, out of the child at v:
///     1/8 F(opposite v) - 1/8 sum F(at v)
///     in an octahedron, into the child at face (i,j,k), the triangle (g, m_ik, m_ij):
///     f1 F(i,j,k) + f2 (F(i,j,k') + F(i,j',k)) + f3 F(i,j',k') + f4 F(i',j,k)
///         + f5 (F(i',j,k') + F(i',j',k)) + f6 F(i',j',k')
/// S3  tetrahedron: four tetrahedra 1/8, the octahedron 1/2;  octahedron: six 1/8, eight tetrahedra 1/32
///
/// a1 = -(c+1)/48, a3 = (c+17)/96, a4 = (c+9)/96
/// f1 = 7/96, f2 = c/96, f3 = -(2c+19)/96, f4 = -(2c+3)/96, f5 = (c+8)/96, f6 = -1/96
/// ```
///
/// These are (6.2) to (6.4) of Ke Wang's thesis and the only weights with the symmetry of the octahedron that
/// commute. `c` is a gauge: it moves `S1` by a multiple of `N d1` and `S2` by one of `d1 N`, so closed 1-forms never
/// see it. `S2` stays bounded for -7 <= c <= 1 ([`super::spectra`]); the default -5 makes one eigenvalue vanish.
///
/// Inside a tetrahedron the result is the de Rham map of its Whitney forms, for every `c`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Linear {
    /// The parameter.
    pub c: f64,
}

impl Default for Linear {
    fn default() -> Self {
        Linear { c: -5.0 }
    }
}

impl Linear {
    /// `a1`, `a2`, `a3`, `a4`; `a2 = 0` belongs to the edge `i -> j` itself, as symmetry demands.
    pub fn edge_weights(self) -> [f64; 4] {
        let c = self.c;
        [-(c + 1.0) / 48.0, 0.0, (c + 17.0) / 96.0, (c + 9.0) / 96.0]
    }

    /// `f1` to `f6`.
    pub fn face_weights(self) -> [f64; 6] {
        let c = self.c;
        [7.0, c, -(2.0 * c + 19.0), -(2.0 * c + 3.0), c + 8.0, -1.0].map(|n| n / 96.0)
    }

    /// The row of `S_r` for fine cell `i`: calls `emit(coarse cell, weight)` for each term. A cell may come twice.
    #[inline]
    pub(super) fn row(self, complex: &Complex, r: usize, i: usize, mut emit: impl FnMut(u32, f64)) {
        let parent = complex.parent(r, i);
        match r {
            0 => vertex_row(complex, parent, emit),
            1 => self.edge_row(complex, parent, emit),
            2 => self.triangle_row(complex, parent, emit),
            _ => match parent {
                Parent::Tet(t, child) => emit(t, if child < 4 { 0.125 } else { 0.5 }),
                Parent::Oct(o, child) => {
                    emit(complex.tets.len() as u32 + o, if child < 6 { 0.125 } else { 0.03125 })
                }
                _ => unreachable!("cells are children of cells"),
            },
        }
    }

    #[inline]
    fn edge_row(self, complex: &Complex, parent: Parent, mut emit: impl FnMut(u32, f64)) {
        let mut add = |h: HalfEdge, weight: f64| emit(h.edge(), h.sign() * weight);
        match parent {
            Parent::Edge(e, _) => emit(e, 0.5),
            Parent::Triangle(t, k) => {
                let sides = complex.triangles[t as usize];
                let [ab, bc, ca] = [0, 1, 2].map(|n| sides[(k + n) % 3]);
                add(bc, 0.25);
                add(ab.twin(), 0.25);
                add(ca.twin(), 0.25);
            }
            Parent::Oct(o, edge) => {
                let ([a1, _, a3, a4], [i, j]) = (self.edge_weights(), OCT_EDGES[edge]);
                let (far_i, far_j) = ((i + 3) % 6, (j + 3) % 6);
                let axis = 3 - i % 3 - j % 3;
                let mut add = |from, to, weight| add(complex.oct_edge(o as usize, from, to), weight);
                for k in [axis, axis + 3] {
                    add(i, k, a3);
                    add(j, k, a3);
                    add(k, far_i, a4);
                    add(k, far_j, a4);
                }
                add(i, far_j, a1);
                add(j, far_i, a1);
            }
            _ => unreachable!("edges are children of edges, triangles and octahedra"),
        }
    }

    #[inline]
    fn triangle_row(self, complex: &Complex, parent: Parent, mut emit: impl FnMut(u32, f64)) {
        match parent {
            Parent::Triangle(t, _) => emit(t, 0.25),
            Parent::Tet(t, i) => {
                for (k, face) in complex.tet_faces[t as usize].iter().enumerate() {
                    emit(face.triangle(), face.sign() * if k == i { 0.125 } else { -0.125 });
                }
            }
            Parent::Oct(o, child) => {
                let ([f1, f2, f3, f4, f5, f6], (f, s)) = (self.face_weights(), (child / 3, child % 3));
                // The number of a face has a bit for each axis.
                let [i, j, k] = [0, 1, 2].map(|n| 1 << (OCT_FACES[f][(s + n) % 3] % 3));
                let flips = [0, j, k, j | k, i, i | j, i | k, i | j | k];
                let weights = [f1, f2, f2, f3, f4, f5, f5, f6];
                for (flip, weight) in flips.into_iter().zip(weights) {
                    let face = complex.oct_faces[o as usize][f ^ flip];
                    emit(face.triangle(), face.sign() * weight);
                }
            }
            _ => unreachable!("triangles are children of triangles and cells"),
        }
    }
}

#[inline]
fn vertex_row(complex: &Complex, parent: Parent, mut emit: impl FnMut(u32, f64)) {
    match parent {
        Parent::Vertex(v) => emit(v, 1.0),
        Parent::Edge(e, _) => complex.edges[e as usize].iter().for_each(|&v| emit(v, 0.5)),
        Parent::Oct(o, _) => complex.octs[o as usize].iter().for_each(|&v| emit(v, 1.0 / 6.0)),
        _ => unreachable!("vertices are children of vertices, edges and octahedra"),
    }
}
