//! The systems of boundary value problems, and how far their solutions are off.

use rayon::prelude::*;

use super::{BoundaryProblem, Data, Imposed, Local};
use crate::cochain::Cochain;
use crate::fem::{Elements, FemError};
use crate::limit::Taylor;
use crate::sparse::{Cholesky, Csr, apply, assemble, inner, row_of};
use crate::topology::HalfEdge;

/// A solution of a boundary value problem.
#[derive(Clone, Debug)]
pub struct Solved {
    /// `w`, as a cochain of the cage: 0 on edges whose forms do not reach the domain, and on those left out for
    /// relations ([`Elements::dependent`]).
    pub form: Cochain<1>,
    /// The number of coefficients that were solved for.
    pub unknowns: usize,
    /// `|b - A x| / |b|` of the last system that was solved.
    pub residual: f64,
    /// An estimate of the condition number of that system ([`Cholesky::condition`]).
    pub condition: f64,
    /// How far the traces are from what was imposed strongly, relative; 0 for other ways.
    pub off: f64,
}

/// How far a 1-form is from another, over the domain.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// The norm of the difference, in the metric.
    pub l2: f64,
    /// `(|d .|^2 + |delta .|^2)^(1/2)`: on flat domains, for forms that vanish on the boundary, the norm of all first
    /// derivatives.
    pub energy: f64,
    /// `(|d *d .|^2 + |d delta .|^2)^(1/2)`: likewise of second derivatives.
    pub second: f64,
}

/// Strong data by the method of multipliers: the factor of the squares in units of the energy's diagonal, where it ends,
/// and how many steps it may take. Each step is one solution, and gains about the digits of the factor.
const FACTOR: f64 = 1e3;
const IMPOSED: f64 = 1e-12;
const MOST: usize = 40;

/// The unknowns of a system.
pub struct Kept {
    /// The number of each cell among the unknowns; `u32::MAX` for none.
    number: Vec<u32>,
    cells: Vec<u32>,
}

impl Kept {
    /// Those cells for which `is` is true.
    pub fn new(count: usize, is: impl Fn(u32) -> bool) -> Self {
        let cells: Vec<u32> = (0..count as u32).filter(|&cell| is(cell)).collect();
        let mut number = vec![u32::MAX; count];
        cells.iter().enumerate().for_each(|(i, &cell)| number[cell as usize] = i as u32);
        Kept { number, cells }
    }

    pub fn len(&self) -> usize {
        self.cells.len()
    }

    pub fn matrix(&self, matrix: &Csr) -> Csr {
        self.block(matrix, self)
    }

    /// The rows of these unknowns, the columns of those.
    pub fn block(&self, matrix: &Csr, columns: &Kept) -> Csr {
        assemble((self.len(), columns.len()), |i, row| {
            let (cells, entries) = row_of(matrix, self.cells[i] as usize);
            for (&j, &x) in cells.iter().zip(entries) {
                if columns.number[j as usize] != u32::MAX {
                    row.add(columns.number[j as usize], x);
                }
            }
        })
    }

    pub fn vector(&self, x: &[f64]) -> Vec<f64> {
        self.cells.iter().map(|&cell| x[cell as usize]).collect()
    }

    pub fn spread(&self, x: &[f64]) -> Vec<f64> {
        let mut all = vec![0.0; self.number.len()];
        self.cells.iter().zip(x).for_each(|(&cell, &x)| all[cell as usize] = x);
        all
    }
}

fn diagonal(matrix: &Csr, i: usize) -> f64 {
    let (columns, entries) = row_of(matrix, i);
    columns.binary_search(&(i as u32)).map_or(0.0, |at| entries[at])
}

/// `a + factor b`, of one size.
fn sum(a: &Csr, b: &Csr, factor: f64) -> Csr {
    assemble(a.shape(), |i, row| {
        row.add_row(a, i, 1.0);
        row.add_row(b, i, factor);
    })
}

pub fn norm(x: &[f64]) -> f64 {
    inner(x, x).sqrt()
}

impl Elements<'_> {
    /// Whether each edge of the cage is an unknown of problems on the faces inside: its form reaches them, and it is none of
    /// [`Elements::dependent`].
    ///
    /// On surfaces that had to be refined, relations are not looked for: forms of the cage that are 0 then make systems
    /// singular.
    pub fn independent_edges(&self) -> Vec<bool> {
        let hierarchy = self.surface().hierarchy();
        let fine = hierarchy.finest().mesh();
        let mut reached = vec![0.0; fine.num_edges()];
        for face in (0..fine.num_faces() as u32).filter(|&face| self.is_inside(face)) {
            for &h in self.surface().face_cells(face).half_edges {
                reached[HalfEdge(h).edge() as usize] = 1.0;
            }
        }
        for level in (1..=hierarchy.num_levels()).rev() {
            let mut s1 = hierarchy.operators(level).s1;
            s1.data_mut().iter_mut().for_each(|x| *x = x.abs());
            reached = apply(&crate::fem::transpose(&s1), &reached);
        }
        let mut is: Vec<bool> = reached.iter().map(|&x| x > 0.0).collect();
        if hierarchy.num_levels() == 0 {
            self.dependent(1).iter().for_each(|&e| is[e as usize] = false);
        }
        is
    }
}

impl BoundaryProblem<'_, '_> {
    /// Solves with some data.
    ///
    /// # Errors
    /// [`FemError::Singular`] if the system is singular: the basis is dependent. A system that is only indefinite, because the
    /// factors of Nitsche's method are too small, is solved all the same. [`FemError::NoConvergence`] if data that is imposed
    /// strongly contradicts itself.
    pub fn solve(&self, data: &Data, imposed: Imposed) -> Result<Solved, FemError> {
        let faces = self.elements.surface().hierarchy().finest().mesh().num_faces() as u32;
        let locals: Vec<Local> = (0..faces)
            .into_par_iter()
            .map(|face| match self.elements.is_inside(face) {
                true => self.local(face, data, imposed),
                false => Local::default(),
            })
            .collect();
        let matrix =
            |of: fn(&Local) -> &Vec<f64>| self.elements.gather(1, |face| of(&locals[face as usize]).clone());
        let vector = |of: fn(&Local) -> &Vec<f64>| {
            self.elements.gather_vector(1, |face| of(&locals[face as usize]).clone())
        };
        let edges = self.elements.independent_edges();
        let kept = Kept::new(edges.len(), |e| edges[e as usize]);
        let energy = kept.matrix(&matrix(|local| &local.energy));
        let load = kept.vector(&vector(|local| &local.load));
        let (x, residual, condition, off) = if let Imposed::Nitsche(_) = imposed {
            let (x, residual, condition) = solve(&energy, &load)?;
            (x, residual, condition, 0.0)
        } else {
            let traces = kept.matrix(&matrix(|local| &local.traces));
            let wanted = kept.vector(&vector(|local| &local.data));
            let most = (0..energy.rows()).map(|i| diagonal(&energy, i)).fold(0.0, f64::max);
            let factor = match imposed {
                Imposed::Penalty(factor) => factor * most,
                _ => {
                    FACTOR * most
                        / (0..traces.rows()).map(|i| diagonal(&traces, i)).fold(f64::MIN_POSITIVE, f64::max)
                }
            };
            let all = sum(&energy, &traces, factor);
            let factors = Cholesky::quasi_definite(&all)?;
            let mut right: Vec<f64> = load.iter().zip(&wanted).map(|(a, b)| a + factor * b).collect();
            let (mut steps, mut best) = (0, f64::INFINITY);
            loop {
                let x = factors.solve(right.clone());
                let image = apply(&all, &x);
                let residual = norm(&difference(&right, &image)) / norm(&right).max(f64::MIN_POSITIVE);
                if let Imposed::Penalty(_) = imposed {
                    break (x, residual, factors.condition(), 0.0);
                }
                let off = difference(&wanted, &apply(&traces, &x));
                let size = norm(&off) / norm(&wanted).max(f64::MIN_POSITIVE);
                steps += 1;
                // Rounding ends it where it does not come down any more.
                if size < IMPOSED || (steps > 3 && size > 0.5 * best && size < 1e-7) {
                    break (x, residual, factors.condition(), size);
                }
                if steps == MOST {
                    return Err(FemError::NoConvergence { what: "data on the boundary", iterations: steps });
                }
                best = best.min(size);
                right.iter_mut().zip(&off).for_each(|(r, o)| *r += factor * o);
            }
        };
        Ok(Solved { form: Cochain::new(kept.spread(&x)), unknowns: kept.len(), residual, condition, off })
    }

    /// The matrix of the energy over the cage, with nothing imposed: `(|E|, |E|)`.
    ///
    /// Against `M1` it has the primal spectrum, for comparison: its zeros are none to rounding, and where a corner points
    /// inwards it is that of another operator. [`HilbertComplex`](crate::fem::HilbertComplex) has the right one.
    pub fn energy(&self) -> Csr {
        let elements = self.elements;
        elements.gather(1, |face| match elements.is_inside(face) {
            true => self.energies(face, &elements.corners(face)),
            false => Vec::new(),
        })
    }

    /// The form of the space that is nearest to the solution of some data, in the L2 norm.
    ///
    /// # Errors
    /// [`FemError::Singular`] if the basis is dependent.
    pub fn nearest(&self, data: &Data) -> Result<Solved, FemError> {
        let edges = self.elements.independent_edges();
        let kept = Kept::new(edges.len(), |e| edges[e as usize]);
        let mass = kept.matrix(&self.elements.mass(1));
        let solution = Data { solution: data.solution.clone(), load: Some(data.solution.clone()) };
        let load =
            self.elements.gather_vector(1, |face| self.loads(face, &self.elements.corners(face), &solution));
        let (x, residual, condition) = solve(&mass, &kept.vector(&load))?;
        Ok(Solved {
            form: Cochain::new(kept.spread(&x)),
            unknowns: kept.len(),
            residual,
            condition,
            off: 0.0,
        })
    }

    /// How far a cochain's form is from the solution of some data. Integrals are by the points of the elements: those
    /// of other elements of the surface may be finer.
    ///
    /// # Panics
    /// If the cochain does not belong to the cage.
    pub fn errors(&self, form: &Cochain<1>, data: &Data) -> Errors {
        let surface = self.elements.surface();
        let fine = surface.refine(form);
        let of_face = |face: u32| {
            let mut sums = [0.0; 3];
            if !self.elements.is_inside(face) {
                return sums;
            }
            let corners = self.elements.corners(face);
            let half_edges = surface.face_cells(face).half_edges;
            let values: Vec<f64> = half_edges
                .iter()
                .map(|&h| HalfEdge(h).sign() * fine.values()[HalfEdge(h).edge() as usize])
                .collect();
            for point in self.inside_of(face) {
                let (position, Some(g)) = self.place(face, &corners, point) else { continue };
                let exact = data.solution.pull(&position);
                let zero = [Taylor::constant(0.0); 2];
                let found = point
                    .jets
                    .forms1
                    .iter()
                    .zip(&values)
                    .fold(zero, |sum, (w, &x)| [0, 1].map(|k| sum[k] + w[k] * x));
                let off = [0, 1].map(|k| (found[k] - exact[k]).truncated(self.operator.order()));
                let square = |[x, y]: [f64; 2]| {
                    let [a, b, c] = g.conjugate.map(|x| x.value());
                    point.weight * (a * x * x + 2.0 * b * x * y + c * y * y)
                };
                sums[0] += square(off.map(|x| x.value()));
                let (curl, s) = (g.curl(off), g.codifferential(off));
                sums[1] += point.weight * g.area.value() * (curl.value().powi(2) + s.value().powi(2));
                if self.operator.order() > 1 {
                    sums[2] +=
                        [curl, s].iter().map(|f| square([f.by(0).value(), f.by(1).value()])).sum::<f64>();
                }
            }
            sums
        };
        let faces = surface.hierarchy().finest().mesh().num_faces() as u32;
        let sums: Vec<[f64; 3]> = (0..faces).into_par_iter().map(of_face).collect();
        let total = sums.iter().fold([0.0; 3], |total, s| [0, 1, 2].map(|k| total[k] + s[k]));
        Errors { l2: total[0].sqrt(), energy: total[1].sqrt(), second: total[2].sqrt() }
    }
}

pub fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// The solution of a definite system, and what is left over.
fn solve(matrix: &Csr, right: &[f64]) -> Result<(Vec<f64>, f64, f64), FemError> {
    let factors = Cholesky::quasi_definite(matrix)?;
    let x = factors.solve(right.to_vec());
    let left = norm(&difference(right, &apply(matrix, &x))) / norm(right).max(f64::MIN_POSITIVE);
    match left.is_finite() {
        true => Ok((x, left, factors.condition())),
        false => Err(FemError::Singular),
    }
}
