//! Octet subdivision in three dimensions.

#[path = "../common/mod.rs"]
mod common;
mod files;
mod laws;
mod sampling;
mod smooth;
mod spectra;
mod values;
mod volumes;

/// What exact laws are held to: weights of order 1, rows of a few terms.
const EXACT: f64 = 1e-15;

fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).fold(0.0, |worst, (a, b)| worst.max((a - b).abs()))
}
