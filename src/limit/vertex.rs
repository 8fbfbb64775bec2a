//! The limit at a vertex: its position, its tangents, and a 1-form's values along them.
//!
//! At an irregular vertex the parametrisation of a face has no derivative, but the surface has a tangent plane and
//! a 1-form a covector there. With `t_i` OpenSubdiv's limit tangent masks, left eigenvectors of `S0` round the
//! vertex with eigenvalues `lambda_i`, the rows `phi_i` with
//!
//! ```text
//! phi_i S1 = lambda_i phi_i        phi_i d0 = t_i
//! ```
//!
//! give `omega(T_i) = phi_i c` along `T_i = t_i x`. They are found as `phi = T + psi d1`: `T` any lift of `t` to the
//! edges, then `T S1 - lambda T = r d1` and `psi (lambda - F) = r`, `F` the fan block of `S2`. At a crease there
//! is one such pair for each sector, at a sharp corner the two edges of a sector take its place.
//!
//! Where `lambda` is an eigenvalue of `F` too (valence 3 of Loop's own rule, boundary vertices of one face) a form with
//! curl has no limit vector; the part of the curl is left out.
//!
//! Darts, whose smooth masks are not left eigenvectors, and the vertex rules of modified Loop take the dominant
//! eigenvectors that are even and odd under reflection.

use nalgebra::{DMatrix, DVector, RowDVector};

use super::Limit;
use super::model::{LEVELS, Model, block, cage, dense};
use super::neighbourhood::{Cells, Configuration, around_corner, fan_cells};
use crate::hierarchy::{HierarchyError, refiner};
use crate::osd::Rule;
use crate::scheme::Scheme;
use crate::sparse::{Value, row_of};
use crate::topology::SplitKind;

/// What a configuration says of its vertex, over the edges of [`fan_cells`].
#[derive(Clone, Debug)]
pub struct VertexTable {
    /// `K0` of the vertex.
    k0: Vec<f64>,
    /// `phi_1` and `phi_2`, turning counter-clockwise; `None` where there is no tangent plane, at a sharp vertex
    /// without sharp edges.
    phi: Option<[Vec<f64>; 2]>,
    /// What `phi_i` takes less of an edge where modified Loop's `eps` at its end pulls on its midpoint: the weight
    /// of the midpoint in `t_i` over `lambda_i`, on smooth spokes.
    pull: [Vec<f64>; 2],
    /// The vertices of each edge, as numbers in the fan.
    ends: Vec<[usize; 2]>,
}

impl VertexTable {
    /// `phi_1` and `phi_2`.
    pub fn covectors(&self) -> Option<&[Vec<f64>; 2]> {
        self.phi.as_ref()
    }

    /// By how much an `eps` at the end of each edge lessens its weight in `phi_1` and `phi_2`.
    pub fn pull(&self) -> &[Vec<f64>; 2] {
        &self.pull
    }

    /// The values of a 1-form along the two tangents, from its values on the edges; NaN where there are none.
    pub fn along_tangents<T: Value>(&self, c: &[T]) -> [T; 2] {
        match &self.phi {
            Some(phi) => [sum(&phi[0], c), sum(&phi[1], c)],
            None => [c[0] * f64::NAN; 2],
        }
    }

    /// The limit of a 0-form and its differences along the two tangents.
    pub fn limit<T: Value>(&self, x: &[T]) -> (T, [T; 2]) {
        let differences: Vec<T> = self.ends.iter().map(|&[a, b]| x[b] - x[a]).collect();
        (x[0] + sum(&self.k0, &differences), self.along_tangents(&differences))
    }
}

fn sum<T: Value>(weights: &[f64], x: &[T]) -> T {
    weights.iter().zip(x).fold(x[0] * 0.0, |sum, (&weight, &x)| sum + x * weight)
}

/// The table of a configuration, whatever the position in it.
///
/// # Errors
/// If the model does not fit memory or OpenSubdiv fails.
pub fn table(
    kind: SplitKind,
    scheme: Scheme,
    configuration: Configuration,
) -> Result<VertexTable, HierarchyError> {
    let model = Model::new(kind, scheme, configuration, LEVELS)?;
    let hierarchy = model.hierarchy();
    let top = hierarchy.level(LEVELS - 1);
    let start = top.mesh().fans(0).next().expect("a model has faces").corners[0];
    let child = hierarchy.refinement(LEVELS).split().corner_at(top.mesh(), start);
    let fan = |level: usize, corner: u32| -> Cells {
        let level = hierarchy.level(level);
        let (found, corners) = around_corner(level.mesh(), level.tags(), corner);
        fan_cells(level.mesh(), &corners, found.cyclic)
    };
    let (parent, child) = (fan(LEVELS - 1, start), fan(LEVELS, child));
    let ends = ends(kind, configuration);
    let limit = Limit::new(hierarchy, LEVELS - 1)?;
    let k0 = dense(&block(limit.k0(), &parent.signed()[1], &[(0, 1.0)])).as_slice().to_vec();

    let n = ends.len();
    let phi = match (configuration.rule, configuration.cyclic) {
        (Rule::Corner, true) => None,
        (Rule::Corner, false) => Some([0, n - 1].map(|edge| {
            let mut unit = vec![0.0; n];
            unit[edge] = 1.0;
            (unit, vec![0.0; n])
        })),
        _ => {
            let operators = hierarchy.operators(LEVELS);
            let steps = [&operators.s0, &operators.s1, &operators.s2];
            let [a, b] = [parent.signed(), child.signed()];
            let blocks = [0, 1, 2].map(|k| dense(&block(steps[k], &a[k], &b[k])));
            let masks = opensubdivs_tangents(kind, scheme, configuration, &child)?;
            let fan = Fan { kind, configuration, blocks, ends: &ends };
            fan.covectors(masks, &k0)
        }
    };
    let (phi, pull) = phi.map_or((None, Default::default()), |pairs| {
        let [(a, pull_a), (b, pull_b)] = pairs;
        (Some([a, b]), [pull_a, pull_b])
    });
    Ok(VertexTable { k0, phi, pull, ends })
}

/// The vertices of the edges of [`fan_cells`].
fn ends(kind: SplitKind, c: Configuration) -> Vec<[usize; 2]> {
    let n = c.faces as usize;
    let step = if kind == SplitKind::Quad { 2 } else { 1 };
    let w = |i: usize| if c.cyclic { 1 + step * (i % n) } else { 1 + step * i };
    let face = |i: usize| match kind {
        SplitKind::Quad => vec![[0, w(i)], [w(i), w(i) + 1], [w(i) + 1, w(i + 1)]],
        SplitKind::Triangle => vec![[0, w(i)], [w(i), w(i + 1)]],
    };
    let mut ends: Vec<_> = (0..n).flat_map(face).collect();
    if !c.cyclic {
        ends.push([0, w(n)]);
    }
    ends
}

/// OpenSubdiv's tangent masks, over the vertices of the fan on the finest level.
fn opensubdivs_tangents(
    kind: SplitKind,
    scheme: Scheme,
    configuration: Configuration,
    cells: &Cells,
) -> Result<[RowDVector<f64>; 2], HierarchyError> {
    let (refiner, _) = refiner(&cage(kind, configuration), scheme, LEVELS, true)?;
    let stencils = refiner.limit_stencils()?;
    Ok([&stencils.tangent1, &stencils.tangent2].map(|stencil| {
        let mut row = RowDVector::zeros(cells.vertices.len());
        let (columns, weights) = row_of(stencil, 0);
        for (column, &weight) in columns.iter().zip(weights) {
            if let Some(at) = cells.vertices.iter().position(|v| v == column) {
                row[at] += weight;
            }
        }
        row
    }))
}

/// The fan of a vertex with the blocks of `S0`, `S1` and `S2` on it.
struct Fan<'a> {
    kind: SplitKind,
    configuration: Configuration,
    blocks: [DMatrix<f64>; 3],
    ends: &'a [[usize; 2]],
}

impl Fan<'_> {
    fn covectors(&self, masks: [RowDVector<f64>; 2], k0: &[f64]) -> Option<[(Vec<f64>, Vec<f64>); 2]> {
        let is_tangent = |t: &RowDVector<f64>| {
            let scale = t.norm();
            scale > 0.0 && (t * &self.blocks[0] - t * self.eigenvalue(t)).norm() <= 1e-12 * scale
        };
        let tangents = match masks.iter().all(is_tangent) {
            true => masks,
            // Round a circle the even one points along the first spoke; in a sector the odd one runs along the crease.
            false => {
                let even_first = self.configuration.cyclic;
                [self.dominant(even_first, k0)?, self.dominant(!even_first, k0)?]
            }
        };
        Some(tangents.map(|t| (self.covector(&t), self.pull(&t))))
    }

    fn eigenvalue(&self, t: &RowDVector<f64>) -> f64 {
        (t * &self.blocks[0]).dot(t) / t.norm_squared()
    }

    /// `phi` over `t`.
    fn covector(&self, t: &RowDVector<f64>) -> Vec<f64> {
        let lambda = self.eigenvalue(t);
        let lift = self.lift(t);
        let rest = &lift * &self.blocks[1] - &lift * lambda;
        // Each face has an edge of its own, the second of its list; there d1 is 1 in its column.
        let (faces, per_face) = (self.configuration.faces as usize, self.edges_per_face());
        let r = DVector::from_iterator(faces, (0..faces).map(|i| rest[per_face * i + 1]));
        let system = (DMatrix::identity(faces, faces) * lambda - &self.blocks[2]).transpose();
        // Where lambda is an eigenvalue of F too, nothing in r feeds that mode: it is left at 0.
        let psi = system.svd(true, true).solve(&r, 1e-9).expect("a tolerance is positive");
        (0..self.ends.len())
            .map(|e| lift[e] + self.d1(e).map(|(f, sign)| sign * psi[f]).sum::<f64>())
            .collect()
    }

    /// The weights of the midpoints of smooth spokes in `t`, over its eigenvalue.
    fn pull(&self, t: &RowDVector<f64>) -> Vec<f64> {
        let lambda = self.eigenvalue(t);
        let (last, begins_sharp) = (self.ends.len() - 1, self.configuration.rule != Rule::Smooth);
        let is_sharp = |e: usize| (begins_sharp && e == 0) || (!self.configuration.cyclic && e == last);
        let pull = |(e, ends): (usize, &[usize; 2])| match ends[0] == 0 && !is_sharp(e) {
            true => t[ends[1]] / lambda,
            false => 0.0,
        };
        self.ends.iter().enumerate().map(pull).collect()
    }

    fn edges_per_face(&self) -> usize {
        if self.kind == SplitKind::Quad { 3 } else { 2 }
    }

    /// The faces of an edge of the fan, with signs.
    fn d1(&self, edge: usize) -> impl Iterator<Item = (usize, f64)> {
        let (n, per_face) = (self.configuration.faces as usize, self.edges_per_face());
        let (face, place) = (edge / per_face, edge % per_face);
        let left = (face < n).then_some((face, 1.0));
        let before = match (place, face) {
            (1.., _) => None,
            (0, 0) => self.configuration.cyclic.then_some(n - 1),
            (0, _) => Some(face - 1),
        };
        left.into_iter().chain(before.map(|face| (face, -1.0)))
    }

    /// A row on edges with `lift d0 = t`: along the spokes, and half from either side to the vertices opposite.
    fn lift(&self, t: &RowDVector<f64>) -> RowDVector<f64> {
        let (n, cyclic) = (self.configuration.faces as usize, self.configuration.cyclic);
        let per_face = self.edges_per_face();
        let mut lift = RowDVector::zeros(self.ends.len());
        let spoke = |i: usize| if cyclic { per_face * (i % n) } else { per_face * i };
        for i in 0..n + usize::from(!cyclic) {
            lift[spoke(i)] += t[self.ends[spoke(i)][1]];
        }
        if self.kind == SplitKind::Quad {
            for i in 0..n {
                let half = t[self.ends[3 * i + 1][1]] / 2.0;
                lift[spoke(i)] += half;
                lift[3 * i + 1] += half;
                lift[spoke(i + 1)] += half;
                lift[3 * i + 2] -= half;
            }
        }
        lift
    }

    /// The dominant left eigenvector of `S0`, among those that vanish on constants and are even or odd under
    /// reflection, by power iteration and a few steps of Rayleigh's. Even ones point along the first spoke, or,
    /// in an open sector, across it; they and the odd ones turn counter-clockwise.
    fn dominant(&self, even: bool, k0: &[f64]) -> Option<RowDVector<f64>> {
        let (matrix, mirror) = (&self.blocks[0], self.mirror());
        let size = matrix.nrows();
        let mut limit = RowDVector::zeros(size);
        limit[0] = 1.0;
        for (&weight, &[a, b]) in k0.iter().zip(self.ends) {
            limit[b] += weight;
            limit[a] -= weight;
        }
        let project = |x: RowDVector<f64>| {
            let sign = if even { 1.0 } else { -1.0 };
            let x = RowDVector::from_fn(size, |_, i| (x[i] + sign * x[mirror[i]]) / 2.0);
            let x = &x - &limit * x.sum();
            let norm = x.norm();
            (norm > 1e-200).then(|| x / norm)
        };
        let start = RowDVector::from_fn(size, |_, i| ((i + 1) as f64 * 0.7).sin());
        let mut x = project(start)?;
        for _ in 0..500 {
            x = project(&x * matrix)?;
        }
        for _ in 0..4 {
            let shifted = matrix - DMatrix::identity(size, size) * (self.eigenvalue(&x) + 1e-14);
            match shifted.transpose().lu().solve(&x.transpose()) {
                Some(better) if better.norm().is_finite() => x = project(better.transpose())?,
                _ => break,
            }
        }
        let eigenvalue = self.eigenvalue(&x);
        if (&x * matrix - &x * eigenvalue).norm() > 1e-10 {
            return None;
        }
        // The crease runs from the last spoke to the first; across it the surface lies to the left.
        let spokes = self.ends.iter().filter(|ends| ends[0] == 0).map(|ends| ends[1]);
        let turn = match self.configuration.cyclic {
            true => std::f64::consts::TAU / f64::from(self.configuration.faces),
            false => std::f64::consts::PI / f64::from(self.configuration.faces),
        };
        let along = |angle: f64| match even == self.configuration.cyclic {
            true => angle.cos(),
            false => angle.sin(),
        };
        let pointing: f64 = spokes.enumerate().map(|(i, w)| x[w] * along(i as f64 * turn)).sum();
        Some(if pointing < 0.0 { -x } else { x })
    }

    /// The vertex opposite under the reflection of the fan.
    fn mirror(&self) -> Vec<usize> {
        let (n, cyclic) = (self.configuration.faces as usize, self.configuration.cyclic);
        let step = if self.kind == SplitKind::Quad { 2 } else { 1 };
        let w = |i: usize| if cyclic { 1 + step * (i % n) } else { 1 + step * i };
        let mut mirror: Vec<usize> = (0..self.blocks[0].nrows()).collect();
        for i in 0..n + usize::from(!cyclic) {
            mirror[w(i)] = w(n - i);
        }
        if self.kind == SplitKind::Quad {
            for i in 0..n {
                mirror[w(i) + 1] = w(n - 1 - i) + 1;
            }
        }
        mirror
    }
}
