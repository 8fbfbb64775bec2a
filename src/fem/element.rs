use nalgebra::Vector3;
use rayon::prelude::*;

use super::{Quadrature, sandwich};
use crate::cochain::Cochain;
use crate::limit::{BasisPoint, LimitSurface};
use crate::sparse::{Csr, assemble};
use crate::topology::HalfEdge;

/// The elements of a limit surface, with its metric at their points.
///
/// Faces marked as holes are elements like all others: they are part of the complex.
pub struct Elements<'a> {
    surface: &'a LimitSurface,
    /// By number.
    bases: Vec<Vec<BasisPoint>>,
    /// Positions on the finest level, in units of `unit`.
    positions: Cochain<0, Vector3<f64>>,
    unit: f64,
}

/// The metric at a point.
struct Metric {
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
        // Lengths near 1 keep entries away from what sums drop as rounding.
        let squares = mesh.edges().iter().map(|&[a, b]| {
            let edge = positions[b as usize] - positions[a as usize];
            edge.norm_squared()
        });
        let mean = squares.sum::<f64>() / mesh.num_edges().max(1) as f64;
        let unit = if mean > 0.0 && mean.is_finite() { mean.sqrt() } else { 1.0 };
        Elements { surface, bases, positions: positions * (1.0 / unit), unit }
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
        let basis = &self.bases[self.surface.face_basis(face)];
        let n = [cells.vertices.len(), cells.half_edges.len(), cells.faces.len()][degree];
        let mut matrix = vec![0.0; n * n];
        let corners: Vec<Vector3<f64>> = cells.vertices.iter().map(|&v| self.positions[v as usize]).collect();
        let (mut left, mut right) = (vec![[0.0; 2]; n], vec![[0.0; 2]; n]);
        for point in basis {
            let metric = metric(point, &corners);
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
    pub(super) fn mass_on(&self, coarse: usize, degree: usize, weight: impl Fn(u32) -> f64 + Sync) -> Csr {
        let hierarchy = self.surface.hierarchy();
        let mut mass = self.gather(degree, weight);
        for level in (coarse + 1..=hierarchy.num_levels()).rev() {
            let operators = hierarchy.operators(level);
            mass = sandwich([&operators.s0, &operators.s1, &operators.s2][degree], &mass);
        }
        let unit = [self.unit * self.unit, 1.0, 1.0 / (self.unit * self.unit)][degree];
        mass.data_mut().iter_mut().for_each(|x| *x *= unit);
        mass
    }

    /// The mass on the finest level: each row collects its entries from the elements that know its cell.
    fn gather(&self, degree: usize, weight: impl Fn(u32) -> f64 + Sync) -> Csr {
        let mesh = self.surface.hierarchy().finest().mesh();
        let faces = mesh.num_faces() as u32;
        let locals: Vec<Vec<f64>> =
            (0..faces).into_par_iter().map(|face| self.scaled(degree, face, weight(face))).collect();
        let cells = |face: u32| {
            let cells = self.surface.face_cells(face);
            [cells.vertices, cells.half_edges, cells.faces][degree]
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
        assemble((n, n), |i, row| {
            for &(face, place) in &elements[offsets[i]..offsets[i + 1]] {
                let cells = cells(face);
                let (_, sign) = signed(cells[place as usize]);
                let entries = &locals[face as usize][place as usize * cells.len()..][..cells.len()];
                for (&cell, &entry) in cells.iter().zip(entries) {
                    let (column, other) = signed(cell);
                    row.add(column, sign * other * entry);
                }
            }
        })
    }

    /// The integral over each face of the finest level of the forms of its cells, for 0-forms: `int phi_v sqrt(g)`
    /// summed over the faces, over the vertices of the cage. These sum to the area of the surface.
    pub fn vertex_areas(&self) -> Cochain<0> {
        let hierarchy = self.surface.hierarchy();
        let mesh = hierarchy.finest().mesh();
        let of_face = |face: u32| {
            let cells = self.surface.face_cells(face);
            let corners: Vec<_> = cells.vertices.iter().map(|&v| self.positions[v as usize]).collect();
            let mut sums = vec![0.0; corners.len()];
            for point in &self.bases[self.surface.face_basis(face)] {
                let area = metric(point, &corners).area;
                sums.iter_mut().zip(&point.forms0).for_each(|(sum, form)| *sum += form[0] * area);
            }
            sums
        };
        let locals: Vec<Vec<f64>> = (0..mesh.num_faces() as u32).into_par_iter().map(of_face).collect();
        let mut areas = vec![0.0; mesh.num_vertices()];
        for (face, local) in locals.iter().enumerate() {
            let vertices = self.surface.face_cells(face as u32).vertices;
            vertices.iter().zip(local).for_each(|(&v, x)| areas[v as usize] += x);
        }
        for level in (1..=hierarchy.num_levels()).rev() {
            let s0 = hierarchy.operators(level).s0;
            areas = crate::sparse::apply(&super::transpose(&s0), &areas);
        }
        areas.iter_mut().for_each(|x| *x *= self.unit * self.unit);
        Cochain::new(areas)
    }

    /// The areas of the limits of the cage's faces.
    pub fn face_areas(&self) -> Cochain<2> {
        let hierarchy = self.surface.hierarchy();
        let of_face = |face: u32| {
            let cells = self.surface.face_cells(face);
            let corners: Vec<_> = cells.vertices.iter().map(|&v| self.positions[v as usize]).collect();
            let basis = &self.bases[self.surface.face_basis(face)];
            basis.iter().map(|point| metric(point, &corners).area).sum::<f64>()
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

/// Where the surface has no tangent plane (the sine between the tangents below this) a point counts nothing.
const DEGENERATE: f64 = 1e-10;

fn metric(point: &BasisPoint, corners: &[Vector3<f64>]) -> Metric {
    let (mut by_s, mut by_t) = (Vector3::zeros(), Vector3::zeros());
    for (x, form) in corners.iter().zip(&point.forms0) {
        by_s += x * form[1];
        by_t += x * form[2];
    }
    let (a, b, c) = (by_s.dot(&by_s), by_s.dot(&by_t), by_t.dot(&by_t));
    let determinant = a * c - b * b;
    if determinant <= DEGENERATE * DEGENERATE * a * c || !determinant.is_finite() {
        return Metric { area: 0.0, inverse: [0.0; 3], density: 0.0 };
    }
    Metric {
        area: point.weight * determinant.sqrt(),
        inverse: [c / determinant, -b / determinant, a / determinant],
        density: 1.0 / determinant,
    }
}
