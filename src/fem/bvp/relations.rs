//! Combinations of edges whose form is 0, and edges that can be left out for them.

use std::collections::VecDeque;

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use crate::fem::{Elements, Quadrature};
use crate::topology::HalfEdge;

/// What a combination on one face may leave of a form, squared, relative to the largest there is.
const NOTHING: f64 = 1e-11;

impl Elements<'_> {
    /// Edges of the finest level without which the 1-forms of the faces inside are independent, ascending.
    ///
    /// On regular triangles the 24 edge splines of a face span 21 dimensions: `1, 1, -1` along the three directions is the
    /// form 0, and so are two more that grow linearly. A combination that is 0 on a surface is 0 on each of its faces, so
    /// what can be 0 is known from the first face and is followed from face to face; contradictions on the way leave
    /// three relations on a regular chart, one on a torus, none where there is an irregular vertex, or on quads. One edge is
    /// then left out for each, those by which the relations are told apart best. Costs are linear in the faces.
    pub fn dependent_edges(&self) -> Vec<u32> {
        let mesh = self.surface().hierarchy().finest().mesh();
        let mut relations = Relations {
            elements: self,
            local: Vec::new(),
            values: vec![None; mesh.num_edges()],
            visited: vec![false; mesh.num_faces()],
        };
        let mut dropped = Vec::new();
        for face in 0..mesh.num_faces() as u32 {
            if self.is_inside(face) && !relations.visited[face as usize] {
                dropped.extend(relations.component(face));
            }
        }
        dropped.sort_unstable();
        dropped
    }
}

struct Relations<'a> {
    elements: &'a Elements<'a>,
    /// For each basis that was met the combinations that are 0, over its edges.
    local: Vec<Option<DMatrix<f64>>>,
    /// For each edge its values in the relations of the component.
    values: Vec<Option<DVector<f64>>>,
    visited: Vec<bool>,
}

impl Relations<'_> {
    /// The combinations on a face that are 0.
    fn local(&mut self, face: u32) -> DMatrix<f64> {
        let number = self.elements.surface().face_basis(face);
        if self.local.len() <= number {
            self.local.resize(number + 1, None);
        }
        let elements = self.elements;
        let found = self.local[number].get_or_insert_with(|| {
            // Not by the elements' own rule, which may be too weak to tell forms apart.
            let surface = elements.surface();
            let points = surface.basis(number, Quadrature::new(surface.hierarchy().split_kind()).rules());
            let n = surface.face_cells(face).half_edges.len();
            let mut gram = DMatrix::zeros(n, n);
            for point in &points {
                let rows = DMatrix::from_fn(2, n, |k, i| point.forms1[i][k]);
                gram += rows.tr_mul(&rows) * point.weight;
            }
            let eigen = SymmetricEigen::new(gram);
            let most = eigen.eigenvalues.max();
            let zero: Vec<_> = (0..n)
                .filter(|&i| eigen.eigenvalues[i] < NOTHING * most)
                .map(|i| eigen.eigenvectors.column(i))
                .collect();
            if zero.is_empty() { DMatrix::zeros(n, 0) } else { DMatrix::from_columns(&zero) }
        });
        found.clone()
    }

    /// The edges that are left out of the faces that hang together with one.
    fn component(&mut self, seed: u32) -> Vec<u32> {
        let mesh = self.elements.surface().hierarchy().finest().mesh();
        let count = self.local(seed).ncols();
        let mut contradiction = DMatrix::zeros(count, count);
        let (mut queue, mut edges) = (VecDeque::from([seed]), Vec::new());
        self.visited[seed as usize] = true;
        while let Some(face) = queue.pop_front() {
            let local = self.local(face);
            let half_edges = self.elements.surface().face_cells(face).half_edges;
            let known: Vec<usize> = (0..half_edges.len())
                .filter(|&i| self.values[HalfEdge(half_edges[i]).edge() as usize].is_some())
                .collect();
            // Over the face's combinations, what the relations are there: by least squares of what is known.
            let here = if face == seed {
                DMatrix::identity(count, count)
            } else {
                let of = DMatrix::from_fn(known.len(), local.ncols(), |i, j| local[(known[i], j)]);
                let values = DMatrix::from_fn(known.len(), count, |i, j| {
                    let h = HalfEdge(half_edges[known[i]]);
                    let value = self.values[h.edge() as usize].as_ref().expect("it is known");
                    h.sign() * value[j]
                });
                let here = match (of.tr_mul(&of)).cholesky() {
                    Some(factor) if local.ncols() > 0 => factor.solve(&of.tr_mul(&values)),
                    _ => DMatrix::zeros(local.ncols(), count),
                };
                let off = values - of * &here;
                contradiction += off.tr_mul(&off);
                here
            };
            let all = local * here;
            for (i, &h) in half_edges.iter().enumerate() {
                let edge = HalfEdge(h).edge();
                if self.values[edge as usize].is_none() {
                    self.values[edge as usize] = Some(all.row(i).transpose() * HalfEdge(h).sign());
                    edges.push(edge);
                }
            }
            for corner in mesh.corners(face) {
                let beyond = mesh.left_corner(mesh.corner_half_edge(corner).twin());
                let Some(next) = beyond.map(|corner| mesh.corner_face(corner)) else { continue };
                if self.elements.is_inside(next) && !self.visited[next as usize] {
                    self.visited[next as usize] = true;
                    queue.push_back(next);
                }
            }
        }
        if count == 0 {
            return Vec::new();
        }
        let eigen = SymmetricEigen::new(contradiction);
        let kept: Vec<_> = (0..count)
            .filter(|&i| eigen.eigenvalues[i] < 1e-9)
            .map(|i| eigen.eigenvectors.column(i))
            .collect();
        if kept.is_empty() {
            return Vec::new();
        }
        let kept = DMatrix::from_columns(&kept);
        let values = &self.values;
        let mut rows: Vec<DVector<f64>> = edges
            .iter()
            .map(|&e| kept.tr_mul(values[e as usize].as_ref().expect("every edge was met")))
            .collect();
        // Complete pivoting; edges in the order in which they were met, so that ties are settled the same way.
        let mut dropped = Vec::new();
        for step in 0..kept.ncols() {
            let size = |i: usize| rows[i].amax();
            let at =
                (0..rows.len()).fold(0, |best, i| if size(i) > size(best) * (1.0 + 1e-9) { i } else { best });
            let pivot = rows[at].clone();
            let column = pivot.iamax();
            debug_assert!(pivot[column].abs() > 1e-9, "relation {step} is not independent");
            let scaled = &pivot / pivot[column];
            for row in &mut rows {
                let x = row[column];
                row.axpy(-x, &scaled, 1.0);
            }
            dropped.push(edges[at]);
        }
        dropped
    }
}
