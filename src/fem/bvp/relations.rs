//! Combinations of edges or faces whose form is 0, and cells that can be left out for them.

use std::collections::VecDeque;

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use crate::fem::{Elements, Quadrature};
use crate::limit::BasisPoint;
use crate::topology::{HalfEdge, Mesh};

/// What a combination on one face may leave of a form, squared, relative to the largest there is.
const NOTHING: f64 = 1e-11;

impl Elements<'_> {
    /// Cells of the finest level without which the forms of a degree are independent on the faces inside, ascending: edges
    /// of degree 1, faces of degree 2, none of degree 0.
    ///
    /// On regular triangles the 24 edge splines of a face span 21 dimensions: `1, 1, -1` along the three directions is the
    /// form 0, and so are two more that grow linearly. So are what they bound, 1 and -1 on the two kinds of faces and so
    /// on. A combination that is 0 on a surface is 0 on each of its faces, so what can be 0 is known from the first face
    /// and is followed from face to face; contradictions on the way leave three relations on a regular chart, one on a
    /// torus, none where there is an irregular vertex, or on quads. One cell is then left out for each, those by which the
    /// relations are told apart best. Costs are linear in the faces.
    ///
    /// # Panics
    /// If `degree > 2`.
    pub fn dependent(&self, degree: usize) -> Vec<u32> {
        let mesh = self.surface().hierarchy().finest().mesh();
        let cells = mesh.num_cells(degree);
        if degree == 0 {
            return Vec::new();
        }
        let mut relations = Relations {
            elements: self,
            degree,
            local: Vec::new(),
            values: vec![None; cells],
            visited: vec![false; mesh.num_faces()],
        };
        let mut dropped = Vec::new();
        for (seed, faces) in components(self) {
            if faces.into_iter().all(|face| relations.local(face).ncols() > 0) {
                dropped.extend(relations.component(seed));
            }
        }
        dropped.sort_unstable();
        dropped
    }
}

/// The faces inside that are across an edge of a face.
fn beside(elements: &Elements<'_>, mesh: &Mesh, face: u32) -> impl Iterator<Item = u32> {
    mesh.corners(face).filter_map(move |corner| {
        let beyond = mesh.left_corner(mesh.corner_half_edge(corner).twin());
        let next = beyond.map(|corner| mesh.corner_face(corner));
        next.filter(|&next| elements.is_inside(next))
    })
}

/// The faces inside that hang together, and the first of them.
fn components(elements: &Elements<'_>) -> Vec<(u32, Vec<u32>)> {
    let mesh = elements.surface().hierarchy().finest().mesh();
    let mut visited = vec![false; mesh.num_faces()];
    let mut components = Vec::new();
    for seed in (0..mesh.num_faces() as u32).filter(|&face| elements.is_inside(face)) {
        if std::mem::replace(&mut visited[seed as usize], true) {
            continue;
        }
        let (mut faces, mut at) = (vec![seed], 0);
        while let Some(&face) = faces.get(at) {
            at += 1;
            for next in beside(elements, mesh, face) {
                if !std::mem::replace(&mut visited[next as usize], true) {
                    faces.push(next);
                }
            }
        }
        components.push((seed, faces));
    }
    components
}

struct Relations<'a> {
    elements: &'a Elements<'a>,
    degree: usize,
    /// For each basis that was met the combinations that are 0, over its cells.
    local: Vec<Option<DMatrix<f64>>>,
    /// For each cell its values in the relations of the component.
    values: Vec<Option<DVector<f64>>>,
    visited: Vec<bool>,
}

impl Relations<'_> {
    /// The cells whose forms reach a face, with the signs with which it counts them.
    fn cells(&self, face: u32) -> Vec<(usize, f64)> {
        let cells = self.elements.surface().face_cells(face);
        match self.degree {
            1 => {
                cells.half_edges.iter().map(|&h| (HalfEdge(h).edge() as usize, HalfEdge(h).sign())).collect()
            }
            _ => cells.faces.iter().map(|&f| (f as usize, 1.0)).collect(),
        }
    }

    /// The combinations on a face that are 0.
    fn local(&mut self, face: u32) -> &DMatrix<f64> {
        let number = self.elements.surface().face_basis(face);
        if self.local.len() <= number {
            self.local.resize(number + 1, None);
        }
        let (elements, degree) = (self.elements, self.degree);
        self.local[number].get_or_insert_with(|| {
            // Not by the elements' own rule, which may be too weak to tell forms apart.
            let surface = elements.surface();
            let points = surface.basis(number, Quadrature::new(surface.hierarchy().split_kind()).rules());
            let rows = |point: &BasisPoint| match degree {
                1 => DMatrix::from_fn(2, point.forms1.len(), |k, i| point.forms1[i][k]),
                _ => DMatrix::from_fn(1, point.forms2.len(), |_, i| point.forms2[i]),
            };
            let squares = points.iter().map(|point| {
                let rows = rows(point);
                rows.tr_mul(&rows) * point.weight
            });
            let gram = squares.reduce(|a, b| a + b).expect("a rule has points");
            let n = gram.ncols();
            let eigen = SymmetricEigen::new(gram);
            let most = eigen.eigenvalues.max();
            let zero: Vec<_> = (0..n)
                .filter(|&i| eigen.eigenvalues[i] < NOTHING * most)
                .map(|i| eigen.eigenvectors.column(i))
                .collect();
            if zero.is_empty() { DMatrix::zeros(n, 0) } else { DMatrix::from_columns(&zero) }
        })
    }

    /// The cells that are left out of the faces that hang together with one.
    fn component(&mut self, seed: u32) -> Vec<u32> {
        let mesh = self.elements.surface().hierarchy().finest().mesh();
        let count = self.local(seed).ncols();
        let mut contradiction = DMatrix::zeros(count, count);
        let (mut queue, mut met) = (VecDeque::from([seed]), Vec::new());
        self.visited[seed as usize] = true;
        while let Some(face) = queue.pop_front() {
            let local = self.local(face).clone();
            let cells = self.cells(face);
            let known: Vec<usize> = (0..cells.len()).filter(|&i| self.values[cells[i].0].is_some()).collect();
            // Over the face's combinations, what the relations are there: by least squares of what is known.
            let here = if face == seed {
                DMatrix::identity(count, count)
            } else {
                let of = DMatrix::from_fn(known.len(), local.ncols(), |i, j| local[(known[i], j)]);
                let values = DMatrix::from_fn(known.len(), count, |i, j| {
                    let (cell, sign) = cells[known[i]];
                    sign * self.values[cell].as_ref().expect("it is known")[j]
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
            for (i, &(cell, sign)) in cells.iter().enumerate() {
                if self.values[cell].is_none() {
                    self.values[cell] = Some(all.row(i).transpose() * sign);
                    met.push(cell);
                }
            }
            for next in beside(self.elements, mesh, face) {
                if !std::mem::replace(&mut self.visited[next as usize], true) {
                    queue.push_back(next);
                }
            }
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
        let mut rows: Vec<DVector<f64>> =
            met.iter().map(|&cell| kept.tr_mul(values[cell].as_ref().expect("every cell was met"))).collect();
        // Complete pivoting; cells in the order in which they were met, so that ties are settled the same way.
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
            dropped.push(met[at] as u32);
        }
        dropped
    }
}
