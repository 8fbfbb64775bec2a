//! Hodge Laplacians on surfaces: their zero modes, their spectra against known ones, solutions and diffusion.

mod common;

use common::meshes::{grid, hexagonal_torus};
use common::solids::{self, Positions, voxels};
use formwork::cochain::Cochain;
use formwork::fem::{
    BoundaryProblem, Elements, HilbertComplex, Metric, Operator, Quadrature, Resolvent, Spectrum,
};
use formwork::limit::{LimitSurface, Taylor};
use formwork::nalgebra::{DMatrix, Vector3};
use formwork::scheme::{BoundaryRule, Scheme, Variant};
use formwork::sparse::Csr;
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
    let counts = |face: u32| {
        let [x, y] = [face % across, face / across].map(|i| place(i as usize) + half);
        x.abs() < 1.0 && y.abs() < 1.0 && inside([x, y])
    };
    let complex = elements.within(counts).complex(0);
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
    // The third is Dirichlet's lowest of functions, as singular as the first.
    for k in [0, 2] {
        let rate = (errors[2][k] / errors[3][k]).log2();
        assert!((rate - 4.0 / 3.0).abs() < 0.1, "{k}: {rate}");
    }
    let last = &errors[3];
    assert!(last[1] < 1e-4 && last[3] < 1e-5 && last[4] < 1e-5 && last[5] < 1e-4, "{last:?}");
}

/// What is asked of a lattice of `n` by `m` periodic cells, in a metric of its two coordinates, whole numbers at vertices.
fn lattice<T>(
    d: formwork::topology::Descriptor,
    [n, m]: [u32; 2],
    tensor: impl Fn([Taylor; 2]) -> [Taylor; 3] + Send + Sync + 'static,
    ask: impl FnOnce(&Elements) -> T,
) -> T {
    let cage = Cage::new(d).unwrap();
    let surface = LimitSurface::new(&cage, scheme(&cage)).unwrap();
    assert_eq!(surface.hierarchy().num_levels(), 0);
    let mesh = surface.hierarchy().level(0).mesh();
    let steps = |face: u32| {
        let (vertices, origin) = (mesh.face_vertices(face), surface.face_origin(face) as usize);
        let at = |i: usize| vertices[(origin + i) % vertices.len()];
        let step = |a: u32, b: u32, n: u32| match (b + n - a) % n {
            x if x + 1 == n => -1.0,
            x => f64::from(x),
        };
        let (o, a, b) = (at(0), at(1), at(vertices.len() - 1));
        let along = |to: u32| [step(o % n, to % n, n), step(o / n, to / n, m)];
        ([f64::from(o % n), f64::from(o / n)], [along(a), along(b)])
    };
    let frames: Vec<_> = (0..mesh.num_faces() as u32).map(steps).collect();
    let metric = Metric::given(move |face, [s, t]| {
        let ([x, y], [a, b]) = frames[face as usize];
        let [xx, xy, yy] =
            tensor([s * a[0] + t * b[0] + Taylor::constant(x), s * a[1] + t * b[1] + Taylor::constant(y)]);
        let pulled = |p: [f64; 2], q: [f64; 2]| {
            xx * (p[0] * q[0]) + xy * (p[0] * q[1] + p[1] * q[0]) + yy * (p[1] * q[1])
        };
        [pulled(a, a), pulled(a, b), pulled(b, b)]
    });
    let positions: Positions = Cochain::new(vec![Vector3::zeros(); mesh.num_vertices()]);
    let elements = Elements::new(&surface, &positions, &Quadrature::new(surface.hierarchy().split_kind()));
    ask(&elements.with_metric(metric))
}

/// The complex of the elements, with nothing in it that is dependent.
fn independent(elements: &Elements) -> HilbertComplex {
    let complex = elements.complex(0);
    complex.pinned(1, &elements.dependent(1)).pinned(2, &elements.dependent(2))
}

/// The energy against the mass, as if of functions with `d` the identity.
fn primal(elements: &Elements) -> HilbertComplex {
    let (energy, mass) =
        (BoundaryProblem::new(elements, Operator::HodgeLaplace, 1).energy(), elements.mass(1));
    let n = mass.rows();
    let d = [Csr::eye(n), Csr::zero((0, n))];
    HilbertComplex::new([mass, energy, Csr::zero((0, 0))], d).pinned(0, &elements.dependent(1))
}

/// The relative error of a multiple eigenvalue, and the size of the zeros before it.
fn error(values: &[f64], zeros: usize, exact: f64) -> f64 {
    assert!(values[..zeros].iter().all(|x| x.abs() < 1e-9), "{values:?}");
    values[zeros..].iter().map(|x| (x / exact - 1.0).abs()).fold(0.0, f64::max)
}

/// `4 pi^2`, eight times, on the flat torus, to the errors tabulated: rate 6 on quads and on triangles, mixed, and 4 by the
/// energy of 1-forms.
#[test]
fn flat_tori_converge_at_rate_six() {
    let exact = 4.0 * std::f64::consts::PI.powi(2);
    for (name, least, tabulated) in [
        ("quads, mixed", 5.9, &[1.29e-3, 1.03e-5, 1.31e-7, 1.10e-8, 1.93e-9][..]),
        ("triangles, mixed", 5.9, &[1.29e-3, 1.03e-5, 1.31e-7, 1.10e-8]),
        ("quads, primal", 3.95, &[1.32e-2, 6.00e-4, 3.41e-5, 6.62e-6]),
        ("triangles, primal", 3.95, &[1.40e-2, 6.92e-4, 4.16e-5]),
    ] {
        let mut before: Option<(f64, f64)> = None;
        for (n, expected) in [4, 8, 16, 24, 32].into_iter().zip(tabulated) {
            let (quads, mixed) = (name.starts_with("quads"), name.ends_with("mixed"));
            let d = if quads { grid(n, n, true) } else { hexagonal_torus(n, n) };
            let h = 1.0 / f64::from(n);
            let flat = move |_| [Taylor::constant(h * h), Taylor::constant(0.0), Taylor::constant(h * h)];
            let complex = lattice(d, [n, n], flat, if mixed { independent } else { primal });
            let values = spectrum(&complex, usize::from(mixed), 10).values;
            let error = error(&values, 2, exact);
            let rate = before.map_or(0.0, |(m, old)| (old / error).ln() / (f64::from(n) / m).ln());
            println!("{name} N = {n}: {error:.2e}, rate {rate:.2}");
            assert!((error / expected - 1.0).abs() < 0.05, "{name} {n}: {error:e}");
            assert!(before.is_none() || rate > least, "{rate}");
            before = Some((f64::from(n), error));
        }
    }
}

/// The lowest eigenvalue of functions on the torus of radii 1 and `r`, once round the axis: by cosines, as an
/// eigenproblem in one angle.
fn torus_reference(r: f64) -> f64 {
    let (modes, points) = (24, 96);
    let zeros = || DMatrix::<f64>::zeros(modes, modes);
    let (mut a, mut b) = (zeros(), zeros());
    for p in 0..points {
        let v = std::f64::consts::TAU * p as f64 / points as f64;
        let rho = 1.0 + r * v.cos();
        for i in 0..modes {
            for j in 0..modes {
                let (k, l) = (i as f64, j as f64);
                let slopes = k * l * (k * v).sin() * (l * v).sin();
                let values = (k * v).cos() * (l * v).cos();
                a[(i, j)] += rho / (r * r) * slopes + values / rho;
                b[(i, j)] += rho * values;
            }
        }
    }
    let inverse = b.cholesky().unwrap().l().try_inverse().unwrap();
    (&inverse * a * inverse.transpose()).symmetric_eigenvalues().min()
}

/// The torus of revolution in its own metric: the first four eigenvalues of 1-forms.
#[test]
fn tori_of_revolution_converge() {
    let exact = torus_reference(0.4);
    assert!((exact - 1.028_956_16).abs() < 1e-8, "{exact}");
    let mut errors = Vec::new();
    for (k, expected) in [1, 2, 4, 6].into_iter().zip([6.1e-4, 1.5e-6, 1.1e-8, 8.6e-10]) {
        let (n, m) = (10 * k, 5 * k);
        let turn = std::f64::consts::TAU;
        let tensor = move |[_, v]: [Taylor; 2]| {
            let rho = (v * (turn / f64::from(m))).cos() * 0.4 + Taylor::constant(1.0);
            let (across, along) = (turn / f64::from(n), 0.4 * turn / f64::from(m));
            [rho * rho * (across * across), Taylor::constant(0.0), Taylor::constant(along * along)]
        };
        let values = spectrum(&lattice(grid(n, m, true), [n, m], tensor, independent), 1, 6).values;
        let error = error(&values, 2, exact);
        println!("{n} x {m}: {error:.2e}");
        assert!((error / expected - 1.0).abs() < 0.08, "{n}: {error:e}");
        errors.push(error);
    }
}

/// The sphere, over the limit surface of Catmull-Clark's cube. Functions converge at rate 6; 1-forms are held back by the
/// eight vertices of valence 3, next to which cochains make densities that are not bounded: `-2 log2` of the
/// subdominant eigenvalue is 2.57.
#[test]
fn spheres_are_limited_by_irregular_vertices() {
    let (d, positions) = voxels([1, 1, 1], |_| true);
    let positions = Cochain::new(positions.values().iter().map(|p| p - Vector3::repeat(0.5)).collect());
    let cage = Cage::new(d).unwrap();
    let surface = LimitSurface::with_levels(&cage, Scheme::default(), 4).unwrap();
    let elements = Elements::new(&surface, &positions, &Quadrature::new(surface.hierarchy().split_kind()))
        .with_metric(Metric::mapped(|p| {
            let r = (p[0] * p[0] + p[1] * p[1] + p[2] * p[2]).sqrt();
            p.map(|x| x / r)
        }));
    let tabulated = [(4.6e-2, 4.0e-4), (4.5e-3, 6.5e-6), (6.5e-4, 7.7e-8), (1.06e-4, 1.4e-9)];
    let mut found: Vec<f64> = Vec::new();
    for (level, expected) in (1..=4).zip(tabulated) {
        let complex = elements.complex(level);
        let one = error(&spectrum(&complex, 1, 6).values, 0, 2.0);
        let zero = error(&spectrum(&complex, 0, 4).values, 1, 2.0);
        println!(
            "{} unknowns: 1-forms {one:.3e}, functions {zero:.3e}, area {:.8}",
            complex.len(1),
            complex.area()
        );
        assert!((one / expected.0 - 1.0).abs() < 0.05, "{level}: {one:e}");
        assert!((zero / expected.1 - 1.0).abs() < 0.2, "{level}: {zero:e}");
        found.push(one);
    }
    let rate = (found[2] / found[3]).log2();
    assert!((2.5..2.7).contains(&rate), "{rate}");
}
