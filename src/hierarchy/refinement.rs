use rayon::prelude::*;

use crate::cochain::{Cochain, Value, along, d1};
use crate::scheme::{Homotopy, whitney};
use crate::sparse::{Csr, Row, apply, assemble, dot, row_of, zero};
use crate::topology::{Mesh, Split};

/// One step of refinement: the split and the two tables of the scheme.
#[derive(Clone, Debug)]
pub struct Refinement {
    split: Split,
    homotopy: Homotopy,
}

/// The subdivision operators of one step, from level `K` to its refinement `K'`.
#[derive(Clone, Debug)]
pub struct Operators {
    /// `(|V'|, |V|)`: vertices.
    pub s0: Csr,
    /// `(|E'|, |E|)`: edges, each in its own direction. `d0' S0 = S1 d0`.
    pub s1: Csr,
    /// `(|F'|, |F|)`: faces. `d1' S1 = S2 d1`; the columns sum to 1.
    pub s2: Csr,
}

impl Refinement {
    pub(super) fn new(split: Split, homotopy: Homotopy) -> Self {
        Refinement { split, homotopy }
    }

    /// The numbering of the children.
    pub fn split(&self) -> &Split {
        &self.split
    }

    /// The tables `H0` and `H1`.
    pub fn homotopy(&self) -> &Homotopy {
        &self.homotopy
    }

    /// `S0 = W0 + H0 d0`, `S1 = W1 + d0' H0 + H1 d1`, `S2 = W2 + d1' H1`, row by row.
    pub(super) fn operators(&self, parent: &Mesh, child: &Mesh) -> Operators {
        let h0 = &self.homotopy.h0;
        let shape = |k| (child.num_cells(k), parent.num_cells(k));
        let s0 = assemble(shape(0), |vertex, row| {
            for (&e, &weight) in std::iter::zip(row_of(h0, vertex).0, row_of(h0, vertex).1) {
                let [a, b] = parent.edges()[e as usize];
                row.add(a, -weight);
                row.add(b, weight);
            }
            // Last: at a vertex of high valence the many small terms before it lose less that way.
            whitney::w0(parent, self.split.vertex_parent(vertex), |v, weight| row.add(v, weight));
        });
        let s1 = assemble(shape(1), |edge, row| self.add_s1_row(parent, child, edge, 1.0, row));
        let s2 = assemble(shape(2), |face, row| self.add_s2_row(parent, child, face, 1.0, row));
        Operators { s0, s1, s2 }
    }

    /// Adds `scale` times the row of `S1` of a child edge.
    pub(crate) fn add_s1_row(&self, parent: &Mesh, child: &Mesh, edge: usize, scale: f64, row: &mut Row) {
        let Homotopy { h0, h1 } = &self.homotopy;
        whitney::w1(parent, self.split.kind(), self.split.edge_parent(edge), |h, weight| {
            row.add(h.edge(), scale * weight * h.sign())
        });
        let [tail, head] = child.edges()[edge];
        row.add_row(h0, head as usize, scale);
        row.add_row(h0, tail as usize, -scale);
        for (&f, &weight) in std::iter::zip(row_of(h1, edge).0, row_of(h1, edge).1) {
            for h in parent.face_half_edges(f) {
                row.add(h.edge(), scale * weight * h.sign());
            }
        }
    }

    /// Adds `scale` times the row of `S2` of a child face.
    pub(crate) fn add_s2_row(&self, parent: &Mesh, child: &Mesh, face: usize, scale: f64, row: &mut Row) {
        let of = self.split.face_parent(parent, face);
        row.add(of, scale * whitney::w2(parent, self.split.kind(), of));
        for h in child.face_half_edges(face as u32) {
            row.add_row(&self.homotopy.h1, h.edge() as usize, scale * h.sign());
        }
    }

    /// The same operators applied to a cochain without forming them: a displacement for each child
    /// vertex, a value for each child edge, then the differences.
    pub(super) fn apply<const K: usize, T: Value>(
        &self,
        parent: &Mesh,
        child: &Mesh,
        x: &Cochain<K, T>,
    ) -> Cochain<K, T> {
        assert_eq!(x.len(), parent.num_cells(K), "a cochain of another mesh");
        let values = match K {
            0 => self.apply_0(parent, x.values()),
            1 => self.apply_1(parent, child, x.values()),
            2 => self.apply_2(parent, child, x.values()),
            _ => unreachable!("a surface has cells of dimension 0, 1 and 2"),
        };
        Cochain::new(values)
    }

    fn apply_0<T: Value>(&self, parent: &Mesh, x: &[T]) -> Vec<T> {
        let zero = zero(x);
        let h0 = &self.homotopy.h0;
        (0..self.split.num_children(0))
            .into_par_iter()
            .map(|vertex| {
                let mut sum = zero;
                whitney::w0(parent, self.split.vertex_parent(vertex), |v, weight| {
                    sum = sum + x[v as usize] * weight;
                });
                for (&e, &weight) in std::iter::zip(row_of(h0, vertex).0, row_of(h0, vertex).1) {
                    let [a, b] = parent.edges()[e as usize];
                    sum = sum + (x[b as usize] - x[a as usize]) * weight;
                }
                sum
            })
            .collect()
    }

    fn apply_1<T: Value>(&self, parent: &Mesh, child: &Mesh, c: &[T]) -> Vec<T> {
        let displacement = apply(&self.homotopy.h0, c);
        let curl = d1(parent, c);
        child
            .edges()
            .par_iter()
            .enumerate()
            .map(|(edge, &[tail, head])| {
                let mut sum = displacement[head as usize] - displacement[tail as usize];
                whitney::w1(parent, self.split.kind(), self.split.edge_parent(edge), |h, weight| {
                    sum = sum + along(c, h) * weight;
                });
                match dot(row_of(&self.homotopy.h1, edge), &curl) {
                    Some(value) => sum + value,
                    None => sum,
                }
            })
            .collect()
    }

    fn apply_2<T: Value>(&self, parent: &Mesh, child: &Mesh, density: &[T]) -> Vec<T> {
        let across = apply(&self.homotopy.h1, density);
        (0..child.num_faces() as u32)
            .into_par_iter()
            .map(|face| {
                let of = self.split.face_parent(parent, face as usize);
                let share = density[of as usize] * whitney::w2(parent, self.split.kind(), of);
                let boundary = child.face_half_edges(face).iter();
                boundary.fold(share, |sum, h| sum + across[h.edge() as usize] * h.sign())
            })
            .collect()
    }
}
