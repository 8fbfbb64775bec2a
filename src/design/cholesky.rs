use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};

use crate::sparse::Csr;

/// The Cholesky factor of a sparse symmetric positive definite matrix, by faer, on one thread: the same to the bit
/// wherever it is made.
pub struct Cholesky {
    symbolic: SymbolicCholesky<usize>,
    values: Vec<f64>,
}

/// The matrix is not positive definite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NotPositive;

impl Cholesky {
    /// Factorises a matrix, both halves of which are stored.
    pub fn new(matrix: &Csr) -> Result<Self, NotPositive> {
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
        .map_err(|_| NotPositive)?;
        let mut values = vec![0.0; symbolic.len_val()];
        let request = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
        let mut memory = MemBuffer::new(request);
        symbolic
            .factorize_numeric_llt(
                &mut values,
                SparseColMatRef::new(pattern, matrix.data()),
                Side::Upper,
                LltRegularization::default(),
                Par::Seq,
                MemStack::new(&mut memory),
                Default::default(),
            )
            .map_err(|_| NotPositive)?;
        Ok(Cholesky { symbolic, values })
    }

    /// The number of entries of the factor, zeros of its dense blocks included.
    pub fn entries(&self) -> usize {
        self.values.len()
    }

    /// Solves for one right-hand side.
    ///
    /// # Panics
    /// If it is of another length.
    pub fn solve(&self, mut x: Vec<f64>) -> Vec<f64> {
        let n = self.symbolic.nrows();
        assert_eq!(x.len(), n, "a right-hand side of another length");
        if n == 0 {
            return x;
        }
        let request: StackReq = self.symbolic.solve_in_place_scratch::<f64>(1, Par::Seq);
        let mut memory = MemBuffer::new(request);
        LltRef::new(&self.symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(&mut x, n, 1),
            Par::Seq,
            MemStack::new(&mut memory),
        );
        x
    }
}
