use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};

use super::fronts::Fronts;
use crate::sparse::Csr;

/// The Cholesky factor of a sparse symmetric positive definite matrix, by faer, on one thread; solutions take all there are.
/// Both are the same to the bit for any number.
pub struct Cholesky {
    symbolic: SymbolicCholesky<usize>,
    values: Vec<f64>,
    /// The tree of its fronts, if it has any: solutions are then shared by threads.
    fronts: Option<Fronts>,
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
        let fronts = match symbolic.raw() {
            SymbolicCholeskyRaw::Supernodal(pattern) => Fronts::new(pattern),
            SymbolicCholeskyRaw::Simplicial(_) => None,
        };
        Ok(Cholesky { symbolic, values, fronts })
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
        if let (Some(fronts), Some(order)) = (&self.fronts, self.symbolic.perm()) {
            let (forward, _) = order.arrays();
            let mut y: Vec<f64> = forward.iter().map(|&i| x[i]).collect();
            fronts.solve(&self.values, &mut y);
            forward.iter().zip(&y).for_each(|(&i, &value)| x[i] = value);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sparse::{apply, assemble};

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
            let cholesky = Cholesky::new(&matrix).unwrap();
            assert_eq!(cholesky.fronts.is_some(), fronts);
            let mut right = vec![0.0; size];
            (right[0], right[size / 2]) = (1.0, -2.0);
            let x = cholesky.solve(right.clone());
            let off = apply(&matrix, &x).iter().zip(&right).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < 1e-11, "{off:e}");
        }
    }
}
