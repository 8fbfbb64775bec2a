//! Masses in other metrics than the surface's own.

mod common;

use std::f64::consts::{PI, TAU};

use common::meshes::grid;
use common::solids::{self, refined};
use common::{EXACT, random};
use formwork::cochain::Cochain;
use formwork::fem::{Elements, Metric, Quadrature};
use formwork::limit::{LimitSurface, Taylor};
use formwork::nalgebra::Vector3;
use formwork::scheme::{BoundaryRule, Scheme, Variant};
use formwork::sparse::apply;
use formwork::topology::Cage;

fn scheme(cage: &Cage) -> Scheme {
    let triangles = cage.descriptor().face_sizes.iter().all(|&n| n == 3);
    if triangles { Scheme::Loop(Variant::Loop, BoundaryRule::Reflect) } else { Scheme::default() }
}

fn quadratic(m: &formwork::sparse::Csr, x: &[f64]) -> f64 {
    apply(m, x).iter().zip(x).map(|(a, b)| a * b).sum()
}

/// One metric said in several ways is one metric; twice the size is known.
#[test]
fn a_metric_is_what_it_measures() {
    for solid in solids::all() {
        let surface = LimitSurface::new(&solid.cage, scheme(&solid.cage)).unwrap();
        let mesh = surface.hierarchy().level(0).mesh();
        let rules = Quadrature::new(surface.hierarchy().split_kind());
        let own = Elements::new(&surface, &solid.positions, &rules);
        let mapped = Elements::new(&surface, &solid.positions, &rules)
            .with_metric(Metric::mapped(|[x, y, z]| [z * 2.0, x * 2.0 + Taylor::constant(1.0), y * 2.0]));
        for degree in 0..3 {
            let factor = [4.0, 1.0, 0.25][degree];
            let x = random(mesh.num_cells(degree), 5);
            let [a, b] = [&own, &mapped].map(|e| quadratic(&e.mass(degree), &x));
            assert!((a * factor - b).abs() < EXACT * b.abs(), "{}, {degree}: {a} {b}", solid.name);
        }
        // What is inside and what is not make the whole.
        let even = Elements::new(&surface, &solid.positions, &rules).within(|face| face % 2 == 0);
        let odd = Elements::new(&surface, &solid.positions, &rules).within(|face| face % 2 == 1);
        assert!(even.is_inside(0) && !odd.is_inside(0));
        for degree in 0..3 {
            let x = random(mesh.num_cells(degree), 6);
            let [all, one, other] = [&own, &even, &odd].map(|e| quadratic(&e.mass(degree), &x));
            assert!((one + other - all).abs() < EXACT * all, "{}, {degree}", solid.name);
        }
        let areas = [&own, &even, &odd].map(|e| e.face_areas().into_values().iter().sum::<f64>());
        assert!((areas[0] - areas[1] - areas[2]).abs() < EXACT * areas[0]);
        let functions = even.vertex_areas().into_values().iter().sum::<f64>();
        assert!((functions - areas[1]).abs() < EXACT * areas[1]);
    }
}

/// The area of a sphere, from a cube pushed onto it: the better, the finer the cage.
#[test]
fn a_map_makes_a_sphere() {
    let (cube, corners) = solids::voxels([1, 1, 1], |_| true);
    let (cube, corners) = (
        Cage::new(cube).unwrap(),
        Cochain::new(corners.values().iter().map(|p| p.add_scalar(-0.5)).collect()),
    );
    let off = [1, 2].map(|levels| {
        let (cage, positions) = refined(&cube, scheme(&cube), &corners, levels);
        let surface = LimitSurface::new(&cage, scheme(&cage)).unwrap();
        let sphere = Metric::mapped(|p| {
            let r = (p[0] * p[0] + p[1] * p[1] + p[2] * p[2]).sqrt();
            p.map(|x| x / r)
        });
        let rules = Quadrature::new(surface.hierarchy().split_kind());
        let elements = Elements::new(&surface, &positions, &rules).with_metric(sphere);
        (elements.face_areas().into_values().iter().sum::<f64>() - 4.0 * PI).abs()
    });
    assert!(off[0] < 1e-3 && off[1] < 0.25 * off[0], "{off:?}");
}

/// A torus of revolution over its angles: as a tensor of each face, and as a chart of a strip of it.
#[test]
fn tensors_of_faces_and_charts() {
    let (n, m) = (20u32, 10u32);
    let ring = |v: Taylor| v.cos() * 0.4 + Taylor::constant(1.0);
    let area = TAU * TAU * 0.4;
    let cage = Cage::new(grid(n, m, true)).unwrap();
    let surface = LimitSurface::new(&cage, Scheme::default()).unwrap();
    assert_eq!(surface.hierarchy().num_levels(), 0);
    let mesh = surface.hierarchy().level(0).mesh();
    let origins: Vec<u32> = (0..n * m).map(|f| surface.face_origin(f)).collect();
    assert!(origins.iter().all(|&corner| corner == 0));
    let [du, dv] = [TAU / f64::from(n), TAU / f64::from(m)];
    let given = Metric::given(move |face, [_, t]| {
        let r = ring((t + Taylor::constant(f64::from(face / n))) * dv);
        [r * r * (du * du), Taylor::constant(0.0), Taylor::constant(0.16 * dv * dv)]
    });
    let flat = Cochain::new(vec![Vector3::zeros(); mesh.num_vertices()]);
    let torus =
        Elements::new(&surface, &flat, &Quadrature::new(surface.hierarchy().split_kind())).with_metric(given);
    let found: f64 = torus.face_areas().into_values().iter().sum();
    assert!((found - area).abs() < 1e-10, "{:e}", found - area);
    // A chart: the lattice, with one layer of faces around it that does not count.
    let cage = Cage::new(grid(n + 2, m + 2, false)).unwrap();
    let surface = LimitSurface::new(&cage, Scheme::default()).unwrap();
    let columns = n + 3;
    let place = |v: u32| {
        let (i, j) = (f64::from(v % columns) - 1.0, f64::from(v / columns) - 1.0);
        Vector3::new(i * du, j * dv, 0.0)
    };
    let positions = Cochain::new((0..columns * (m + 3)).map(place).collect());
    let chart = Metric::chart(move |[_, v]| {
        let r = ring(v);
        [r * r, Taylor::constant(0.0), Taylor::constant(0.16)]
    });
    let inside = |face: u32| {
        let (i, j) = (face % (n + 2), face / (n + 2));
        (1..=n).contains(&i) && (1..=m).contains(&j)
    };
    assert_eq!(surface.hierarchy().num_levels(), 0);
    let strip = Elements::new(&surface, &positions, &Quadrature::new(surface.hierarchy().split_kind()))
        .with_metric(chart)
        .within(inside);
    let found: f64 = strip.vertex_areas().into_values().iter().sum();
    assert!((found - area).abs() < 1e-10, "{:e}", found - area);
    // du has the length 1 / r: the integral of 1 / r^2 over the torus is 2 pi * int 0.4 / r dv.
    let du_form: Vec<f64> = {
        let x = positions.values();
        let mesh = surface.hierarchy().level(0).mesh();
        mesh.edges().iter().map(|&[a, b]| x[b as usize].x - x[a as usize].x).collect()
    };
    let energy = quadratic(&strip.mass(1), &du_form);
    let exact = TAU * 0.4 * TAU / (1.0f64 - 0.16).sqrt();
    assert!((energy - exact).abs() < 1e-6 * exact, "{energy} {exact}");
}
