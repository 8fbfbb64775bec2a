//! Hodge Laplacians on surfaces: their zero modes, their spectra against known ones, solutions and diffusion.

mod common;

use common::meshes::grid;
use common::solids::{self, Positions};
use formwork::cochain::Cochain;
use formwork::fem::{Elements, HilbertComplex, Quadrature, Resolvent, Spectrum};
use formwork::limit::LimitSurface;
use formwork::nalgebra::Vector3;
use formwork::scheme::{BoundaryRule, Scheme, Variant};
use formwork::topology::Cage;

const LOOP: Scheme = Scheme::Loop(Variant::Loop, BoundaryRule::Reflect);

fn scheme(cage: &Cage) -> Scheme {
    if cage.descriptor().face_sizes.iter().all(|&n| n == 3) { LOOP } else { Scheme::default() }
}

fn complex(cage: &Cage, positions: &Positions) -> HilbertComplex {
    let surface = LimitSurface::new(cage, scheme(cage)).unwrap();
    Elements::new(&surface, positions, &Quadrature::new(surface.hierarchy().split_kind())).complex(0)
}

fn spectrum(complex: &HilbertComplex, degree: usize, count: usize) -> Spectrum {
    let shift = Resolvent::natural_shift(complex);
    Resolvent::new(complex, degree, shift).unwrap().lowest(count).unwrap()
}

/// As many zeros as the topology says, on closed surfaces of genus 0, 1, 2 and with natural boundaries; the spectrum of
/// 1-forms is that of functions and that of 2-forms, without their zeros, put together.
#[test]
fn zero_modes_are_betti_numbers_and_spectra_fit_together() {
    for solid in solids::all().into_iter().filter(|s| s.genus <= 2) {
        let complex = complex(&solid.cage, &solid.positions);
        let betti = complex.betti().unwrap();
        assert_eq!(betti, [1, solid.betti(), usize::from(solid.loops == 0)], "{}", solid.name);
        let found = [0, 1, 2].map(|k| spectrum(&complex, k, betti[k] + 6));
        for (k, spectrum) in found.iter().enumerate() {
            let (zeros, others) = spectrum.values.split_at(betti[k]);
            assert!(zeros.iter().all(|x| x.abs() < 1e-9 * others[0]), "{} {k}: {zeros:?}", solid.name);
            assert!(others[0] > 0.01, "{} {k}: a zero too many", solid.name);
            assert!(spectrum.residuals.iter().all(|r| *r < 1e-11), "{:?}", spectrum.residuals);
        }
        let mut union = [&found[0].values[betti[0]..], &found[2].values[betti[2]..]].concat();
        union.sort_by(f64::total_cmp);
        for (a, b) in found[1].values[betti[1]..].iter().zip(&union) {
            assert!((a - b).abs() < 1e-9 * b, "{}: {a} {b}", solid.name);
        }
    }
}

/// Cells of side `1 / n` on a square from -1 to 1 with one layer more outside, where forms count nothing.
fn square(n: u32, inside: impl Fn([f64; 2]) -> bool + Sync) -> HilbertComplex {
    let across = 2 * n + 2;
    let place = |i: usize| i as f64 / f64::from(n) - 1.0 - 1.0 / f64::from(n);
    let columns = across as usize + 1;
    let point = |v: usize| Vector3::new(place(v % columns), place(v / columns), 0.0);
    let cage = Cage::new(grid(across, across, false)).unwrap();
    let positions: Positions = Cochain::new((0..columns * columns).map(point).collect());
    let surface = LimitSurface::new(&cage, Scheme::default()).unwrap();
    assert_eq!(surface.hierarchy().num_levels(), 0);
    let elements = Elements::new(&surface, &positions, &Quadrature::new(surface.hierarchy().split_kind()));
    let half = 0.5 / f64::from(n);
    let weight = |face: u32| {
        let [i, j] = [face % across, face / across].map(|i| place(i as usize) + half);
        f64::from(u8::from(i.abs() < 1.0 && j.abs() < 1.0 && inside([i, j])))
    };
    let complex = elements.complex_on(0, weight);
    complex.restricted(&complex.support())
}

/// Without a corner that turns inwards the mixed spectrum is that of the square: sums of squares of `pi / 2`.
#[test]
fn a_square_has_its_spectrum() {
    let [coarse, fine] = [2, 4].map(|n| {
        let complex = square(n, |_| true);
        assert_eq!(
            [0, 1, 2].map(|k| complex.len(k) as u32),
            [(2 * n + 3) * (2 * n + 3), 2 * (2 * n + 2) * (2 * n + 3), (2 * n + 2) * (2 * n + 2)]
        );
        let quarter = std::f64::consts::PI.powi(2) / 4.0;
        let values = spectrum(&complex, 1, 6).values;
        let error = |(value, exact): (&f64, f64)| (value / (exact * quarter) - 1.0).abs();
        // Neumann's (1, 0), (0, 1), (1, 1) and Dirichlet's (1, 1), then (2, 0) and (0, 2).
        values.iter().zip([1.0, 1.0, 2.0, 2.0, 4.0, 4.0]).map(error).fold(0.0, f64::max)
    });
    println!("square: {coarse:.2e} {fine:.2e}");
    assert!(fine < 1e-4 && (coarse / fine).log2() > 5.5, "{coarse:e} {fine:e}");
}

/// The L-shape of Costabel and Dauge's benchmark: the lowest eigenvalue belongs to a form that is not smooth, and the
/// mixed method comes near it at the rate 4/3 that its singularity allows; smooth ones are found to six digits.
#[test]
fn the_l_shape_has_its_singular_eigenvalue() {
    let inside = |[x, y]: [f64; 2]| x < 0.0 || y > 0.0;
    let tabulated = [1.5514, 1.5096, 1.4892, 1.4810];
    let exact = [1.47562, 3.53403, 9.63972, 9.86960, 9.86960, 11.38948];
    let mut errors = Vec::new();
    for (n, expected) in [2, 4, 8, 16].into_iter().zip(tabulated) {
        let complex = square(n, inside);
        assert_eq!(complex.betti().unwrap(), [1, 0, 0]);
        let values = spectrum(&complex, 1, 6).values;
        println!("h = 1/{n}: {values:.5?}");
        assert!((values[0] - expected).abs() < 1e-4, "{}", values[0]);
        errors.push(values.iter().zip(exact).map(|(x, y)| (x - y).abs()).collect::<Vec<_>>());
    }
    let rate = (errors[2][0] / errors[3][0]).log2();
    assert!((rate - 4.0 / 3.0).abs() < 0.1, "{rate}");
    let last = &errors[3];
    assert!(last[1] < 1e-4 && last[2] < 1e-2 && last[3] < 1e-5 && last[4] < 1e-5, "{last:?}");
}
