use nalgebra::DMatrix;
use rayon::prelude::*;

use super::FemError;
use super::resolvent::Resolvent;
use crate::sparse::{combination, inner};

/// The lowest eigenvalues of a Hodge Laplacian with their forms.
#[derive(Clone, Debug)]
pub struct Spectrum {
    /// The eigenvalues, ascending, each as often as it occurs; in units of 1 / length^2.
    pub values: Vec<f64>,
    /// For each its form, as a cochain: orthonormal in the mass of their degree.
    pub forms: Vec<Vec<f64>>,
    /// For each `|(T - 1 / (value + s)) w| (value + s)`, `T` the resolvent: the relative error of the form, times the
    /// relative gap to the other eigenvalues; that of the value is of the order of its square.
    pub residuals: Vec<f64>,
    /// How often the resolvent was applied.
    pub applications: usize,
}

impl Spectrum {
    /// How many eigenvalues are 0 to rounding: below `1e-9` of the shift's scale.
    pub fn zeros(&self, scale: f64) -> usize {
        self.values.iter().filter(|value| value.abs() < 1e-9 * scale).count()
    }
}

/// What Ritz vectors are converged to, relative.
const CONVERGED: f64 = 1e-12;

/// What is left of a vector is rounding below this part of it.
const NOTHING: f64 = 1e-12;

/// Blocks at most.
const MOST: usize = 80;

/// Orthonormal vectors, with their images by the mass.
#[derive(Default)]
struct Basis {
    vectors: Vec<Vec<f64>>,
    weighed: Vec<Vec<f64>>,
}

impl Resolvent<'_> {
    /// The `count` lowest eigenvalues of the Hodge Laplacian with their forms, by block Lanczos iteration with the
    /// resolvent, every vector made orthogonal to all before it. A block has more vectors than are wanted, so that no
    /// multiplicity is missed. Eigenvalues are Rayleigh quotients, sums of squares, so that zeros come out as
    /// zeros.
    ///
    /// On a complex with fewer forms of the degree all of them are returned.
    ///
    /// # Errors
    /// [`FemError::NoConvergence`].
    pub fn lowest(&self, count: usize) -> Result<Spectrum, FemError> {
        let n = self.complex().len(self.degree());
        let count = count.min(n);
        let block = (count + 2).min(n);
        let below = self.below();
        let forms = |pairs: Vec<Vec<f64>>| -> Vec<Vec<f64>> {
            pairs.into_iter().map(|mut pair| pair.split_off(below)).collect()
        };
        if count == 0 {
            return Ok(Spectrum { values: vec![], forms: vec![], residuals: vec![], applications: 0 });
        }
        let mut basis = Basis::default();
        // Smooth from the start: what has high frequencies is of no use.
        let mut applications = block;
        let start = forms(self.invert(&noise(n, block)));
        basis.extend(self, start);
        let mut columns: Vec<Vec<f64>> = Vec::new();
        let mut last = 0..basis.vectors.len();
        for _ in 0..MOST {
            let images = forms(self.invert(&basis.weighed[last.clone()]));
            applications += last.len();
            let known = basis.vectors.len();
            columns.extend(basis.extend(self, images));
            // H = Q' M T Q, by columns; those of earlier blocks end where their successors' rows end.
            let h = DMatrix::from_fn(known, known, |i, j| {
                let (i, j) = if i <= j { (i, j) } else { (j, i) };
                columns[j].get(i).copied().unwrap_or(0.0)
            });
            let ritz = h.symmetric_eigen();
            let mut order: Vec<usize> = (0..known).collect();
            order.sort_by(|&a, &b| ritz.eigenvalues[b].total_cmp(&ritz.eigenvalues[a]));
            order.truncate(count);
            let residual = |&k: &usize| {
                let rest = (known..basis.vectors.len()).map(|i| {
                    let entries = last.clone().map(|j| columns[j][i] * ritz.eigenvectors[(j, k)]);
                    entries.sum::<f64>().powi(2)
                });
                rest.fold(0.0, |a, b| a + b).sqrt() / ritz.eigenvalues[k]
            };
            let residuals: Vec<f64> = order.iter().map(residual).collect();
            let converged = residuals.iter().all(|r| *r < CONVERGED) && order.len() == count;
            if converged || basis.vectors.len() == known {
                let ritz_vectors: Vec<Vec<f64>> = order
                    .iter()
                    .map(|&k| combination(&basis.vectors[..known], ritz.eigenvectors.column(k).as_slice(), n))
                    .collect();
                return Ok(self.polished(ritz_vectors, residuals, applications + count));
            }
            last = known..basis.vectors.len();
        }
        Err(FemError::NoConvergence { what: "an eigenvalue", iterations: MOST })
    }

    /// The spectrum of Ritz vectors, each taken through the resolvent once more, which also gives its `sigma`.
    fn polished(&self, vectors: Vec<Vec<f64>>, residuals: Vec<f64>, applications: usize) -> Spectrum {
        let weighed: Vec<Vec<f64>> = vectors.par_iter().map(|w| self.weigh(w)).collect();
        let pairs = self.invert(&weighed);
        let [_, unit] = self.units();
        // Units of the mesh to those of the caller: <w, w> = unit^(1 - k) <w, w>.
        let size = unit.powi(1 - self.degree() as i32);
        let of = |mut pair: Vec<f64>| {
            let [energy, norm] = self.energy(&pair);
            let mut form = pair.split_off(self.below());
            let scale = 1.0 / (norm * size).sqrt();
            form.iter_mut().for_each(|x| *x *= scale);
            (energy / norm / unit, form)
        };
        let mut found: Vec<(f64, Vec<f64>, f64)> = pairs
            .into_iter()
            .zip(residuals)
            .map(|(pair, residual)| {
                let (value, form) = of(pair);
                (value, form, residual)
            })
            .collect();
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        Spectrum {
            values: found.iter().map(|x| x.0).collect(),
            residuals: found.iter().map(|x| x.2).collect(),
            forms: found.into_iter().map(|x| x.1).collect(),
            applications,
        }
    }
}

impl Basis {
    /// Adds what is new in some vectors; for each vector its coefficients on the basis as it is then.
    fn extend(&mut self, resolvent: &Resolvent, mut vectors: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
        let known = self.vectors.len();
        let norm = |x: &Vec<f64>| inner(x, &resolvent.weigh(x)).max(0.0).sqrt();
        let before: Vec<f64> = vectors.par_iter().map(norm).collect();
        let mut coefficients = vec![vec![0.0; known]; vectors.len()];
        for _ in 0..2 {
            vectors.par_iter_mut().zip(&mut coefficients).for_each(|(x, sum)| {
                let found: Vec<f64> = self.weighed.iter().map(|q| inner(q, x)).collect();
                let part = combination(&self.vectors, &found, x.len());
                x.iter_mut().zip(part).for_each(|(x, y)| *x -= y);
                sum.iter_mut().zip(found).for_each(|(sum, c)| *sum += c);
            });
        }
        for ((mut x, sum), before) in vectors.into_iter().zip(&mut coefficients).zip(before) {
            sum.resize(self.vectors.len(), 0.0);
            // Against those of its own block; and where that leaves little, against all once more.
            let (mut first, mut previous) = (known, f64::INFINITY);
            loop {
                let basis = self.vectors.iter().zip(&self.weighed).zip(sum.iter_mut());
                for ((q, weighed), sum) in basis.skip(first) {
                    let c = inner(weighed, &x);
                    x.par_iter_mut().zip(q).for_each(|(x, y)| *x -= c * y);
                    *sum += c;
                }
                let mut weighed = resolvent.weigh(&x);
                let size = inner(&x, &weighed).max(0.0).sqrt();
                if size.is_nan() || size <= NOTHING * before {
                    break;
                }
                if size > 0.5 * previous {
                    x.iter_mut().for_each(|x| *x /= size);
                    weighed.iter_mut().for_each(|x| *x /= size);
                    sum.push(size);
                    self.vectors.push(x);
                    self.weighed.push(weighed);
                    break;
                }
                (first, previous) = (0, size);
            }
        }
        coefficients.iter_mut().for_each(|sum| sum.resize(self.vectors.len(), 0.0));
        coefficients
    }
}

/// Vectors of numbers in `[-1, 1)` that look random and are the same every time.
fn noise(len: usize, count: usize) -> Vec<Vec<f64>> {
    let mut state = 0x9e37_79b9_7f4a_7c15u64;
    let mut next = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    (0..count).map(|_| (0..len).map(|_| next()).collect()).collect()
}
