use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::ldlt::factor::LdltRegularization;
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LdltRef, LltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};
use rayon::prelude::*;

use super::Csr;
use super::fronts::{Diagonal, Fronts};

/// The factors of a sparse symmetric matrix, by faer, on one thread; solutions take all threads there are. Both are the same
/// to the bit for any number.
pub struct Cholesky {
    symbolic: SymbolicCholesky<usize>,
    values: Vec<f64>,
    diagonal: Diagonal,
    /// The tree of its fronts, if it has any: one solution is then shared by threads.
    fronts: Option<Fronts>,
    /// The 1-norm of the matrix.
    norm: f64,
}

/// Why a matrix has no factors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoFactors {
    /// A pivot is not positive, or is 0, or is no number.
    Singular,
    /// There is no memory for as many unknowns.
    TooLarge,
}

/// Right-hand sides are solved for in groups of this many, one group a thread.
const GROUP: usize = 4;

impl Cholesky {
    /// `L L'` of a positive definite matrix, both halves of which are stored.
    ///
    /// # Errors
    /// [`NoFactors::Singular`] if the matrix is not positive definite.
    pub fn definite(matrix: &Csr) -> Result<Self, NoFactors> {
        Self::new(matrix, Diagonal::Shared)
    }

    /// `L D L'` of a quasi-definite matrix `[-A, B'; B, C]`, `A` and `C` positive definite, both halves of which are stored.
    /// Such a matrix has them in any order of its unknowns, so that the order is chosen for sparsity alone: Vanderbei,
    /// "Symmetric quasidefinite matrices", SIAM J. Optim. 1995.
    ///
    /// # Errors
    /// [`NoFactors::Singular`] if there is a pivot of 0, or one that is no number.
    pub fn quasi_definite(matrix: &Csr) -> Result<Self, NoFactors> {
        Self::new(matrix, Diagonal::Apart)
    }

    fn new(matrix: &Csr, diagonal: Diagonal) -> Result<Self, NoFactors> {
        let n = matrix.rows();
        // The rows of a symmetric matrix are its columns.
        let offsets = matrix.indptr().to_owned().into_raw_storage();
        let rows: Vec<usize> = matrix.indices().iter().map(|&i| i as usize).collect();
        let pattern = SymbolicSparseColMatRef::new_checked(n, n, &offsets, None, &rows);
        let ordering = SymmetricOrdering::Amd;
        let symbolic =
            factorize_symbolic_cholesky(pattern, Side::Upper, ordering, CholeskySymbolicParams::default())
                .map_err(|_| NoFactors::TooLarge)?;
        let (a, up, seq) = (SparseColMatRef::new(pattern, matrix.data()), Side::Upper, Par::Seq);
        let mut values = vec![0.0; symbolic.len_val()];
        let request = match diagonal {
            Diagonal::Shared => symbolic.factorize_numeric_llt_scratch::<f64>(seq, Default::default()),
            Diagonal::Apart => symbolic.factorize_numeric_ldlt_scratch::<f64>(seq, Default::default()),
        };
        let mut memory = MemBuffer::new(request);
        let (stack, l) = (MemStack::new(&mut memory), &mut values);
        // Without regularisation: what has no factors is refused.
        let done = match diagonal {
            Diagonal::Shared => {
                let none = LltRegularization::default();
                symbolic.factorize_numeric_llt(l, a, up, none, seq, stack, Default::default()).is_ok()
            }
            Diagonal::Apart => {
                let none = LdltRegularization::default();
                symbolic.factorize_numeric_ldlt(l, a, up, none, seq, stack, Default::default()).is_ok()
            }
        };
        if !done || values.iter().any(|x| !x.is_finite()) {
            return Err(NoFactors::Singular);
        }
        let fronts = match symbolic.raw() {
            SymbolicCholeskyRaw::Supernodal(pattern) => Fronts::new(pattern),
            SymbolicCholeskyRaw::Simplicial(_) => None,
        };
        let sizes = matrix.outer_iterator().map(|row| row.data().iter().map(|x| x.abs()).sum::<f64>());
        Ok(Cholesky { norm: sizes.fold(0.0, f64::max), symbolic, values, diagonal, fronts })
    }

    /// The number of unknowns.
    pub fn size(&self) -> usize {
        self.symbolic.nrows()
    }

    /// The number of entries of the factor, zeros of its dense blocks included.
    pub fn entries(&self) -> usize {
        self.values.len()
    }

    /// An estimate of the condition number in the 1-norm. It is a lower bound, seldom less than a third of the truth: Hager,
    /// "Condition estimates", 1984; Higham, "FORTRAN codes for estimating the one-norm", 1988.
    pub fn condition(&self) -> f64 {
        let n = self.size();
        let (mut x, mut best) = (vec![1.0 / n as f64; n], 0.0f64);
        for _ in 0..5 {
            let y = self.solve(x);
            let size: f64 = y.iter().map(|v| v.abs()).sum();
            if size <= best {
                break;
            }
            best = size;
            let z = self.solve(y.iter().map(|v| if *v < 0.0 { -1.0 } else { 1.0 }).collect());
            let largest = (0..n).fold(0, |at, i| if z[i].abs() > z[at].abs() { i } else { at });
            x = vec![0.0; n];
            x[largest] = 1.0;
        }
        self.norm * best
    }

    /// Solves for one right-hand side.
    ///
    /// # Panics
    /// If it is of another length.
    pub fn solve(&self, mut x: Vec<f64>) -> Vec<f64> {
        assert_eq!(x.len(), self.size(), "a right-hand side of another length");
        match (&self.fronts, self.symbolic.perm()) {
            (Some(fronts), Some(order)) => {
                let (forward, _) = order.arrays();
                let mut y: Vec<f64> = forward.iter().map(|&i| x[i]).collect();
                fronts.solve(&self.values, self.diagonal, &mut y);
                forward.iter().zip(&y).for_each(|(&i, &value)| x[i] = value);
            }
            _ => self.solve_columns(&mut x, 1),
        }
        x
    }

    /// Solves for right-hand sides, in place.
    ///
    /// # Panics
    /// If one is of another length.
    pub fn solve_all(&self, right: &mut [Vec<f64>]) {
        let n = self.size();
        assert!(right.iter().all(|x| x.len() == n), "a right-hand side of another length");
        if let [x] = right {
            *x = self.solve(std::mem::take(x));
            return;
        }
        right.par_chunks_mut(GROUP).for_each(|group| {
            let mut x = group.concat();
            self.solve_columns(&mut x, group.len());
            group.iter_mut().zip(x.chunks_exact(n.max(1))).for_each(|(to, from)| to.copy_from_slice(from));
        });
    }

    /// One after the other in `x`.
    fn solve_columns(&self, x: &mut [f64], columns: usize) {
        if x.is_empty() {
            return;
        }
        let mut memory = MemBuffer::new(self.symbolic.solve_in_place_scratch::<f64>(columns, Par::Seq));
        let stack = MemStack::new(&mut memory);
        let x = MatMut::from_column_major_slice_mut(x, self.size(), columns);
        match self.diagonal {
            Diagonal::Shared => {
                let factors = LltRef::new(&self.symbolic, &self.values);
                factors.solve_in_place_with_conj(Conj::No, x, Par::Seq, stack);
            }
            Diagonal::Apart => {
                let factors = LdltRef::new(&self.symbolic, &self.values);
                factors.solve_in_place_with_conj(Conj::No, x, Par::Seq, stack);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sparse::{apply, assemble, row_of};

    /// A Laplacian of a grid, of many fronts, and one that faer keeps without fronts.
    #[test]
    fn solutions_solve() {
        for (n, fronts) in [(120u32, true), (3, false)] {
            let at = |i: u32, j: u32| i + n * j;
            let size = (n * n) as usize;
            let matrix = assemble((size, size), |v, row| {
                let (i, j) = (v as u32 % n, v as u32 / n);
                row.add(v as u32, 0.01);
                for di in 0..5 {
                    for dj in 0..5 {
                        if (2..n + 2).contains(&(i + di)) && (2..n + 2).contains(&(j + dj)) {
                            row.add(at(i + di - 2, j + dj - 2), -1.0);
                            row.add(v as u32, 1.0);
                        }
                    }
                }
            });
            // With the signs of a few rows and columns turned it is indefinite, and with their blocks apart quasi-definite.
            let turned = |v: usize| if v % 5 == 2 { -1.0 } else { 1.0 };
            let indefinite = assemble((size, size), |v, row| {
                let (columns, entries) = row_of(&matrix, v);
                for (&j, &x) in columns.iter().zip(entries) {
                    let same = turned(v) == turned(j as usize);
                    row.add(j, if same { turned(v) * x } else { x });
                }
            });
            assert_eq!(Cholesky::definite(&indefinite).err(), Some(NoFactors::Singular));
            for (matrix, factors) in [
                (&matrix, Cholesky::definite(&matrix)),
                (&matrix, Cholesky::quasi_definite(&matrix)),
                (&indefinite, Cholesky::quasi_definite(&indefinite)),
            ] {
                let factors = factors.unwrap();
                assert_eq!(factors.fronts.is_some(), fronts);
                let mut right = vec![0.0; size];
                (right[0], right[size / 2]) = (1.0, -2.0);
                let x = factors.solve(right.clone());
                let off = |x: &[f64]| {
                    let left =
                        apply(matrix, x).iter().zip(&right).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                    assert!(left < 1e-11, "{left:e}");
                };
                off(&x);
                let mut pair = [right.clone(), right.clone()];
                factors.solve_all(&mut pair);
                pair.iter().for_each(|x| off(x));
                assert!(factors.condition() >= 1.0);
            }
        }
    }
}
