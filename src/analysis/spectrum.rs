//! Eigenvalues of the operators on the rings.

use nalgebra::linalg::Schur;
use nalgebra::{Complex, DMatrix};

use super::AnalysisError;
use super::ring::Ring;
use super::symmetry::{Block, Symmetry};

/// An eigenvalue of a block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eigenvalue {
    /// The value; real for all schemes here, to rounding.
    pub value: Complex<f64>,
    /// The symmetry of its eigenvectors.
    pub symmetry: Symmetry,
    /// How often it is an eigenvalue of the whole matrix by this block: a mode and its conjugate count.
    pub multiplicity: usize,
    /// How many independent eigenvectors it has there. If there are fewer than its multiplicity the matrix is defective: its
    /// powers grow by a polynomial factor over those of the value.
    pub eigenvectors: usize,
}

/// An eigenvalue of `S1`, and what its copies come from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeEigenvalue {
    /// The eigenvalue.
    pub eigenvalue: Eigenvalue,
    /// So many are eigenvalues of `S0`, but for the 1 of constants: with eigenvectors that are differentials.
    pub exact: usize,
    /// So many are eigenvalues of `S2`: with vectors that have a curl.
    pub faces: usize,
    /// So many are neither. On a disk there are none.
    pub rest: usize,
}

/// The eigenvalues of `S0`, `S1` and `S2` on the rings round a vertex, from the largest modulus down.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrum {
    /// Of `S0`.
    pub s0: Vec<Eigenvalue>,
    /// Of `S1`, with what they come from.
    pub s1: Vec<EdgeEigenvalue>,
    /// Of `S2`.
    pub s2: Vec<Eigenvalue>,
    /// The largest distance between an eigenvalue of `S1` and that of `S0` or `S2` that it was matched with.
    pub mismatch: f64,
}

/// Eigenvalues this near to each other are taken for one. Rounding splits an eigenvalue with a chain of two vectors by the
/// root of the machine precision; their mean is exact to rounding again.
const SAME: f64 = 1e-6;
/// Singular values below this, relative to the largest entry, count as 0. OpenSubdiv's weights of Loop's rule come from a
/// cosine in single precision; that moves eigenvalues, not ranks.
const RANK: f64 = 1e-9;

impl Spectrum {
    /// The eigenvalues of the operators of rings, each by itself, and then those of `S1` matched with the others, mode
    /// by mode.
    ///
    /// # Errors
    /// If an eigenvalue does not converge.
    pub fn new(ring: &Ring) -> Result<Self, AnalysisError> {
        let of = |k: usize| -> Result<Vec<Eigenvalue>, AnalysisError> {
            let mut all = Vec::new();
            for block in ring.blocks(k) {
                all.extend(eigenvalues(&block)?);
            }
            Ok(all)
        };
        let (mut s0, s1, mut s2) = (of(0)?, of(1)?, of(2)?);
        // Each single eigenvalue of S0 and S2 can explain one of S1.
        let singles = |values: &[Eigenvalue], exact: bool| -> Vec<Known> {
            let known = |&Eigenvalue { value, symmetry, .. }: &Eigenvalue| Known { value, symmetry, exact };
            values.iter().flat_map(|e| std::iter::repeat_n(known(e), e.multiplicity)).collect()
        };
        let mut known = singles(&s0, true);
        let is_constant = |known: &Known| matches!(known.symmetry, Symmetry::Mode(0) | Symmetry::Even);
        let one = (0..known.len()).filter(|&i| is_constant(&known[i]));
        let off = |i: &usize| (known[*i].value - 1.0).norm();
        if let Some(one) = one.min_by(|i, j| off(i).total_cmp(&off(j))) {
            known.remove(one);
        }
        known.extend(singles(&s2, false));

        let mut mismatch = 0.0f64;
        let mut s1: Vec<_> = s1.into_iter().map(|e| explain(e, &mut known, &mut mismatch)).collect();
        let by_size = |a: &Eigenvalue, b: &Eigenvalue| {
            let [p, q] = [a, b].map(|e| (e.value.norm() * 1e12).round());
            q.total_cmp(&p).then(a.symmetry.cmp(&b.symmetry))
        };
        s0.sort_by(by_size);
        s1.sort_by(|a, b| by_size(&a.eigenvalue, &b.eigenvalue));
        s2.sort_by(by_size);
        Ok(Spectrum { s0, s1, s2, mismatch })
    }

    /// The largest eigenvalue of `S0` but the 1 of constants.
    pub fn subdominant(&self) -> Option<&Eigenvalue> {
        self.s0.get(1)
    }

    /// How many eigenvalues of `S1` are those of `S0`, those of `S2`, and neither.
    pub fn counts(&self) -> [usize; 3] {
        self.s1.iter().fold([0; 3], |sum, e| [sum[0] + e.exact, sum[1] + e.faces, sum[2] + e.rest])
    }
}

/// An eigenvalue of `S0` or of `S2`.
#[derive(Clone)]
struct Known {
    value: Complex<f64>,
    symmetry: Symmetry,
    exact: bool,
}

/// What the copies of an eigenvalue of `S1` come from; what explains one is used up.
fn explain(eigenvalue: Eigenvalue, known: &mut Vec<Known>, mismatch: &mut f64) -> EdgeEigenvalue {
    let mut e = EdgeEigenvalue { eigenvalue, exact: 0, faces: 0, rest: 0 };
    for _ in 0..eigenvalue.multiplicity {
        let candidates = (0..known.len()).filter(|&i| known[i].symmetry == eigenvalue.symmetry);
        let distances = candidates.map(|i| (i, (known[i].value - eigenvalue.value).norm()));
        match distances.min_by(|a, b| a.1.total_cmp(&b.1)) {
            Some((i, distance)) if distance < SAME => {
                *mismatch = mismatch.max(distance);
                match known.swap_remove(i).exact {
                    true => e.exact += 1,
                    false => e.faces += 1,
                }
            }
            _ => e.rest += 1,
        }
    }
    e
}

/// The eigenvalues of a block, with their numbers of eigenvectors.
pub fn eigenvalues(block: &Block) -> Result<Vec<Eigenvalue>, AnalysisError> {
    let mut values = Vec::new();
    for rows in irreducible(&block.matrix) {
        let part = DMatrix::from_fn(rows.len(), rows.len(), |i, j| block.matrix[(rows[i], rows[j])]);
        values.extend(schur(part)?);
    }
    let mut clusters: Vec<Vec<Complex<f64>>> = Vec::new();
    for value in values {
        match clusters.iter_mut().find(|cluster| (cluster[0] - value).norm() < SAME) {
            Some(cluster) => cluster.push(value),
            None => clusters.push(vec![value]),
        }
    }
    let eigenvalue = |cluster: Vec<Complex<f64>>| {
        let value = cluster.iter().sum::<Complex<f64>>() / cluster.len() as f64;
        // One eigenvector is sure; whether there are more, the rank of B - value says.
        let own = match cluster.len() {
            1 => 1,
            n => nullity(&block.matrix, value).clamp(1, n),
        };
        Eigenvalue {
            value,
            symmetry: block.symmetry,
            multiplicity: block.copies * cluster.len(),
            eigenvectors: block.copies * own,
        }
    };
    Ok(clusters.into_iter().map(eigenvalue).collect())
}

fn shifted(matrix: &DMatrix<Complex<f64>>, value: Complex<f64>) -> DMatrix<Complex<f64>> {
    matrix - DMatrix::identity(matrix.nrows(), matrix.nrows()) * value
}

fn nullity(matrix: &DMatrix<Complex<f64>>, value: Complex<f64>) -> usize {
    let singular = shifted(matrix, value).singular_values();
    singular.iter().filter(|&&s| s < RANK * singular.max()).count()
}

/// The eigenvector of a simple eigenvalue, of length 1.
pub fn eigenvector(matrix: &DMatrix<Complex<f64>>, value: Complex<f64>) -> Option<Vec<Complex<f64>>> {
    let svd = shifted(matrix, value).svd(false, true);
    let row = svd.v_t?.row(svd.singular_values.imin()).map(|x| x.conj());
    Some(row.iter().copied().collect())
}

fn schur(matrix: DMatrix<Complex<f64>>) -> Result<Vec<Complex<f64>>, AnalysisError> {
    let size = matrix.nrows();
    if size == 1 {
        return Ok(vec![matrix[(0, 0)]]);
    }
    let decomposed = Schur::try_new(matrix, f64::EPSILON, 10_000);
    let values = decomposed.and_then(|schur| schur.eigenvalues());
    values.map(|values| values.iter().copied().collect()).ok_or(AnalysisError::NoConvergence { size })
}

/// The irreducible diagonal blocks of a matrix: sets of rows that reach each other through entries that are not 0. Rings
/// further out depend on those further in and not the other way, so these blocks are small, and coinciding eigenvalues of
/// different ones do not disturb each other.
fn irreducible(matrix: &DMatrix<Complex<f64>>) -> Vec<Vec<usize>> {
    let n = matrix.nrows();
    let dust = 1e-14 * matrix.iter().fold(0.0f64, |most, x| most.max(x.norm()));
    let mut reaches = DMatrix::from_fn(n, n, |i, j| i == j || matrix[(i, j)].norm() > dust);
    for via in 0..n {
        for i in 0..n {
            for j in 0..n {
                reaches[(i, j)] |= reaches[(i, via)] && reaches[(via, j)];
            }
        }
    }
    let together =
        |i: usize| -> Vec<usize> { (0..n).filter(|&j| reaches[(i, j)] && reaches[(j, i)]).collect() };
    (0..n).map(|i| (i, together(i))).filter(|(i, rows)| rows[0] == *i).map(|(_, rows)| rows).collect()
}
