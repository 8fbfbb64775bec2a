use nalgebra::Vector3;
use rayon::prelude::*;

use super::metric::{DEGENERATE, Geometry};
use super::{Metric, Quadrature, sandwich};
use crate::cochain::Cochain;
use crate::limit::{BasisPoint, LimitSurface, Taylor};
use crate::sparse::{Csr, assemble};
use crate::topology::HalfEdge;

/// The elements of a limit surface, with a metric at their points: its own, unless another is given
/// ([`Elements::with_metric`]).
///
/// Faces marked as holes are elements like all others: they are part of the complex. [`Elements::within`] leaves faces
/// out.
pub struct Elements<'a> {
    surface: &'a LimitSurface,
    /// By number.
    bases: Vec<Vec<BasisPoint>>,
    /// Positions on the finest level.
    positions: Cochain<0, Vector3<f64>>,
    metric: Metric,
    /// By face of the finest level.
    inside: Vec<bool>,
    /// Lengths near 1 keep entries away from what sums drop as rounding: this one is 1 in matrices under assembly.
    unit: f64,
}

/// The metric at a point, lengths in units of `unit`.
struct PointMetric {
    /// `sqrt(g)` times the weight of the point.
    area: f64,
    /// `g^11`, `g^12`, `g^22`.
    inverse: [f64; 3],
    /// `1 / sqrt(g)^2`.
    density: f64,
}

impl<'a> Elements<'a> {
    /// The elements of a surface whose cage has these positions.
    ///
    /// # Panics
    /// If the positions do not belong to the cage.
    pub fn new(
        surface: &'a LimitSurface,
        positions: &Cochain<0, Vector3<f64>>,
        quadrature: &Quadrature,
    ) -> Self {
        let mesh = surface.hierarchy().finest().mesh();
        let number = |face: u32| surface.face_basis(face);
        let used = (0..mesh.num_faces() as u32).map(number).max().map_or(0, |most| most + 1);
        let mut is_used = vec![false; used];
        (0..mesh.num_faces() as u32).for_each(|face| is_used[number(face)] = true);
        let basis = |number: usize| match is_used[number] {
            true => surface.basis(number, quadrature.rules()),
            false => Vec::new(),
        };
        let bases = (0..used).into_par_iter().map(basis).collect();
        let positions = surface.refine(positions);
        let squares = mesh.edges().iter().map(|&[a, b]| {
            let edge = positions[b as usize] - positions[a as usize];
            edge.norm_squared()
        });
        let mean = squares.sum::<f64>() / mesh.num_edges().max(1) as f64;
        let inside = vec![true; mesh.num_faces()];
        Elements { surface, bases, positions, metric: Metric::Surface, inside, unit: unit(mean) }
    }

    /// The same elements in another metric.
    #[must_use]
    pub fn with_metric(mut self, metric: Metric) -> Self {
        (self.metric, self.unit) = (metric, 1.0);
        let faces = self.inside.len() as u32;
        let area = |face: u32| {
            let corners = self.corners(face);
            self.basis(face)
                .first()
                .map_or(0.0, |point| self.at_point(face, point, &corners).area / point.weight)
        };
        let areas: Vec<f64> = (0..faces).into_par_iter().map(area).collect();
        self.unit = unit(areas.iter().sum::<f64>() / f64::from(faces.max(1)));
        self
    }

    /// The same elements, without those of the faces of the finest level for which `inside` is false: integrals are over
    /// the rest.
    #[must_use]
    pub fn within(mut self, inside: impl Fn(u32) -> bool) -> Self {
        self.inside = (0..self.inside.len() as u32).map(inside).collect();
        self
    }

    /// Whether a face of the finest level counts.
    pub fn is_inside(&self, face: u32) -> bool {
        self.inside[face as usize]
    }

    /// The metric.
    pub fn metric(&self) -> &Metric {
        &self.metric
    }

    /// The points of a face, with its basis there.
    pub(super) fn basis(&self, face: u32) -> &[BasisPoint] {
        &self.bases[self.surface.face_basis(face)]
    }

    /// The positions of the vertices whose forms do not vanish on a face.
    pub(super) fn corners(&self, face: u32) -> Vec<Vector3<f64>> {
        let vertices = self.surface.face_cells(face).vertices;
        vertices.iter().map(|&v| self.positions[v as usize]).collect()
    }

    fn at_point(&self, face: u32, point: &BasisPoint, corners: &[Vector3<f64>]) -> PointMetric {
        let scale = 1.0 / (self.unit * self.unit);
        if let Metric::Surface = self.metric {
            return surface_metric(point, corners, scale);
        }
        let position = std::array::from_fn(|k| {
            let sum = |i: usize| corners.iter().zip(&point.forms0).map(|(x, form)| x[k] * form[i]).sum();
            Taylor::linear(sum(0), [sum(1), sum(2)], 1)
        });
        let tensor = self.metric.tensor(face, point.point, position).map(|x| x * scale);
        Geometry::new(tensor).map_or(PointMetric::NONE, |g| {
            let density = g.density.value();
            PointMetric {
                area: point.weight * g.area.value(),
                inverse: g.conjugate.map(|x| x.value() * density),
                density: density * density,
            }
        })
    }

    /// The surface.
    pub fn surface(&self) -> &'a LimitSurface {
        self.surface
    }

    /// The matrix of one element: the mass of the forms of degree `degree` on a face of the finest level, row by row
    /// over the face's cells ([`LimitSurface::face_cells`], edges in the directions named there), times `weight`.
    ///
    /// # Panics
    /// If there is no such face or `degree > 2`.
    pub fn local(&self, degree: usize, face: u32, weight: f64) -> Vec<f64> {
        let unit = [self.unit * self.unit, 1.0, 1.0 / (self.unit * self.unit)][degree];
        let mut matrix = self.scaled(degree, face, weight);
        matrix.iter_mut().for_each(|x| *x *= unit);
        matrix
    }

    /// [`Elements::local`], with lengths in units of `unit`.
    fn scaled(&self, degree: usize, face: u32, weight: f64) -> Vec<f64> {
        let cells = self.surface.face_cells(face);
        let n = [cells.vertices.len(), cells.half_edges.len(), cells.faces.len()][degree];
        let mut matrix = vec![0.0; n * n];
        if !self.is_inside(face) {
            return matrix;
        }
        let corners = self.corners(face);
        let (mut left, mut right) = (vec![[0.0; 2]; n], vec![[0.0; 2]; n]);
        for point in self.basis(face) {
            let metric = self.at_point(face, point, &corners);
            let area = metric.area * weight;
            match degree {
                0 => {
                    for (i, form) in point.forms0.iter().enumerate() {
                        (left[i], right[i]) = ([form[0], 0.0], [form[0] * area, 0.0]);
                    }
                }
                1 => {
                    let [a, b, c] = metric.inverse.map(|x| x * area);
                    for (i, &[x, y]) in point.forms1.iter().enumerate() {
                        (left[i], right[i]) = ([x, y], [a * x + b * y, b * x + c * y]);
                    }
                }
                _ => {
                    for (i, &form) in point.forms2.iter().enumerate() {
                        (left[i], right[i]) = ([form, 0.0], [form * area * metric.density, 0.0]);
                    }
                }
            }
            for (i, &[p, q]) in left.iter().enumerate() {
                let row = &mut matrix[n * i..n * i + i + 1];
                for (sum, &[x, y]) in row.iter_mut().zip(&right) {
                    *sum += p * x + q * y;
                }
            }
        }
        for i in 0..n {
            for j in 0..i {
                matrix[n * j + i] = matrix[n * i + j];
            }
        }
        matrix
    }

    /// The mass of the forms of a degree, over the cells of the cage: `M0`, `M1` or `M2`.
    ///
    /// # Panics
    /// If `degree > 2`.
    pub fn mass(&self, degree: usize) -> Csr {
        self.weighted_mass(degree, |_| 1.0)
    }

    /// [`Elements::mass`], the integral over each face of the finest level times its weight.
    ///
    /// # Panics
    /// If `degree > 2`.
    pub fn weighted_mass(&self, degree: usize, weight: impl Fn(u32) -> f64 + Sync) -> Csr {
        self.mass_on(0, degree, weight)
    }

    /// [`Elements::weighted_mass`], over the cells of a level of the surface's hierarchy.
    pub(super) fn mass_on(&self, level: usize, degree: usize, weight: impl Fn(u32) -> f64 + Sync) -> Csr {
        let mut mass = self.gather_on(level, degree, |face| self.scaled(degree, face, weight(face)));
        let unit = [self.unit * self.unit, 1.0, 1.0 / (self.unit * self.unit)][degree];
        mass.data_mut().iter_mut().for_each(|x| *x *= unit);
        mass
    }

    /// The matrix of the cage whose elements are `local` of each face inside: each row of the finest level collects its
    /// entries from the elements that know its cell.
    pub(super) fn gather(&self, degree: usize, local: impl Fn(u32) -> Vec<f64> + Sync) -> Csr {
        self.gather_on(0, degree, local)
    }

    /// [`Elements::gather`], over the cells of a level of the surface's hierarchy.
    fn gather_on(&self, coarse: usize, degree: usize, local: impl Fn(u32) -> Vec<f64> + Sync) -> Csr {
        let hierarchy = self.surface.hierarchy();
        let mesh = hierarchy.finest().mesh();
        let faces = mesh.num_faces() as u32;
        let locals: Vec<Vec<f64>> = (0..faces)
            .into_par_iter()
            .map(|face| if self.is_inside(face) { local(face) } else { Vec::new() })
            .collect();
        let cells = |face: u32| {
            let cells = self.surface.face_cells(face);
            if self.is_inside(face) { [cells.vertices, cells.half_edges, cells.faces][degree] } else { &[] }
        };
        let signed = |cell: u32| match degree {
            1 => (HalfEdge(cell).edge(), HalfEdge(cell).sign()),
            _ => (cell, 1.0),
        };
        let n = mesh.num_cells(degree);
        let mut offsets = vec![0usize; n + 1];
        for face in 0..faces {
            cells(face).iter().for_each(|&cell| offsets[signed(cell).0 as usize + 1] += 1);
        }
        for i in 0..n {
            offsets[i + 1] += offsets[i];
        }
        let mut next = offsets.clone();
        let mut elements = vec![(0u32, 0u32); offsets[n]];
        for face in 0..faces {
            for (place, &cell) in cells(face).iter().enumerate() {
                let slot = &mut next[signed(cell).0 as usize];
                elements[*slot] = (face, place as u32);
                *slot += 1;
            }
        }
        let mut matrix = assemble((n, n), |i, row| {
            for &(face, place) in &elements[offsets[i]..offsets[i + 1]] {
                let cells = cells(face);
                let (_, sign) = signed(cells[place as usize]);
                let entries = &locals[face as usize][place as usize * cells.len()..][..cells.len()];
                for (&cell, &entry) in cells.iter().zip(entries) {
                    let (column, other) = signed(cell);
                    row.add(column, sign * other * entry);
                }
            }
        });
        for level in (coarse + 1..=hierarchy.num_levels()).rev() {
            let operators = hierarchy.operators(level);
            matrix = sandwich([&operators.s0, &operators.s1, &operators.s2][degree], &matrix);
        }
        matrix
    }

    /// The vector over the cells of the cage whose elements are `local` of each face inside.
    pub(super) fn gather_vector(&self, degree: usize, local: impl Fn(u32) -> Vec<f64> + Sync) -> Vec<f64> {
        let hierarchy = self.surface.hierarchy();
        let mesh = hierarchy.finest().mesh();
        let faces = mesh.num_faces() as u32;
        let locals: Vec<Vec<f64>> = (0..faces)
            .into_par_iter()
            .map(|face| if self.is_inside(face) { local(face) } else { Vec::new() })
            .collect();
        let mut sums = vec![0.0; mesh.num_cells(degree)];
        for (face, local) in locals.iter().enumerate() {
            let cells = self.surface.face_cells(face as u32);
            match degree {
                1 => cells.half_edges.iter().zip(local).for_each(|(&h, x)| {
                    sums[HalfEdge(h).edge() as usize] += HalfEdge(h).sign() * x;
                }),
                0 => cells.vertices.iter().zip(local).for_each(|(&v, x)| sums[v as usize] += x),
                _ => cells.faces.iter().zip(local).for_each(|(&f, x)| sums[f as usize] += x),
            }
        }
        for level in (1..=hierarchy.num_levels()).rev() {
            let operators = hierarchy.operators(level);
            let step = [&operators.s0, &operators.s1, &operators.s2][degree];
            sums = crate::sparse::apply(&super::transpose(step), &sums);
        }
        sums
    }

    /// The integral over each face of the finest level of the forms of its cells, for 0-forms: `int phi_v sqrt(g)`
    /// summed over the faces, over the vertices of the cage. These sum to the area of the surface.
    pub fn vertex_areas(&self) -> Cochain<0> {
        let of_face = |face: u32| {
            let corners = self.corners(face);
            let mut sums = vec![0.0; corners.len()];
            for point in self.basis(face) {
                let area = self.at_point(face, point, &corners).area;
                sums.iter_mut().zip(&point.forms0).for_each(|(sum, form)| *sum += form[0] * area);
            }
            sums
        };
        let mut areas = self.gather_vector(0, of_face);
        areas.iter_mut().for_each(|x| *x *= self.unit * self.unit);
        Cochain::new(areas)
    }

    /// The areas of the limits of the cage's faces.
    pub fn face_areas(&self) -> Cochain<2> {
        let hierarchy = self.surface.hierarchy();
        let of_face = |face: u32| {
            if !self.is_inside(face) {
                return 0.0;
            }
            let corners = self.corners(face);
            self.basis(face).iter().map(|point| self.at_point(face, point, &corners).area).sum::<f64>()
        };
        let faces = hierarchy.finest().mesh().num_faces() as u32;
        let mut areas: Vec<f64> = (0..faces).into_par_iter().map(of_face).collect();
        for level in (1..=hierarchy.num_levels()).rev() {
            let parent = hierarchy.level(level - 1).mesh();
            let split = hierarchy.refinement(level).split();
            let mut sums = vec![0.0; parent.num_faces()];
            for (face, area) in areas.iter().enumerate() {
                sums[split.face_parent(parent, face) as usize] += area;
            }
            areas = sums;
        }
        areas.iter_mut().for_each(|x| *x *= self.unit * self.unit);
        Cochain::new(areas)
    }
}

/// A length that is 1 in matrices, of a mean square of lengths.
fn unit(mean: f64) -> f64 {
    if mean > 0.0 && mean.is_finite() { mean.sqrt() } else { 1.0 }
}

impl PointMetric {
    /// Where there is no tangent plane a point counts nothing.
    const NONE: PointMetric = PointMetric { area: 0.0, inverse: [0.0; 3], density: 0.0 };
}

/// The metric of the surface itself, the case that is worth a formula of its own.
fn surface_metric(point: &BasisPoint, corners: &[Vector3<f64>], scale: f64) -> PointMetric {
    let (mut by_s, mut by_t) = (Vector3::zeros(), Vector3::zeros());
    for (x, form) in corners.iter().zip(&point.forms0) {
        by_s += x * form[1];
        by_t += x * form[2];
    }
    let [a, b, c] = [by_s.dot(&by_s), by_s.dot(&by_t), by_t.dot(&by_t)].map(|x| x * scale);
    let determinant = a * c - b * b;
    if determinant <= DEGENERATE * DEGENERATE * a * c || !determinant.is_finite() {
        return PointMetric::NONE;
    }
    PointMetric {
        area: point.weight * determinant.sqrt(),
        inverse: [c / determinant, -b / determinant, a / determinant],
        density: 1.0 / determinant,
    }
}
