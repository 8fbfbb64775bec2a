//! The laws of a solid's refinement, measured on random cochains.

use nalgebra::Vector3;
use serde::Serialize;

use super::complex::{Complex, ComplexError};
use super::field;
use super::hierarchy::{Hierarchy, Scheme};
use crate::cochain::Cochain;

/// What the laws are held to: values of order 1, sums of some dozens of terms.
pub const TOLERANCE: f64 = 1e-12;

/// The laws of one step, on cochains with random values in [-1, 1] on level 0.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LevelLaws {
    /// The step leads from `level - 1` to `level`.
    pub level: usize,
    /// The cells of the level: vertices, edges, triangles, tetrahedra and octahedra.
    pub cells: [usize; 4],
    /// The largest entry of `d S c - S d c` for 0-, 1- and 2-forms.
    pub commutation: [f64; 3],
    /// How much the total of a 3-form has changed, over the sum of its magnitudes.
    pub total: f64,
    /// The part of the edges and of the triangles at which the complex is like the lattice, so that smoothing there
    /// is convolution; none for the linear schemes.
    pub regular: Option<[f64; 2]>,
}

/// What [`measure`] found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// The laws of each step.
    pub levels: Vec<LevelLaws>,
    /// What they are held to.
    pub tolerance: f64,
}

impl Report {
    /// The largest deviation.
    pub fn worst(&self) -> f64 {
        let all = self.levels.iter().flat_map(|row| row.commutation.into_iter().chain([row.total]));
        // A NaN is the worst of all, which `f64::max` would drop.
        all.fold(0.0, |worst, x| if x > worst || x.is_nan() { x } else { worst })
    }

    /// Whether the laws hold.
    pub fn holds(&self) -> bool {
        self.worst() <= self.tolerance
    }
}

/// Refines a solid and measures the laws on levels 1 to `levels`, calling `progress(level)` as each is done.
///
/// # Errors
/// [`ComplexError`] if a level would not fit.
///
/// # Panics
/// If the positions belong to another complex.
pub fn measure(
    complex: &Complex,
    positions: &Cochain<0, Vector3<f64>>,
    scheme: Scheme,
    levels: usize,
    mut progress: impl FnMut(usize),
) -> Result<Report, ComplexError> {
    let hierarchy = Hierarchy::new(complex.clone(), scheme, levels)?;
    let values = |r: usize| random(complex.num_cells(r), r as u64 + 1);
    let mut forms =
        (Cochain::<0>::new(values(0)), Cochain::<1>::new(values(1)), Cochain::<2>::new(values(2)));
    let mut derived = (
        forms.0.exterior_derivative(complex),
        forms.1.exterior_derivative(complex),
        forms.2.exterior_derivative(complex),
    );
    // Cells keep their orientation, which positions on level 0 tell; smoothing moves nothing across the boundary.
    let mut integrals = Cochain::<3>::new(values(3));
    let turned = field::volumes(complex, positions);
    integrals = Cochain::new(integrals.values().iter().zip(&turned).map(|(x, v)| x * v.signum()).collect());
    let mut signs = Cochain::<3>::new(turned.into_iter().map(f64::signum).collect());
    let total = |form: &Cochain<3>, signs: &Cochain<3>| -> f64 {
        form.values().iter().zip(signs.values()).map(|(x, sign)| x * sign.signum()).sum()
    };
    let before = total(&integrals, &signs);
    let magnitude: f64 = integrals.values().iter().map(|x| x.abs()).sum();
    let mut rows = Vec::new();
    for level in 1..=levels {
        let fine = hierarchy.level(level);
        forms = (
            hierarchy.refine(level, &forms.0),
            hierarchy.refine(level, &forms.1),
            hierarchy.refine(level, &forms.2),
        );
        derived = (
            hierarchy.refine(level, &derived.0),
            hierarchy.refine(level, &derived.1),
            hierarchy.refine(level, &derived.2),
        );
        integrals = hierarchy.refine(level, &integrals);
        // The linear scheme of cells is positive: signs stay signs.
        signs = scheme.linear.refine(hierarchy.level(level - 1), &signs);
        rows.push(LevelLaws {
            level,
            cells: [0, 1, 2, 3].map(|r| fine.num_cells(r)),
            commutation: [
                difference(forms.0.exterior_derivative(fine).values(), derived.0.values()),
                difference(forms.1.exterior_derivative(fine).values(), derived.1.values()),
                difference(forms.2.exterior_derivative(fine).values(), derived.2.values()),
            ],
            total: (total(&integrals, &signs) - before).abs() / magnitude.max(f64::MIN_POSITIVE),
            regular: hierarchy.smoothing(level).map(|smoothing| {
                let part = |count: usize, all: usize| count as f64 / all.max(1) as f64;
                let edges = (0..fine.num_cells(1) as u32).filter(|&e| smoothing.is_regular_edge(e)).count();
                let all = 0..fine.num_cells(2) as u32;
                let triangles = all.filter(|&t| smoothing.is_regular_triangle(t)).count();
                [part(edges, fine.num_cells(1)), part(triangles, fine.num_cells(2))]
            }),
        });
        progress(level);
    }
    Ok(Report { levels: rows, tolerance: TOLERANCE })
}

fn difference(a: &[f64], b: &[f64]) -> f64 {
    let gaps = a.iter().zip(b).map(|(a, b)| (a - b).abs());
    gaps.fold(0.0, |worst, x| if x > worst || x.is_nan() { x } else { worst })
}

/// Numbers in [-1, 1] that look random and are the same every time.
fn random(len: usize, seed: u64) -> Vec<f64> {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    let next = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    std::iter::repeat_with(next).take(len).collect()
}
