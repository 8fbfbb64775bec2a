use super::FemError;
use super::complex::diagonal;
use crate::sparse::{Csr, apply, inner};

/// What conjugate gradients found.
#[derive(Clone, Debug)]
pub struct Iterated {
    /// The solution.
    pub solution: Vec<f64>,
    /// The steps taken.
    pub iterations: usize,
    /// `|b - A x| / |b|`, computed from the solution.
    pub residual: f64,
    /// An estimate of the condition number of the matrix scaled to diagonal 1, from the extreme eigenvalues of
    /// Lanczos' matrix: from below.
    pub condition: f64,
}

/// Solves `A x = b` by conjugate gradients with the diagonal as a preconditioner: for systems too large for factors. `A` is
/// symmetric and positive; where it is only semidefinite, `b` is in its range, and so is what is found.
///
/// Source: Hestenes, Stiefel, 1952; for the estimate Golub, Van Loan, "Matrix Computations", section 10.2.
///
/// # Errors
/// [`FemError::NoConvergence`] if `|r| <= tolerance |b|` is not reached in so many steps, [`FemError::Singular`] if the
/// matrix is seen not to be positive.
///
/// # Panics
/// If the right-hand side is of another length.
pub fn conjugate_gradients(a: &Csr, b: &[f64], tolerance: f64, most: usize) -> Result<Iterated, FemError> {
    assert_eq!(a.rows(), b.len(), "a right-hand side of another length");
    let inverse: Vec<f64> = (0..a.rows())
        .map(|i| match diagonal(a, i) {
            x if x > 0.0 => 1.0 / x,
            _ => 0.0,
        })
        .collect();
    let scale = |r: &[f64]| r.iter().zip(&inverse).map(|(x, y)| x * y).collect::<Vec<f64>>();
    let norm = inner(b, b).sqrt();
    let mut x = vec![0.0; b.len()];
    let (mut r, mut z) = (b.to_vec(), scale(b));
    let mut p = z.clone();
    let mut size = inner(&r, &z);
    // Lanczos' matrix.
    let (mut main, mut side, mut before) = (Vec::new(), Vec::new(), None);
    while inner(&r, &r).sqrt() > tolerance * norm {
        if main.len() == most {
            return Err(FemError::NoConvergence { what: "a solution", iterations: most });
        }
        let image = apply(a, &p);
        let curvature = inner(&p, &image);
        if curvature.is_nan() || curvature <= 0.0 {
            return Err(FemError::Singular);
        }
        let step = size / curvature;
        x.iter_mut().zip(&p).for_each(|(x, p)| *x += step * p);
        r.iter_mut().zip(&image).for_each(|(r, q)| *r -= step * q);
        z = scale(&r);
        let next = inner(&r, &z);
        let ratio = next / size;
        p.iter_mut().zip(&z).for_each(|(p, z)| *p = z + ratio * *p);
        main.push(1.0 / step + before.map_or(0.0, |(step, ratio): (f64, f64)| ratio / step));
        side.push(ratio.sqrt() / step);
        (before, size) = (Some((step, ratio)), next);
    }
    let image = apply(a, &x);
    let left: Vec<f64> = b.iter().zip(&image).map(|(b, y)| b - y).collect();
    let residual = if norm > 0.0 { inner(&left, &left).sqrt() / norm } else { 0.0 };
    let iterations = main.len();
    side.pop();
    let condition = match extremes(&main, &side) {
        Some([low, high]) if low > 0.0 => high / low,
        _ => 1.0,
    };
    Ok(Iterated { solution: x, iterations, residual, condition })
}

/// The least and the largest eigenvalue of a symmetric tridiagonal matrix, by bisection with Sturm's sequence.
fn extremes(main: &[f64], side: &[f64]) -> Option<[f64; 2]> {
    let n = main.len();
    if n == 0 {
        return None;
    }
    let radius = |i: usize| {
        let left = if i > 0 { side[i - 1].abs() } else { 0.0 };
        left + side.get(i).map_or(0.0, |x| x.abs())
    };
    let low = (0..n).map(|i| main[i] - radius(i)).fold(f64::INFINITY, f64::min);
    let high = (0..n).map(|i| main[i] + radius(i)).fold(f64::NEG_INFINITY, f64::max);
    // How many eigenvalues are below x.
    let below = |x: f64| {
        let (mut count, mut pivot) = (0, 1.0);
        for i in 0..n {
            let coupling = if i > 0 { side[i - 1] * side[i - 1] } else { 0.0 };
            pivot = main[i] - x - coupling / pivot;
            if pivot == 0.0 {
                pivot = f64::EPSILON * (main[i].abs() + x.abs());
            }
            count += usize::from(pivot < 0.0);
        }
        count
    };
    let find = |wanted: usize| {
        let (mut a, mut b) = (low, high);
        for _ in 0..100 {
            let middle = 0.5 * (a + b);
            if below(middle) >= wanted { b = middle } else { a = middle }
        }
        0.5 * (a + b)
    };
    Some([find(1), find(n)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sparse::assemble;

    /// The second difference on 40 points: eigenvalues 2 - 2 cos(j pi / 41).
    #[test]
    fn a_string_has_its_condition() {
        let n = 40;
        let string = assemble((n, n), |i, row| {
            row.add(i as u32, 2.0);
            (i > 0).then(|| row.add(i as u32 - 1, -1.0));
            (i + 1 < n).then(|| row.add(i as u32 + 1, -1.0));
        });
        let right: Vec<f64> = (0..n).map(|i| ((i * i) as f64).sin()).collect();
        let found = conjugate_gradients(&string, &right, 1e-13, 1000).unwrap();
        assert!(found.residual < 1e-12, "{found:?}");
        let angle = std::f64::consts::PI / 41.0;
        let exact = (1.0 + angle.cos()) / (1.0 - angle.cos());
        assert!((found.condition / exact - 1.0).abs() < 1e-6, "{} {exact}", found.condition);
        assert!(matches!(
            conjugate_gradients(&string, &right, 1e-13, 3),
            Err(FemError::NoConvergence { iterations: 3, .. })
        ));
    }
}
