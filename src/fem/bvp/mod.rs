//! Boundary value problems of 1-forms, with all of the form prescribed on the boundary.

mod features;
mod mixed;
mod relations;
mod sides;
mod solve;

pub use features::Operator;
pub use mixed::{MixedErrors, MixedProblem, MixedSolution};
pub use solve::{Errors, Solved};

use std::sync::Arc;

use nalgebra::Vector3;
use rayon::prelude::*;

use super::metric::Geometry;
use super::{Elements, gauss};
use crate::limit::{BasisJets, Taylor};
use crate::topology::SplitKind;
use features::{Features, add, add_vector};

type Covector = Arc<dyn Fn([Taylor; 3]) -> [Taylor; 3] + Send + Sync>;

/// A 1-form given by its components at points of space: what it is on a surface is its restriction. In a chart the point is
/// `(x, y, 0)`. A function of Taylor polynomials, so that it comes with its derivatives.
#[derive(Clone)]
pub struct SpaceForm(Covector);

impl SpaceForm {
    /// The form `f(p) . dp`.
    pub fn new(f: impl Fn([Taylor; 3]) -> [Taylor; 3] + Send + Sync + 'static) -> Self {
        SpaceForm(Arc::new(f))
    }

    /// The form 0.
    pub fn zero() -> Self {
        SpaceForm::new(|_| [Taylor::constant(0.0); 3])
    }

    /// Its components in the parameters in which a position is given, of an order less.
    fn pull(&self, position: &[Taylor; 3]) -> [Taylor; 2] {
        let components = (self.0)(*position);
        [0, 1].map(|k| {
            let terms = components.iter().zip(position).map(|(&f, x)| f * x.by(k));
            terms.reduce(|a, b| a + b).expect("space has coordinates")
        })
    }
}

/// The data of a boundary value problem: `Delta w = f` inside, or `Delta Delta w = f`, and the form `eta` whose traces `w`
/// has on the boundary.
#[derive(Clone)]
pub struct Data {
    /// `eta`; where it solves the equation, the solution that errors are measured against.
    pub solution: SpaceForm,
    /// `f`; `None` for what the operator makes of `solution`, by exact differentiation: a manufactured solution.
    pub load: Option<SpaceForm>,
}

/// How data on the boundary is imposed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Imposed {
    /// Weakly and consistently, by the symmetric method of J. Nitsche, 1971. The factors are the weights of the squares of
    /// the traces of `w`, and of `*dw` and `delta w` for the bi-Laplacian; the energy is definite from about 11 on quads and
    /// 20 on triangles for the Laplacian, from 71 and 180 for the bi-Laplacian. [`Imposed::nitsche`] has good ones.
    Nitsche([f64; 2]),
    /// Strongly: the traces are the best approximation of the data on the boundary. Right for quads; on triangles, whose
    /// traces have six functions an edge, it locks.
    Strong,
    /// Strongly, but of the means of the traces over each edge only, as in thesis (5.25), (5.26).
    Means,
    /// The thesis' way: the squares of those means, with this factor times the largest entry on the diagonal. Not
    /// consistent: the error is of first order, whatever the elements.
    Penalty(f64),
}

impl Imposed {
    /// Nitsche's method with factors that are safe, and small enough to stay accurate.
    pub fn nitsche(operator: Operator, kind: SplitKind) -> Self {
        Imposed::Nitsche(match (operator, kind) {
            (Operator::HodgeLaplace, SplitKind::Quad) => [25.0, 0.0],
            (Operator::HodgeLaplace, SplitKind::Triangle) => [40.0, 0.0],
            (Operator::BiLaplace, SplitKind::Quad) => [200.0, 20.0],
            (Operator::BiLaplace, SplitKind::Triangle) => [1000.0, 50.0],
        })
    }
}

/// A point of a face or of one of its sides, with the basis there.
struct Point {
    at: [f64; 2],
    weight: f64,
    tangent: [f64; 2],
    jets: BasisJets,
}

/// A boundary value problem of 1-forms on the faces inside of some elements, in their metric: `Delta w = f` or
/// `Delta Delta w = f`, with `w` along and across the boundary prescribed, for the bi-Laplacian also `*dw` and `delta w`.
///
/// The forms are smooth enough for the energies themselves, so the unknown is `w` alone. On domains with corners that
/// point inwards the energy of the solution's derivatives is finite only for data like the ones here; with natural
/// conditions it would have a wrong solution, and the mixed form ([`HodgeLaplace`](super::HodgeLaplace)) is right.
pub struct BoundaryProblem<'a, 'e> {
    elements: &'e Elements<'a>,
    operator: Operator,
    sides: Vec<u8>,
    /// By number of the basis.
    inside: Vec<Vec<Point>>,
    /// By number of the basis times 4 plus the side.
    rim: Vec<Vec<Point>>,
}

/// The sums of one face.
#[derive(Default)]
struct Local {
    energy: Vec<f64>,
    load: Vec<f64>,
    /// What is imposed apart from the energy: `trace' trace` and `trace' data`.
    traces: Vec<f64>,
    data: Vec<f64>,
}

impl<'a, 'e> BoundaryProblem<'a, 'e> {
    /// Gets the derivatives of the basis at the points of the elements, and at so many points of each boundary edge: 5 are
    /// plenty, 2 too few on triangles.
    pub fn new(elements: &'e Elements<'a>, operator: Operator, boundary_points: usize) -> Self {
        let surface = elements.surface();
        let (kind, faces) =
            (surface.hierarchy().split_kind(), surface.hierarchy().finest().mesh().num_faces());
        let sides = sides::sides(elements);
        let used = (0..faces as u32).map(|face| surface.face_basis(face)).max().map_or(0, |most| most + 1);
        // A face for each basis, and the sides that are asked for of any.
        let (mut face_of, mut asked) = (vec![None; used], vec![0u8; used]);
        for face in (0..faces as u32).filter(|&face| elements.is_inside(face)) {
            let number = surface.face_basis(face);
            face_of[number] = Some(face);
            asked[number] |= sides[face as usize];
        }
        let order = operator.order();
        // A load that is the operator's image of the solution takes twice as many derivatives, and one more of positions.
        let inside = |number: usize| match face_of[number] {
            None => Vec::new(),
            Some(face) => {
                let point = |p: &crate::limit::BasisPoint| {
                    let jets = surface.basis_jets(number, p.point, [2 * order + 1, order]);
                    Point { at: p.point, weight: p.weight, tangent: [0.0; 2], jets }
                };
                elements.basis(face).iter().map(point).collect()
            }
        };
        let rim = |key: usize| {
            let (number, i) = (key / 4, key % 4);
            if asked[number] >> i & 1 == 0 {
                return Vec::new();
            }
            let (from, tangent) = sides::side(kind, i);
            let point = |(x, weight): (f64, f64)| {
                let at = [0, 1].map(|k| from[k] + x * tangent[k]);
                let orders = [operator.boundary_order() + 1, operator.boundary_order()];
                Point { at, weight, tangent, jets: surface.basis_jets(number, at, orders) }
            };
            gauss(boundary_points).into_iter().map(point).collect()
        };
        BoundaryProblem {
            elements,
            operator,
            inside: (0..used).into_par_iter().map(inside).collect(),
            rim: (0..4 * used).into_par_iter().map(rim).collect(),
            sides,
        }
    }

    /// The position at a point, and the metric; `None` where that is degenerate.
    fn place(&self, face: u32, corners: &[Vector3<f64>], point: &Point) -> ([Taylor; 3], Option<Geometry>) {
        let position = std::array::from_fn(|k| {
            let terms = corners.iter().zip(&point.jets.forms0).map(|(x, &form)| form * x[k]);
            terms.reduce(|a, b| a + b).expect("a face has vertices")
        });
        (position, Geometry::new(self.elements.metric().tensor(face, point.at, position)))
    }

    /// `<f, v>` wants the operator's image of a form, or the form given.
    fn load(&self, data: &Data, position: &[Taylor; 3], geometry: &Geometry) -> [f64; 2] {
        let f = match (&data.load, self.operator) {
            (Some(load), _) => load.pull(position),
            (None, Operator::HodgeLaplace) => geometry.laplacian(data.solution.pull(position)),
            (None, Operator::BiLaplace) => {
                geometry.laplacian(geometry.laplacian(data.solution.pull(position)))
            }
        };
        f.map(|x| x.value())
    }

    /// The sums of a face.
    fn local(&self, face: u32, data: &Data, imposed: Imposed) -> Local {
        let n = self.elements.surface().face_cells(face).half_edges.len();
        let corners = self.elements.corners(face);
        let mut local = Local {
            energy: self.energies(face, &corners),
            load: self.loads(face, &corners, data),
            traces: vec![0.0; n * n],
            data: vec![0.0; n],
        };
        for points in self.rims(face) {
            self.side(&mut local, face, &corners, points, data, imposed);
        }
        local
    }

    /// The energies over a face.
    fn energies(&self, face: u32, corners: &[Vector3<f64>]) -> Vec<f64> {
        let n = self.elements.surface().face_cells(face).half_edges.len();
        let (operator, mut energy) = (self.operator, vec![0.0; n * n]);
        for point in self.inside_of(face) {
            let (_, Some(geometry)) = self.place(face, corners, point) else { continue };
            let rows: Vec<Features> =
                point.jets.forms1.iter().map(|&w| features::inside(operator, &geometry, w)).collect();
            add(&mut energy, &rows, &features::energy(operator, &geometry), point.weight);
        }
        energy
    }

    /// The points of a face.
    fn inside_of(&self, face: u32) -> &[Point] {
        &self.inside[self.elements.surface().face_basis(face)]
    }

    /// The points of each of its sides on the boundary.
    fn rims(&self, face: u32) -> impl Iterator<Item = &Vec<Point>> {
        let number = self.elements.surface().face_basis(face);
        let is = move |i: &usize| self.sides[face as usize] >> i & 1 == 1;
        (0..4).filter(is).map(move |i| &self.rim[4 * number + i])
    }

    /// Those of all of them.
    fn rim_of(&self, face: u32) -> impl Iterator<Item = &Point> {
        self.rims(face).flatten()
    }

    /// `<f, v>` over a face.
    fn loads(&self, face: u32, corners: &[Vector3<f64>], data: &Data) -> Vec<f64> {
        let mut sums = vec![0.0; self.elements.surface().face_cells(face).half_edges.len()];
        for point in self.inside_of(face) {
            let (position, Some(geometry)) = self.place(face, corners, point) else { continue };
            let [x, y] = self.load(data, &position, &geometry);
            let [a, b, c] = geometry.conjugate.map(|x| x.value() * point.weight);
            for (sum, w) in sums.iter_mut().zip(&point.jets.forms1) {
                let [p, q] = w.map(|x| x.value());
                *sum += p * (a * x + b * y) + q * (b * x + c * y);
            }
        }
        sums
    }

    /// The sums of a side.
    fn side(
        &self,
        local: &mut Local,
        face: u32,
        corners: &[Vector3<f64>],
        points: &[Point],
        data: &Data,
        imposed: Imposed,
    ) {
        let operator = self.operator;
        let mut means = vec![[0.0; features::MOST]; local.load.len()];
        let mut mean = [0.0; features::MOST];
        for point in points {
            let (position, Some(geometry)) = self.place(face, corners, point) else { continue };
            let rows: Vec<Features> = point
                .jets
                .forms1
                .iter()
                .map(|&w| features::traces(operator, &geometry, w, point.tangent))
                .collect();
            let eta = features::traces(operator, &geometry, data.solution.pull(&position), point.tangent);
            let eta = features::prescribed(operator, eta);
            match imposed {
                Imposed::Nitsche(factors) => {
                    let mut q = features::consistency(operator);
                    q.extend(features::squares(operator, &geometry, factors));
                    add(&mut local.energy, &rows, &q, point.weight);
                    add_vector(&mut local.load, &rows, &q, &eta, point.weight);
                }
                Imposed::Strong => {
                    let q = features::squares(operator, &geometry, [1.0, 1.0]);
                    add(&mut local.traces, &rows, &q, point.weight);
                    add_vector(&mut local.data, &rows, &q, &eta, point.weight);
                }
                Imposed::Means | Imposed::Penalty(_) => {
                    // Of functions, in units of the length of the edge.
                    let length = geometry.area.value().sqrt();
                    let weights = [1.0, 1.0, length, length].map(|x| x * point.weight);
                    let collect = |sum: &mut Features, x: &Features| {
                        (0..4).for_each(|k| sum[k] += weights[k] * x[k]);
                    };
                    means.iter_mut().zip(&rows).for_each(|(sum, row)| collect(sum, row));
                    collect(&mut mean, &eta);
                }
            }
        }
        if matches!(imposed, Imposed::Means | Imposed::Penalty(_)) {
            let q: Vec<_> = (0..2 * operator.order()).map(|k| (k, k, 1.0)).collect();
            add(&mut local.traces, &means, &q, 1.0);
            add_vector(&mut local.data, &means, &q, &mean, 1.0);
        }
    }
}
