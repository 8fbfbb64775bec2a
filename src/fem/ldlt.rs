use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::ldlt::factor::LdltRegularization;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LdltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};
use rayon::prelude::*;

use super::FemError;
use crate::sparse::Csr;

/// The factors `L D L'` of a sparse symmetric quasi-definite matrix `[-A, B'; B, C]`, `A` and `C` positive definite, by
/// faer. Such a matrix has them in any order of its unknowns, so that the order is chosen for sparsity alone: Vanderbei,
/// "Symmetric quasidefinite matrices", SIAM J. Optim. 1995. Definite matrices are a special case.
///
/// Results are the same to the bit for any number of threads.
pub struct Ldlt {
    symbolic: SymbolicCholesky<usize>,
    values: Vec<f64>,
    /// The 1-norm of the matrix.
    norm: f64,
}

/// Right-hand sides are solved for in groups of this many, one group a thread.
const GROUP: usize = 4;

impl Ldlt {
    /// Factorises a matrix, both halves of which are stored.
    ///
    /// # Errors
    /// [`FemError::Singular`] if there is a pivot of 0, or one that is no number.
    pub fn new(matrix: &Csr) -> Result<Self, FemError> {
        let n = matrix.rows();
        // The rows of a symmetric matrix are its columns.
        let offsets = matrix.indptr().to_owned().into_raw_storage();
        let rows: Vec<usize> = matrix.indices().iter().map(|&i| i as usize).collect();
        let pattern = SymbolicSparseColMatRef::new_checked(n, n, &offsets, None, &rows);
        let symbolic = factorize_symbolic_cholesky(
            pattern,
            Side::Upper,
            SymmetricOrdering::Amd,
            CholeskySymbolicParams::default(),
        )
        .map_err(|_| FemError::TooLarge { unknowns: n })?;
        let sizes = matrix.outer_iterator().map(|row| row.data().iter().map(|x| x.abs()).sum::<f64>());
        let norm = sizes.fold(0.0, f64::max);
        let mut values = vec![0.0; symbolic.len_val()];
        let request = symbolic.factorize_numeric_ldlt_scratch::<f64>(Par::Seq, Default::default());
        let mut memory = MemBuffer::new(request);
        symbolic
            .factorize_numeric_ldlt(
                &mut values,
                SparseColMatRef::new(pattern, matrix.data()),
                Side::Upper,
                LdltRegularization::default(),
                Par::Seq,
                MemStack::new(&mut memory),
                Default::default(),
            )
            .map_err(|_| FemError::Singular)?;
        match values.iter().all(|x| x.is_finite()) {
            true => Ok(Ldlt { symbolic, values, norm }),
            false => Err(FemError::Singular),
        }
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
        let solve = |x: Vec<f64>| {
            let mut x = [x];
            self.solve(&mut x);
            let [x] = x;
            x
        };
        let (mut x, mut best) = (vec![1.0 / n as f64; n], 0.0f64);
        for _ in 0..5 {
            let y = solve(x);
            let size: f64 = y.iter().map(|v| v.abs()).sum();
            if size <= best {
                break;
            }
            best = size;
            let z = solve(y.iter().map(|v| if *v < 0.0 { -1.0 } else { 1.0 }).collect());
            let largest = (0..n).fold(0, |at, i| if z[i].abs() > z[at].abs() { i } else { at });
            x = vec![0.0; n];
            x[largest] = 1.0;
        }
        self.norm * best
    }

    /// Solves for right-hand sides, in place.
    ///
    /// # Panics
    /// If one is of another length.
    pub fn solve(&self, right: &mut [Vec<f64>]) {
        let n = self.size();
        assert!(right.iter().all(|x| x.len() == n), "a right-hand side of another length");
        right.par_chunks_mut(GROUP).for_each(|group| {
            let mut x = group.concat();
            let mut memory =
                MemBuffer::new(self.symbolic.solve_in_place_scratch::<f64>(group.len(), Par::Seq));
            LdltRef::new(&self.symbolic, &self.values).solve_in_place_with_conj(
                Conj::No,
                MatMut::from_column_major_slice_mut(&mut x, n, group.len()),
                Par::Seq,
                MemStack::new(&mut memory),
            );
            group.iter_mut().zip(x.chunks_exact(n.max(1))).for_each(|(to, from)| to.copy_from_slice(from));
        });
    }
}
