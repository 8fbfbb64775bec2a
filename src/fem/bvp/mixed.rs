//! The mixed form of `Delta w = f`, with natural data.

use rayon::prelude::*;

use super::solve::{Kept, difference, norm};
use super::{BoundaryProblem, Data, Operator};
use crate::cochain::Cochain;
use crate::fem::{Elements, FemError, stiffness, transpose};
use crate::limit::Taylor;
use crate::sparse::{Cholesky, apply, assemble, multiply, row_of};
use crate::topology::HalfEdge;

/// `Delta w = f` for 1-forms with `sigma = delta w` as an unknown of its own, and `*w` and `*dw` prescribed on the
/// boundary: for all functions `t` and 1-forms `v`
///
/// ```text
/// <sigma, t> - <w, dt> = - int t *eta            <d sigma, v> + <dw, dv> = <f, v> + int v *d eta
/// ```
///
/// All it asks of the solution is that `w` and `dw` are square integrable, so that it is right at corners that point
/// inwards too. The domain has no harmonic forms: it is in one piece and without handles or holes.
pub struct MixedProblem<'a, 'e> {
    problem: BoundaryProblem<'a, 'e>,
}

/// A solution of the mixed form.
#[derive(Clone, Debug)]
pub struct MixedSolution {
    /// `w`, as a cochain of the cage.
    pub form: Cochain<1>,
    /// `delta w`, as a cochain of the cage.
    pub sigma: Cochain<0>,
    /// The number of coefficients of both that were solved for.
    pub unknowns: usize,
    /// `|b - A x| / |b|`.
    pub residual: f64,
    /// An estimate of its condition number ([`Cholesky::condition`]).
    pub condition: f64,
}

/// How far a solution of the mixed form is off, over the domain.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MixedErrors {
    /// Of `w`.
    pub l2: f64,
    /// Of `dw`.
    pub d: f64,
    /// Of `sigma`.
    pub sigma: f64,
}

/// The matrix is not definite, and is factorised with so much of the mass added, in units of 1 / area, that it is
/// quasi-definite. The rest is iteration, which gains a factor of about this over the lowest eigenvalue times the area.
const SHIFT: f64 = 0.1;
const CONVERGED: f64 = 1e-13;
const MOST: usize = 100;

impl<'a, 'e> MixedProblem<'a, 'e> {
    /// With so many points on each boundary edge.
    pub fn new(elements: &'e Elements<'a>, boundary_points: usize) -> Self {
        MixedProblem { problem: BoundaryProblem::new(elements, Operator::HodgeLaplace, boundary_points) }
    }

    /// Solves with the load and the boundary data of some data.
    ///
    /// # Errors
    /// [`FemError::Singular`] if the basis is dependent, [`FemError::NoConvergence`] if there are harmonic forms that the
    /// load is not orthogonal to.
    pub fn solve(&self, data: &Data) -> Result<MixedSolution, FemError> {
        let elements = self.problem.elements;
        let mesh = elements.surface().hierarchy().level(0).mesh();
        let (m0, m1, m2) = (elements.mass(0), elements.mass(1), elements.mass(2));
        let (coupling, curls) = (multiply(&m1, &mesh.d0()), stiffness(&m2, &mesh.d1()));
        let edges = elements.independent_edges();
        let edges = Kept::new(edges.len(), |e| edges[e as usize]);
        let vertices = Kept::new(m0.rows(), |v| row_of(&m0, v as usize).0.binary_search(&v).is_ok());
        let (below, n) = (vertices.len(), edges.len());
        let shift = SHIFT / elements.face_areas().values().iter().sum::<f64>();
        let (m0, m1, curls) = (vertices.matrix(&m0), edges.matrix(&m1), edges.matrix(&curls));
        let coupling = edges.block(&coupling, &vertices);
        let transposed = transpose(&coupling);
        let system = |shift: f64| {
            assemble((below + n, below + n), |i, row| match i.checked_sub(below) {
                None => {
                    row.add_row(&m0, i, -1.0);
                    let (columns, entries) = row_of(&transposed, i);
                    columns.iter().zip(entries).for_each(|(&j, &x)| row.add(below as u32 + j, x));
                }
                Some(i) => {
                    row.add_row(&coupling, i, 1.0);
                    for (matrix, factor) in [(&curls, 1.0), (&m1, shift)] {
                        let (columns, entries) = row_of(matrix, i);
                        columns
                            .iter()
                            .zip(entries)
                            .for_each(|(&j, &x)| row.add(below as u32 + j, factor * x));
                    }
                }
            })
        };
        let (matrix, factors) = (system(0.0), Cholesky::quasi_definite(&system(shift))?);
        let mut right = vertices.vector(&elements.gather_vector(0, |face| self.natural(face, data)));
        right.extend(edges.vector(&elements.gather_vector(1, |face| self.load(face, data))));
        let (mut x, mut left, size) = (vec![0.0; below + n], right.clone(), norm(&right));
        let (mut steps, mut before) = (0, f64::INFINITY);
        loop {
            let step = factors.solve(left);
            x.iter_mut().zip(&step).for_each(|(x, s)| *x += s);
            left = difference(&right, &apply(&matrix, &x));
            steps += 1;
            let relative = norm(&left) / size.max(f64::MIN_POSITIVE);
            // Steps become shorter until rounding makes them.
            if relative < CONVERGED || (relative < 1e-9 && relative > 0.5 * before) {
                let form = Cochain::new(edges.spread(&x[below..]));
                let sigma = Cochain::new(vertices.spread(&x[..below]));
                let condition = factors.condition();
                return Ok(MixedSolution { form, sigma, unknowns: below + n, residual: relative, condition });
            }
            if steps == MOST || !relative.is_finite() {
                return Err(FemError::NoConvergence { what: "the mixed form", iterations: steps });
            }
            before = relative;
        }
    }

    /// `int t *eta` over the boundary of a face.
    fn natural(&self, face: u32, data: &Data) -> Vec<f64> {
        let surface = self.problem.elements.surface();
        let corners = self.problem.elements.corners(face);
        let mut sums = vec![0.0; corners.len()];
        for point in self.problem.rim_of(face) {
            let (position, Some(geometry)) = self.problem.place(face, &corners, point) else { continue };
            let [x, y] = geometry.star(data.solution.pull(&position)).map(|x| x.value());
            let flux = point.weight * (x * point.tangent[0] + y * point.tangent[1]);
            sums.iter_mut().zip(&point.jets.forms0).for_each(|(sum, form)| *sum += form.value() * flux);
        }
        debug_assert_eq!(sums.len(), surface.face_cells(face).vertices.len());
        sums
    }

    /// `<f, v> + int v *d eta` of a face.
    fn load(&self, face: u32, data: &Data) -> Vec<f64> {
        let corners = self.problem.elements.corners(face);
        let mut sums = self.problem.loads(face, &corners, data);
        for point in self.problem.rim_of(face) {
            let (position, Some(geometry)) = self.problem.place(face, &corners, point) else { continue };
            let curl = point.weight * geometry.curl(data.solution.pull(&position)).value();
            for (sum, [a, b]) in sums.iter_mut().zip(&point.jets.forms1) {
                *sum += curl * (a.value() * point.tangent[0] + b.value() * point.tangent[1]);
            }
        }
        sums
    }

    /// How far a solution is from that of some data, by the points of the elements of this problem: those of another may be
    /// finer than those it was solved with.
    ///
    /// # Panics
    /// If the solution does not belong to the cage.
    pub fn errors(&self, solved: &MixedSolution, data: &Data) -> MixedErrors {
        let elements = self.problem.elements;
        let surface = elements.surface();
        let (form, sigma) = (surface.refine(&solved.form), surface.refine(&solved.sigma));
        let of_face = |face: u32| {
            let mut sums = [0.0; 3];
            if !elements.is_inside(face) {
                return sums;
            }
            let (corners, cells) = (elements.corners(face), surface.face_cells(face));
            for point in self.problem.inside_of(face) {
                let (position, Some(g)) = self.problem.place(face, &corners, point) else { continue };
                let exact = data.solution.pull(&position);
                let mut found = [Taylor::constant(0.0); 2];
                for (&h, w) in cells.half_edges.iter().zip(&point.jets.forms1) {
                    let x = HalfEdge(h).sign() * form.values()[HalfEdge(h).edge() as usize];
                    (0..2).for_each(|k| found[k] = found[k] + w[k] * x);
                }
                let of_vertex = |(&v, f): (&u32, &Taylor)| sigma.values()[v as usize] * f.value();
                let value: f64 = cells.vertices.iter().zip(&point.jets.forms0).map(of_vertex).sum();
                let off = [0, 1].map(|k| found[k] - exact[k]);
                let ([x, y], [a, b, c]) = (off.map(|x| x.value()), g.conjugate.map(|x| x.value()));
                let area = point.weight * g.area.value();
                sums[0] += point.weight * (a * x * x + 2.0 * b * x * y + c * y * y);
                sums[1] += area * g.curl(off).value().powi(2);
                sums[2] += area * (value - g.codifferential(exact).value()).powi(2);
            }
            sums
        };
        let faces = surface.hierarchy().finest().mesh().num_faces() as u32;
        let sums: Vec<[f64; 3]> = (0..faces).into_par_iter().map(of_face).collect();
        let total = sums.iter().fold([0.0; 3], |total, s| [0, 1, 2].map(|k| total[k] + s[k]));
        MixedErrors { l2: total[0].sqrt(), d: total[1].sqrt(), sigma: total[2].sqrt() }
    }
}
