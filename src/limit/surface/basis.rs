//! The basis of the limit forms: what the form of each cell near a face is at points of that face.

use super::super::frame::Frame;
use super::super::patch;
use super::super::tables::Table;
use super::LimitSurface;
use super::point::{PointError, SurfacePoint};
use super::walk::{Found, descent};
use crate::sparse::{Csr, multiply, row_of};
use crate::topology::{HalfEdge, SplitKind};

/// The cells of the finest level whose forms do not vanish on a face, those of each degree in the order of the
/// entries of a [`BasisPoint`].
#[derive(Clone, Copy, Debug)]
pub struct FaceCells<'a> {
    /// Vertices.
    pub vertices: &'a [u32],
    /// Half-edges, by number: each edge in the direction in which its form is counted.
    pub half_edges: &'a [u32],
    /// Faces.
    pub faces: &'a [u32],
}

/// The basis forms of a face at one of its points, in the parameters `s`, `t` that start at the face's own origin
/// ([`LimitSurface::face_origin`]).
#[derive(Clone, Debug)]
pub struct BasisPoint {
    /// The parameters.
    pub point: [f64; 2],
    /// The weight of the point: these sum to the area of the face in parameters, 1 or 1/2.
    pub weight: f64,
    /// For each vertex the value of its 0-form and the derivatives by `s` and `t`.
    pub forms0: Vec<[f64; 3]>,
    /// For each half-edge the components of its 1-form along `s` and `t`.
    pub forms1: Vec<[f64; 2]>,
    /// For each face the density of its 2-form, the factor of `ds^dt`.
    pub forms2: Vec<f64>,
}

/// Points with weights on the unit square, or the triangle `s, t >= 0, s + t <= 1`.
pub type QuadratureRule = Vec<([f64; 2], f64)>;

impl LimitSurface {
    /// The number of the basis of a face of the finest level: faces with like surroundings share it.
    pub fn face_basis(&self, face: u32) -> usize {
        self.patches[face as usize].table as usize
    }

    /// The corner, from the face's first, where the parameters of its basis start.
    pub fn face_origin(&self, face: u32) -> u32 {
        u32::from(self.patches[face as usize].origin)
    }

    /// The cells whose forms make up the basis of a face.
    pub fn face_cells(&self, face: u32) -> FaceCells<'_> {
        let patch = self.patches[face as usize];
        let [v, e, f] = self.tables.get(patch.table as usize).sizes;
        let start = patch.cells as usize;
        FaceCells {
            vertices: &self.cells[start..start + v],
            half_edges: &self.cells[start + v..start + v + e],
            faces: &self.cells[start + v + e..start + v + e + f],
        }
    }

    /// A basis at points that suit integration: those of `rules[0]` on a face where the forms are polynomials. Next
    /// to an irregular vertex or a feature the face is split again and again, and the points are those of `rules[l]`
    /// on each part that is regular after `l` splits; what is still irregular after the last rule is counted to the
    /// smallest parts beside it.
    ///
    /// # Panics
    /// If there are no rules or no such basis.
    pub fn basis(&self, number: usize, rules: &[QuadratureRule]) -> Vec<BasisPoint> {
        let table = self.tables.get(number);
        let mut graded = Graded { surface: self, rules, points: Vec::new(), deepest: Vec::new() };
        let identity = [0, 1, 2].map(|k| Csr::eye(table.sizes[k]));
        graded.collect(table, &identity, Place { origin: [0.0; 2], axes: [[1.0, 0.0], [0.0, 1.0]] }, 0);
        let Graded { mut points, deepest, .. } = graded;
        let all = if self.hierarchy.split_kind() == SplitKind::Quad { 1.0 } else { 0.5 };
        let found: f64 = points.iter().map(|p| p.weight).sum();
        let last: f64 = deepest.iter().map(|&i| points[i].weight).sum();
        for i in deepest {
            points[i].weight *= (all - found + last) / last;
        }
        points
    }

    /// The value at a point as a combination of a cochain's values on cells of the finest level: of a 0-form its
    /// value (twice), of a 1-form its components along `s` and `t`, of a 2-form its density (twice). At an irregular
    /// vertex the components are those along its two limit tangents; a density does not exist there.
    ///
    /// # Errors
    /// If the point is not on the surface.
    ///
    /// # Panics
    /// If `degree > 2`.
    pub fn functional(
        &self,
        degree: usize,
        point: &SurfacePoint,
    ) -> Result<Vec<(u32, [f64; 2])>, PointError> {
        self.check(point)?;
        let kind = self.hierarchy.split_kind();
        let (face, frame) = self.locate(point);
        let (steps, found) = descent(self, self.face_basis(face), frame, degree);
        let mut weights: Vec<[f64; 2]> = match found {
            Found::Patch(frame) => {
                let n = coefficients(kind)[degree];
                (0..n).map(|i| at_unit(kind, degree, n, i, &frame)).collect()
            }
            Found::Vertex(table) => {
                let n = steps
                    .last()
                    .map_or(self.tables.get(self.face_basis(face)).sizes[degree], |map| map.rows());
                let unit = |i: usize| (0..n).map(|j| f64::from(u8::from(i == j))).collect::<Vec<f64>>();
                let at = |i: usize| match degree {
                    0 => [table.limit(&unit(i)).0; 2],
                    1 => table.along_tangents(&unit(i)),
                    _ => [f64::NAN; 2],
                };
                (0..n).map(at).collect()
            }
        };
        for map in steps.iter().rev() {
            let mut above = vec![[0.0; 2]; map.cols()];
            for (i, weight) in weights.iter().enumerate() {
                let (columns, entries) = row_of(map, i);
                for (&j, &entry) in columns.iter().zip(entries) {
                    (0..2).for_each(|k| above[j as usize][k] += weight[k] * entry);
                }
            }
            weights = above;
        }
        let cells = self.face_cells(face);
        Ok(match degree {
            1 => {
                let signed = |(&h, weight): (&u32, [f64; 2])| {
                    (HalfEdge(h).edge(), weight.map(|x| x * HalfEdge(h).sign()))
                };
                cells.half_edges.iter().zip(weights).map(signed).collect()
            }
            0 => cells.vertices.iter().copied().zip(weights).collect(),
            _ => cells.faces.iter().copied().zip(weights).collect(),
        })
    }
}

/// The numbers of coefficients of a polynomial, by degree of the form.
fn coefficients(kind: SplitKind) -> [usize; 3] {
    match kind {
        SplitKind::Quad => [16, 24, 9],
        SplitKind::Triangle => [15, 30, 10],
    }
}

/// What one coefficient counts at a point, in the outer frame.
fn at_unit(kind: SplitKind, degree: usize, n: usize, i: usize, frame: &Frame) -> [f64; 2] {
    let mut unit = [0.0; 30];
    unit[i] = 1.0;
    match degree {
        0 => [patch::form0(kind, &unit[..n], frame.point).value; 2],
        1 => frame.pull(patch::form1(kind, &unit[..n], frame.point).map(|jet| jet.value)),
        _ => [patch::form2(kind, &unit[..n], frame.point) * frame.determinant(); 2],
    }
}

/// The map from the parameters of a part to those of the face: `origin + s axes[0] + t axes[1]`.
#[derive(Clone, Copy)]
struct Place {
    origin: [f64; 2],
    axes: [[f64; 2]; 2],
}

impl Place {
    fn of(&self, [s, t]: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|i| self.origin[i] + s * self.axes[0][i] + t * self.axes[1][i])
    }

    /// The area of the part in units of its own.
    fn area(&self) -> f64 {
        let [a, b] = self.axes;
        (a[0] * b[1] - a[1] * b[0]).abs()
    }

    /// The frame of a point of the part, the face's own frame being the outer one.
    fn frame(&self, point: [f64; 2]) -> Frame {
        let [a, b] = self.axes;
        let determinant = a[0] * b[1] - a[1] * b[0];
        let jacobian = [[b[1] / determinant, -b[0] / determinant], [-a[1] / determinant, a[0] / determinant]];
        Frame { point, jacobian }
    }

    /// The place of a part that has `point` at `frame`, both in the same outer parameters.
    fn from_frame(at: [f64; 2], frame: &Frame) -> Place {
        let j = &frame.jacobian;
        let determinant = frame.determinant();
        let axes = [
            [j[1][1] / determinant, -j[1][0] / determinant],
            [-j[0][1] / determinant, j[0][0] / determinant],
        ];
        let [s, t] = frame.point;
        Place { origin: [0, 1].map(|i| at[i] - s * axes[0][i] - t * axes[1][i]), axes }
    }
}

/// A point inside each child, by number.
fn insides(kind: SplitKind) -> [[f64; 2]; 4] {
    match kind {
        SplitKind::Quad => [[0.25, 0.25], [0.75, 0.25], [0.75, 0.75], [0.25, 0.75]],
        SplitKind::Triangle => [[0.125, 0.125], [0.75, 0.125], [0.125, 0.75], [0.375, 0.375]],
    }
}

/// A basis under collection.
struct Graded<'a> {
    surface: &'a LimitSurface,
    rules: &'a [QuadratureRule],
    points: Vec<BasisPoint>,
    /// Those after the last split.
    deepest: Vec<usize>,
}

impl Graded<'_> {
    /// Adds the points of a part; `maps` lead from the cells of the face to those of the part.
    fn collect(&mut self, table: &Table, maps: &[Csr; 3], place: Place, depth: usize) {
        if !table.children.is_empty() && depth + 1 < self.rules.len() {
            let kind = self.surface.hierarchy.split_kind();
            for inside in insides(kind) {
                let (number, frame) = place.frame(inside).descend(kind);
                let child = &table.children[number];
                let below = Place::from_frame(place.of(inside), &frame.turned(kind, child.turn));
                let maps = [0, 1, 2].map(|k| multiply(&child.maps[k], &maps[k]));
                match child.table {
                    Some(number) => {
                        self.collect(self.surface.tables.get(number), &maps, below, depth + 1);
                    }
                    None => self.add(&maps, below, depth + 1),
                }
            }
        } else if let Some(rows) = &table.polynomial {
            self.add(&[0, 1, 2].map(|k| multiply(&rows[k], &maps[k])), place, depth);
        }
    }

    /// Adds the points of a regular part; `maps` lead from the cells of the face to polynomial coefficients.
    fn add(&mut self, maps: &[Csr; 3], place: Place, depth: usize) {
        let kind = self.surface.hierarchy.split_kind();
        let counts = coefficients(kind);
        for &(point, weight) in &self.rules[depth] {
            let frame = place.frame(point);
            let mut at = BasisPoint {
                point: place.of(point),
                weight: weight * place.area(),
                forms0: vec![[0.0; 3]; maps[0].cols()],
                forms1: vec![[0.0; 2]; maps[1].cols()],
                forms2: vec![0.0; maps[2].cols()],
            };
            for i in 0..counts[0] {
                let mut unit = [0.0; 16];
                unit[i] = 1.0;
                let jet = patch::form0(kind, &unit[..counts[0]], point);
                let [by_s, by_t] = frame.pull(jet.derivatives);
                let (columns, entries) = row_of(&maps[0], i);
                for (&j, &entry) in columns.iter().zip(entries) {
                    let sum = &mut at.forms0[j as usize];
                    *sum = [sum[0] + entry * jet.value, sum[1] + entry * by_s, sum[2] + entry * by_t];
                }
            }
            for i in 0..counts[1] {
                let [by_s, by_t] = at_unit(kind, 1, counts[1], i, &frame);
                let (columns, entries) = row_of(&maps[1], i);
                for (&j, &entry) in columns.iter().zip(entries) {
                    let sum = &mut at.forms1[j as usize];
                    *sum = [sum[0] + entry * by_s, sum[1] + entry * by_t];
                }
            }
            for i in 0..counts[2] {
                let [density, _] = at_unit(kind, 2, counts[2], i, &frame);
                let (columns, entries) = row_of(&maps[2], i);
                for (&j, &entry) in columns.iter().zip(entries) {
                    at.forms2[j as usize] += entry * density;
                }
            }
            if depth + 1 == self.rules.len() {
                self.deepest.push(self.points.len());
            }
            self.points.push(at);
        }
    }
}
