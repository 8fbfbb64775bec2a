//! Finite elements on surfaces: what masses cost by the face, and systems of 100 000 unknowns from the cage to the
//! solution. Words pick cases: `cargo bench --bench fem -- assembly`.

mod common;
#[path = "../tests/common/solids.rs"]
mod solids;

use std::time::Instant;

use common::{Random, meshes};
use formwork::fem::{Elements, HilbertComplex, HodgeLaplace, Quadrature, poisson};
use formwork::limit::LimitSurface;
use formwork::scheme::{BoundaryRule, Scheme, Variant};
use formwork::topology::Cage;
use solids::{Positions, refined, slab, triangles};

const CATMARK: fn() -> Scheme = Scheme::default;
const LOOP: fn() -> Scheme = || Scheme::Loop(Variant::Loop, BoundaryRule::Reflect);

fn main() {
    println!("seconds; {} threads", std::thread::available_parallelism().map_or(1, usize::from));
    let wanted = std::env::args().skip(1).find(|arg| !arg.starts_with('-')).unwrap_or_default();
    let chosen = |name: &str| name.contains(&wanted);
    if chosen("assembly") {
        assembly();
    }
    for degree in 0..3 {
        if chosen(&format!("solve {degree}")) {
            solve(degree);
        }
    }
    if chosen("iteration") {
        iterate();
    }
}

struct Clock(Instant);

impl Clock {
    fn lap(&mut self) -> f64 {
        let seconds = self.0.elapsed().as_secs_f64();
        self.0 = Instant::now();
        seconds
    }
}

/// A surface of genus 2 with irregular vertices, refined.
fn genus2(cut: bool, levels: usize) -> (Cage, Positions, Scheme) {
    let (d, positions) = slab(2);
    let (cage, scheme) = match cut {
        true => (Cage::new(triangles(&d)).unwrap(), LOOP()),
        false => (Cage::new(d).unwrap(), CATMARK()),
    };
    let (cage, positions) = refined(&cage, scheme, &positions, levels);
    (cage, positions, scheme)
}

fn assembly() {
    println!("\nassembly, genus 2:    faces   surface  elements    M0      M1      M2   us a face");
    for (name, cut, levels) in [("quads", false, 3..7), ("triangles", true, 2..6)] {
        for level in levels {
            let (cage, positions, scheme) = genus2(cut, level);
            let mut clock = Clock(Instant::now());
            let surface = LimitSurface::new(&cage, scheme).unwrap();
            let set_up = clock.lap();
            let elements =
                Elements::new(&surface, &positions, &Quadrature::new(surface.hierarchy().split_kind()));
            let bases = clock.lap();
            let masses = [0, 1, 2].map(|k| {
                drop(std::hint::black_box(elements.mass(k)));
                clock.lap()
            });
            let faces = surface.hierarchy().level(0).mesh().num_faces();
            let each = masses.iter().sum::<f64>() / faces as f64 * 1e6;
            println!(
                "  {name:<10} {faces:>16} {set_up:>9.3} {bases:>9.3} {:>7.3} {:>7.3} {:>7.3} {each:>9.1}",
                masses[0], masses[1], masses[2]
            );
        }
    }
}

fn complex(cage: &Cage, positions: &Positions, scheme: Scheme) -> HilbertComplex {
    let surface = LimitSurface::new(cage, scheme).unwrap();
    Elements::new(&surface, positions, &Quadrature::new(surface.hierarchy().split_kind())).complex(0)
}

/// A load with nothing harmonic in functions and 2-forms.
fn load(complex: &HilbertComplex, degree: usize) -> Vec<f64> {
    let mut random = Random::new();
    let n = complex.len(degree);
    let form: Vec<f64> = (0..n).map(|_| random.unit() - 0.5).collect();
    formwork::sparse::apply(complex.mass(degree), &form)
}

/// A plate of cubes with two windows, as many as make a system of more than 100 000 unknowns: of functions at its vertices,
/// otherwise with those of `delta w`.
fn plate(degree: usize) -> (Cage, Positions, Scheme) {
    let n = [240, 136, 136][degree];
    let window = |x: i32, from: i32, to: i32| (from * n / 8..to * n / 8).contains(&x);
    let (d, positions) =
        solids::voxels([n, n, 3], |[x, y, _]| !(window(y, 3, 5) && (window(x, 1, 3) || window(x, 5, 7))));
    (Cage::new(d).unwrap(), positions, CATMARK())
}

/// The Hodge-Laplace problem of a degree, mixed.
fn solve(degree: usize) {
    let (cage, positions, scheme) = plate(degree);
    let mut clock = Clock(Instant::now());
    let complex = complex(&cage, &positions, scheme);
    let assembled = clock.lap();
    let problem = HodgeLaplace::new(&complex, degree).unwrap();
    let factored = clock.lap();
    let solution = problem.solve(&load(&complex, degree), None).unwrap();
    let solved = clock.lap();
    println!(
        "\nsolve {degree}: {} unknowns, {:.1} M entries in the factors\n  assembled {assembled:.2}, factors and harmonic forms {factored:.2}, solved {solved:.2}: {:.2} in all\n  {} iterations, residual {:.1e}, condition {:.1e}",
        problem.resolvent().unknowns(),
        problem.resolvent().factor_entries() as f64 / 1e6,
        assembled + factored + solved,
        solution.iterations,
        solution.residual,
        problem.resolvent().condition(),
    );
    let spectrum = problem.resolvent().lowest(10).unwrap();
    println!("  ten eigenvalues {:.2}, {} solutions", clock.lap(), spectrum.applications);
}

fn iterate() {
    let (cage, positions, scheme) = genus2(false, 5);
    let mut clock = Clock(Instant::now());
    let complex = complex(&cage, &positions, scheme);
    let assembled = clock.lap();
    let (found, condition) = poisson(&complex, &load(&complex, 0)).unwrap();
    println!(
        "\niteration: functions, {} unknowns: assembled {assembled:.2}, solved {:.2} in {} steps, residual {:.1e}, condition {condition:.1e}",
        complex.len(0),
        clock.lap(),
        found.iterations,
        found.residual,
    );
}
