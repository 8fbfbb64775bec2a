//! Hodge Laplacians on surfaces: their zero modes, their spectra against known ones, solutions and diffusion.

mod common;

use common::meshes::grid;
use common::solids::{self, Positions, refined, slab, triangles};
use common::{EXACT, random};
use formwork::cochain::Cochain;
use formwork::fem::{Diffusion, Elements, HilbertComplex, HodgeLaplace, Quadrature, Resolvent, Spectrum, TimeRule};
use formwork::limit::LimitSurface;
use formwork::nalgebra::Vector3;
use formwork::scheme::{BoundaryRule, Scheme, Variant};
use formwork::sparse::{Csr, apply};
use formwork::topology::Cage;

const LOOP: Scheme = Scheme::Loop(Variant::Loop, BoundaryRule::Reflect);

fn scheme(cage: &Cage) -> Scheme {
    if cage.descriptor().face_sizes.iter().all(|&n| n == 3) { LOOP } else { Scheme::default() }
}

fn complex(cage: &Cage, positions: &Positions) -> HilbertComplex {
    let surface = LimitSurface::new(cage, scheme(cage)).unwrap();
    let elements = Elements::new(&surface, positions, &Quadrature::new(surface.hierarchy().split_kind()));
    let mesh = surface.hierarchy().level(0).mesh();
    HilbertComplex::new([0, 1, 2].map(|k| elements.mass(k)), [mesh.d0(), mesh.d1()])
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
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
            println!("{} {k}: {:.3?} {:.1?} {}", solid.name, spectrum.values, spectrum.residuals, spectrum.applications);
            let (zeros, others) = spectrum.values.split_at(betti[k]);
            assert!(zeros.iter().all(|x| x.abs() < 1e-9 * others[0]), "{} {k}: {zeros:?}", solid.name);
        }
        let mut union = [&found[0].values[betti[0]..], &found[2].values[betti[2]..]].concat();
        union.sort_by(f64::total_cmp);
        for (a, b) in found[1].values[betti[1]..].iter().zip(&union) {
            assert!((a - b).abs() < 1e-9 * b, "{}: {a} {b}", solid.name);
        }
    }
}
