use super::complex::HilbertComplex;
use super::{FemError, stiffness, transpose};
use crate::sparse::{Cholesky, Csr, apply, assemble, inner, multiply, row_of};

/// `(Delta + s)^-1`, the resolvent of the Hodge Laplacian `Delta = d delta + delta d` of a degree, with one factorisation.
///
/// With `sigma = delta w` as an unknown of its own (the mixed form; `delta = M^-1 d' M` is never formed), `(Delta + s) w = f`
/// is, with `k` the degree,
///
/// ```text
/// [ -M_{k-1}        d' M_k         ] [sigma]   [ 0 ]
/// [  M_k d    d' M_{k+1} d + s M_k ] [  w  ] = [<f>]
/// ```
///
/// For `s > 0` this is quasi-definite: never singular, whatever the topology, and factorised without pivots. The mixed
/// form finds singular solutions at corners and has as many harmonic forms as the surface has, to rounding; the primal one
/// (`<d.,d.> + <delta.,delta.>` over forms smooth enough for both) has neither.
pub struct Resolvent<'a> {
    complex: &'a HilbertComplex,
    degree: usize,
    shift: f64,
    /// Squared length in which the matrices below are written, so that their entries are near 1.
    unit: f64,
    /// `M_{k-1}`, `M_k`, `M_k d` and `d' M_{k+1} d`.
    lower: Csr,
    mass: Csr,
    coupling: Csr,
    transposed: Csr,
    stiffness: Csr,
    /// The unknowns that are kept at 0.
    pinned: Vec<usize>,
    factor: Cholesky,
}

/// A condition from which on nothing is left of a solution.
const SINGULAR: f64 = 1e15;

/// A matrix times a number.
fn scaled(matrix: &Csr, factor: f64) -> Csr {
    let mut matrix = matrix.clone();
    matrix.data_mut().iter_mut().for_each(|x| *x *= factor);
    matrix
}

impl<'a> Resolvent<'a> {
    /// Factorises `Delta + shift`, `shift > 0` in units of 1 / length^2.
    ///
    /// # Errors
    /// If a mass is singular: the basis is dependent, or a face has no area.
    ///
    /// # Panics
    /// If `degree > 2` or the shift is not positive.
    pub fn new(complex: &'a HilbertComplex, degree: usize, shift: f64) -> Result<Self, FemError> {
        assert!(degree <= 2, "surfaces have forms of degree 0, 1 and 2");
        assert!(shift > 0.0 && shift.is_finite(), "a resolvent wants a positive shift, not {shift}");
        if complex.is_empty(degree) {
            return Err(FemError::Empty { degree });
        }
        let unit = complex.area() / complex.len(0).max(1) as f64;
        let unit = if unit > 0.0 && unit.is_finite() { unit } else { 1.0 };
        // Lengths in units of sqrt(unit): M_k times unit^(k - 1).
        let mass_of = |k: usize| scaled(complex.mass(k), unit.powi(k as i32 - 1));
        let mass = mass_of(degree);
        let n = mass.rows();
        let (lower, coupling) = match degree.checked_sub(1) {
            Some(below) => (mass_of(below), multiply(&mass, complex.d(below))),
            None => (Csr::zero((0, 0)), Csr::zero((n, 0))),
        };
        let stiffness = match degree {
            2 => Csr::zero((n, n)),
            _ => stiffness(&mass_of(degree + 1), complex.d(degree)),
        };
        let transposed = transpose(&coupling);
        let below = lower.rows();
        let is_pinned = |i: usize| match i.checked_sub(below) {
            None => complex.is_pinned(degree - 1, i as u32),
            Some(i) => complex.is_pinned(degree, i as u32),
        };
        let pinned: Vec<usize> = (0..below + n).filter(|&i| is_pinned(i)).collect();
        let fixed = |i: usize| pinned.binary_search(&i).is_ok();
        let matrix = assemble((below + n, below + n), |i, row| {
            if fixed(i) {
                return row.add(i as u32, if i < below { -1.0 } else { 1.0 });
            }
            let mut add = |matrix: &Csr, i: usize, offset: usize, factor: f64| {
                let (columns, entries) = row_of(matrix, i);
                for (&j, &x) in columns.iter().zip(entries) {
                    if pinned.is_empty() || !fixed(offset + j as usize) {
                        row.add(offset as u32 + j, factor * x);
                    }
                }
            };
            match i.checked_sub(below) {
                None => {
                    add(&lower, i, 0, -1.0);
                    add(&transposed, i, below, 1.0);
                }
                Some(i) => {
                    add(&coupling, i, 0, 1.0);
                    add(&stiffness, i, below, 1.0);
                    add(&mass, i, below, shift * unit);
                }
            }
        });
        let factor = Cholesky::quasi_definite(&matrix)?;
        let resolvent = Resolvent {
            complex,
            degree,
            shift,
            unit,
            lower,
            mass,
            coupling,
            transposed,
            stiffness,
            pinned,
            factor,
        };
        match resolvent.condition() < SINGULAR {
            true => Ok(resolvent),
            false => Err(FemError::Singular),
        }
    }

    /// A shift that suits spectra and solutions: the first eigenvalue that is not 0 is a few times as large on a
    /// compact surface (2.5 times on a sphere).
    pub fn natural_shift(complex: &HilbertComplex) -> f64 {
        let area = complex.area();
        if area > 0.0 && area.is_finite() { 10.0 / area } else { 1.0 }
    }

    /// The complex.
    pub fn complex(&self) -> &'a HilbertComplex {
        self.complex
    }

    /// The degree of the forms.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// The shift.
    pub fn shift(&self) -> f64 {
        self.shift
    }

    /// The number of entries of the factors.
    pub fn factor_entries(&self) -> usize {
        self.factor.entries()
    }

    /// The number of unknowns that are solved for: `w` and `sigma`.
    pub fn unknowns(&self) -> usize {
        self.factor.size()
    }

    /// An estimate of the condition number, in the 1-norm, of the matrix that was factorised, with lengths in units of
    /// the mesh: a lower bound ([`Cholesky::condition`]).
    pub fn condition(&self) -> f64 {
        self.factor.condition()
    }

    /// `M_k w`, in units of the mesh.
    pub(super) fn weigh(&self, w: &[f64]) -> Vec<f64> {
        apply(&self.mass, w)
    }

    /// The factor from a load `<f>` to units of the mesh, and that of the squared length.
    pub(super) fn units(&self) -> [f64; 2] {
        [self.unit.powi(self.degree as i32), self.unit]
    }

    /// Solves for pairs `(sigma, w)` with right-hand sides `(g, f)` in units of the mesh, in place: each vector has the
    /// unknowns of `sigma` first.
    pub(super) fn solve_pairs(&self, right: &mut [Vec<f64>]) {
        for x in right.iter_mut() {
            self.pinned.iter().for_each(|&i| x[i] = 0.0);
        }
        self.factor.solve_all(right);
    }

    /// `w -> (Delta + s)^-1 w` for several forms: pairs `(sigma, w)` in units of the mesh, from `M_k w`.
    pub(super) fn invert(&self, weighed: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let below = self.lower.rows();
        let pad = |f: &Vec<f64>| {
            let mut right = vec![0.0; below];
            right.extend_from_slice(f);
            right
        };
        let mut pairs: Vec<Vec<f64>> = weighed.iter().map(pad).collect();
        self.solve_pairs(&mut pairs);
        pairs
    }

    /// The number of unknowns `sigma`.
    pub(super) fn below(&self) -> usize {
        self.lower.rows()
    }

    /// `<dw, dw> + <sigma, sigma>` and `<w, w>` of a pair, in units of the mesh: with `sigma = delta w` their quotient is
    /// Rayleigh's.
    pub(super) fn energy(&self, pair: &[f64]) -> [f64; 2] {
        let (sigma, w) = pair.split_at(self.below());
        let curl = if self.stiffness.nnz() > 0 { inner(w, &apply(&self.stiffness, w)) } else { 0.0 };
        [curl + inner(sigma, &apply(&self.lower, sigma)), inner(w, &self.weigh(w))]
    }

    /// What is left over of `(g, f)` by a pair at shift 0: `g - d' M w + M sigma` and `f - M d sigma - d' M d w`.
    pub(super) fn residual(&self, pair: &[f64], right: &[f64]) -> [Vec<f64>; 2] {
        let (sigma, w) = pair.split_at(self.below());
        let (g, f) = right.split_at(self.below());
        let (m, b) = (apply(&self.lower, sigma), apply(&self.transposed, w));
        let (c, k) = (apply(&self.coupling, sigma), apply(&self.stiffness, w));
        let first: Vec<f64> = g.iter().zip(m.iter().zip(&b)).map(|(g, (m, b))| g + m - b).collect();
        let second: Vec<f64> = f.iter().zip(c.iter().zip(&k)).map(|(f, (c, k))| f - c - k).collect();
        [first, second]
    }
}
