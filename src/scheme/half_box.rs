//! The face weights that Loop's 2-forms take round a vertex: half-box splines, (4.2) and (4.3) of Ke
//! Wang's thesis, and three rules for the sectors at boundaries and creases.

use std::f64::consts::{PI, TAU};

use super::correction::{FaceWeights, circulant};
use crate::topology::Mesh;

/// The weights of the corner children of the faces of a sector (at a boundary, a crease or a corner).
///
/// All keep the flux and constants, and all are the same where the interior is regular. They differ in
/// how fast variation dies out along the boundary.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BoundaryRule {
    /// The sector is reflected evenly into a fan of twice its faces, which takes the interior weights.
    /// Eigenvalues of the fan: 1, 1/2, 1/4, 1/8, ...
    #[default]
    Reflect,
    /// Appendix B of the thesis, `C = 2/3`, `D = 1/6`. From four faces on its subdominant eigenvalue exceeds
    /// 1/2 (0.67 at four, 0.91 at eight), so a kink along the boundary dies out slowly.
    Thesis,
    /// A cosine transform with eigenvalues 1, 1/2, 1/2, 1/4, 1/8, ... for any number of faces; the
    /// thesis' rule up to three faces.
    Dct,
}

/// The half-box weights `beta_0 .. beta_{k-1}` of a smooth vertex: the corner child of face `f_0` takes
/// `beta_j / 4` of face `f_j`. Their eigenvalues are `2^-min(m, k-m)`, but `1/2` for `m = 3`, `k = 6`,
/// which makes the regular weights 1/2, 1/8, 1/8, 0, 1/8, 1/8.
///
/// # Panics
/// If `k` is 0.
pub fn weights(k: usize) -> Vec<f64> {
    let eigenvalue = |m: usize| match (k, m.min(k - m)) {
        (6, 3) => 0.5,
        (_, m) => 0.5f64.powi(m as i32),
    };
    let turn = TAU / k as f64;
    let beta = |j: usize| {
        // The angle is reduced first: m j grows far beyond the period.
        let sum: f64 = (0..k).map(|m| eigenvalue(m) * (turn * ((m * j) % k) as f64).cos()).sum();
        sum / k as f64
    };
    (0..k).map(beta).collect()
}

/// The matrix of a sector of `k` faces, row after row: the corner child of face `i` takes a quarter of
/// `sum_j B_ij D_j`. Column and row sums are 1. `None` for [`BoundaryRule::Reflect`], which is not made
/// from a matrix.
pub fn corner_matrix(rule: BoundaryRule, k: usize) -> Option<Vec<f64>> {
    match rule {
        BoundaryRule::Reflect => None,
        BoundaryRule::Thesis => Some(thesis_matrix(k)),
        BoundaryRule::Dct => Some(dct_matrix(k)),
    }
}

fn thesis_matrix(k: usize) -> Vec<f64> {
    let (c, d) = (2.0 / 3.0, 1.0 / 6.0);
    let row = |i: usize| -> Vec<f64> {
        match (k, i) {
            (1, _) => vec![1.0],
            (2, _) => vec![0.75, 0.25],
            (_, 0) => vec![c, d, 1.0 - c - d],
            (3, _) => vec![d, 1.0 - 2.0 * d, d],
            (_, 1) => vec![7.0 / 8.0 - c, 3.0 / 4.0 - d, c + d - 3.0 / 4.0, 1.0 / 8.0],
            _ => [vec![0.0; i - 2], vec![0.125, 0.125, 0.5, 0.125, 0.125]].concat(),
        }
    };
    let mut matrix = vec![0.0; k * k];
    for i in 0..k.div_ceil(2) {
        for (j, &weight) in row(i).iter().enumerate() {
            matrix[i * k + j] = weight;
            matrix[(k - 1 - i) * k + (k - 1 - j)] = weight;
        }
    }
    matrix
}

fn dct_matrix(k: usize) -> Vec<f64> {
    let n = k as f64;
    let mu = |m: usize| if m <= 2 { 0.5 } else { 0.5f64.powi(m as i32 - 1) };
    let wave = |m: usize, i: usize| (PI * m as f64 * (i as f64 + 0.5) / n).cos();
    let entry = |i, j| 1.0 / n + 2.0 / n * (1..k).map(|m| mu(m) * wave(m, i) * wave(m, j)).sum::<f64>();
    (0..k * k).map(|index| entry(index / k, index % k)).collect()
}

/// Half-box weights with one of the sector rules; a face counts by its value.
pub(super) struct HalfBox(pub BoundaryRule);

impl FaceWeights for HalfBox {
    /// `beta_j / 4 - alpha'_j`, with `alpha' = (3/16, 1/32, 0, .., 0, 1/32)`.
    fn delta(&self, k: usize) -> Vec<f64> {
        let unmended = circulant(k, 3.0 / 16.0, 1.0 / 32.0, |_| 0.0);
        weights(k).iter().zip(unmended).map(|(beta, plain)| beta / 4.0 - plain).collect()
    }

    fn unit(&self, _: &Mesh, _: u32) -> f64 {
        1.0
    }

    /// `B(q, r) = 1/4 sum_{i<q} (delta_ir - B_ir) - ([r = q-1] - [r = q])/32`.
    fn sector(&self, n: usize) -> Option<Vec<f64>> {
        let matrix = corner_matrix(self.0, n)?;
        let mut rows = vec![0.0; n * n];
        for q in 1..n {
            for r in 0..n {
                let before = rows[(q - 1) * n + r] + thirty_second(q - 1, r);
                let taken = f64::from(r == q - 1) - matrix[(q - 1) * n + r];
                rows[q * n + r] = before + taken / 4.0 - thirty_second(q, r);
            }
        }
        Some(rows)
    }
}

/// `([r = q-1] - [r = q])/32` on the spokes inside a sector.
fn thirty_second(q: usize, r: usize) -> f64 {
    match q {
        0 => 0.0,
        q => (f64::from(r + 1 == q) - f64::from(r == q)) / 32.0,
    }
}
