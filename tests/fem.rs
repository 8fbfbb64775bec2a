//! Masses of the limit forms: exact values, what they sum to, and evaluation as a witness.

mod common;

use common::meshes::{grid, hexagonal_torus, polygons};
use common::solids::{self, Positions, refined, slab, triangles};
use common::{EXACT, random};
use formwork::cochain::Cochain;
use formwork::fem::{Elements, Quadrature, stiffness};
use formwork::limit::{LimitSurface, SurfacePoint};
use formwork::nalgebra::Vector3;
use formwork::scheme::{BoundaryRule, Scheme, Variant};
use formwork::sparse::{Csr, apply, row_of};
use formwork::topology::{Cage, Descriptor, SplitKind};

const LOOP: Scheme = Scheme::Loop(Variant::Loop, BoundaryRule::Reflect);

fn scheme(cage: &Cage) -> Scheme {
    if cage.descriptor().face_sizes.iter().all(|&n| n == 3) { LOOP } else { Scheme::default() }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

fn entry(matrix: &Csr, i: usize, j: u32) -> f64 {
    let (columns, entries) = row_of(matrix, i);
    columns.iter().position(|&c| c == j).map_or(0.0, |at| entries[at])
}

fn elements<'a>(surface: &'a LimitSurface, positions: &Positions) -> Elements<'a> {
    Elements::new(surface, positions, &Quadrature::new(surface.hierarchy().split_kind()))
}

/// On a flat lattice of unit cells the entries are those of cardinal splines.
#[test]
fn flat_lattices_have_the_exact_masses() {
    let quads = grid(9, 9, false);
    let flat = |at: &dyn Fn(f64, f64) -> [f64; 2], d: &Descriptor| {
        let point = |v: usize| {
            let [x, y] = at((v % 10) as f64, (v / 10) as f64);
            Vector3::new(x, y, 0.0)
        };
        Cochain::new((0..d.num_vertices).map(point).collect::<Vec<_>>())
    };
    // The cells cut from (1, 0) to (0, 1); with x = i + j, y = j its edges are (1, 0), (1, 1) and (0, 1).
    let halves =
        quads.face_vertices.chunks_exact(4).flat_map(|c| [vec![c[0], c[1], c[3]], vec![c[1], c[2], c[3]]]);
    let cut = polygons(quads.num_vertices, &halves.collect::<Vec<_>>());
    let along = |from: [u32; 2], step: [i32; 2]| {
        let at = |[i, j]: [u32; 2]| i + 10 * j;
        [at(from), at([from[0].wrapping_add_signed(step[0]), from[1].wrapping_add_signed(step[1])])]
    };
    type Case<'a> = (&'a Descriptor, &'a dyn Fn(f64, f64) -> [f64; 2], [i32; 2], f64, Option<[f64; 3]>);
    // int B3^2, int B2^2, int B3'^2
    let [cubic, quadratic, slope] = [2416.0 / 5040.0, 66.0 / 120.0, 2.0 / 3.0];
    let splines = Some([cubic * cubic, 2.0 * slope * cubic, quadratic * slope]);
    let cases: [Case<'_>; 5] = [
        (&quads, &|x, y| [x, y], [1, 0], cubic * quadratic, splines),
        (&quads, &|x, y| [x, y], [0, 1], cubic * quadratic, splines),
        (&cut, &|x, y| [x + y, y], [1, 0], 0.192_797_62, None),
        (&cut, &|x, y| [x + y, y], [-1, 1], 0.192_797_62, None),
        (&cut, &|x, y| [x + y, y], [0, 1], 0.077_380_95, None),
    ];
    for (d, place, step, diagonal, exact) in cases {
        let (cage, positions) = (Cage::new(d.clone()).unwrap(), flat(place, d));
        let surface = LimitSurface::new(&cage, scheme(&cage)).unwrap();
        let elements = elements(&surface, &positions);
        let mesh = surface.hierarchy().level(0).mesh();
        let [a, b] = along([4, 4], step);
        let e = mesh.find_half_edge(a, b).unwrap().edge();
        let m1 = elements.mass(1);
        assert!(
            (entry(&m1, e as usize, e) - diagonal).abs() < 1e-8,
            "{step:?}: {}",
            entry(&m1, e as usize, e)
        );
        if let Some([function, energy, curl]) = exact {
            // Integrals of products of cardinal B-splines and of their derivatives.
            let v = a as usize;
            let [m0, k0] = [elements.mass(0), stiffness(&m1, &mesh.d0())].map(|m| entry(&m, v, a));
            let k1 = entry(&stiffness(&elements.mass(2), &mesh.d1()), e as usize, e);
            let near = |x: f64, y: f64| assert!((x - y).abs() < EXACT, "{x} {y}");
            near(m0, function);
            near(k0, energy);
            near(k1, curl);
        }
        // Twice the size: M0 grows with the area, M1 stays, M2 shrinks.
        let double =
            Elements::new(&surface, &(positions * 2.0), &Quadrature::new(surface.hierarchy().split_kind()));
        for (degree, factor) in [(0, 4.0), (1, 1.0), (2, 0.25)] {
            let (one, two) = (elements.mass(degree), double.mass(degree));
            let worst =
                (0..one.rows()).map(|i| (entry(&one, i, i as u32) * factor - entry(&two, i, i as u32)).abs());
            assert!(worst.fold(0.0, f64::max) < EXACT * factor);
        }
    }
}

/// `sum_k |grad x_k|^2 = 2` at every point of a surface, and functions and 2-forms of areas sum to areas.
#[test]
fn masses_sum_to_areas() {
    for solid in solids::all() {
        let surface = LimitSurface::new(&solid.cage, scheme(&solid.cage)).unwrap();
        let elements = elements(&surface, &solid.positions);
        let mesh = surface.hierarchy().level(0).mesh();
        let (m0, m1) = (elements.mass(0), elements.mass(1));
        let (vertices, faces) = (elements.vertex_areas().into_values(), elements.face_areas().into_values());
        let area: f64 = faces.iter().sum();
        assert!((vertices.iter().sum::<f64>() - area).abs() < EXACT * area, "{}", solid.name);
        let ones = vec![1.0; mesh.num_vertices()];
        let off = apply(&m0, &ones).iter().zip(&vertices).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off < EXACT * area, "{}: {off:e}", solid.name);
        let dirichlet: f64 = (0..3)
            .map(|k| {
                let x: Cochain<0> = Cochain::new(solid.positions.values().iter().map(|p| p[k]).collect());
                let dx = x.exterior_derivative(mesh).into_values();
                dot(&dx, &apply(&m1, &dx))
            })
            .sum();
        assert!((dirichlet - 2.0 * area).abs() < 1e-11 * area, "{}: {dirichlet} {area}", solid.name);
        for (k, m) in [m0, m1, elements.mass(2)].iter().enumerate() {
            assert!(
                (0..m.rows()).all(|i| row_of(m, i).0.iter().all(|&j| {
                    (entry(m, i, j) - entry(m, j as usize, i as u32)).abs() <= 1e-13 * entry(m, i, i as u32)
                })),
                "{}: M{k}",
                solid.name
            );
        }
    }
}

/// The area of a sphere is known, and so is how fast cages come near it.
#[test]
fn weights_beside_irregular_vertices_sum_up() {
    for d in [slab(2).0, triangles(&slab(2).0)] {
        let cage = Cage::new(d).unwrap();
        let surface = LimitSurface::new(&cage, scheme(&cage)).unwrap();
        let kind = surface.hierarchy().split_kind();
        let faces = 0..surface.hierarchy().finest().mesh().num_faces() as u32;
        let rules = Quadrature::new(kind);
        for number in faces.map(|face| surface.face_basis(face)) {
            let points = surface.basis(number, rules.rules());
            let sum: f64 = points.iter().map(|p| p.weight).sum();
            assert!((sum - if kind == SplitKind::Quad { 1.0 } else { 0.5 }).abs() < EXACT);
            for p in &points {
                let unity: f64 = p.forms0.iter().map(|x| x[0]).sum();
                let slope = p.forms0.iter().map(|x| x[1]).sum::<f64>().abs();
                assert!((unity - 1.0).abs() < EXACT && slope < 1e-9, "{unity} {slope}");
            }
        }
    }
}

/// `c' M c` is the sum, over the points of the rule, of what evaluation says there.
#[test]
fn masses_agree_with_evaluation() {
    let flat = grid(4, 3, false);
    let hills: Vec<Vector3<f64>> = (0..flat.num_vertices)
        .map(|v| Vector3::new((v % 5) as f64, (v / 5) as f64, (v as f64 * 1.7).sin()))
        .collect();
    let genus = |d: Descriptor, positions: Positions| {
        let cage = Cage::new(d).unwrap();
        refined(&cage, scheme(&cage), &positions, 1)
    };
    let (quads, corners) = slab(1);
    let cases = [
        (Cage::new(flat).unwrap(), Cochain::new(hills)),
        genus(quads.clone(), corners.clone()),
        genus(triangles(&quads), corners),
    ];
    for (cage, positions) in cases {
        let surface = LimitSurface::new(&cage, scheme(&cage)).unwrap();
        assert_eq!(surface.hierarchy().num_levels(), 0);
        let (mesh, kind) = (surface.hierarchy().level(0).mesh(), surface.hierarchy().split_kind());
        let rules = Quadrature::new(kind);
        let elements = Elements::new(&surface, &positions, &rules);
        let forms = [mesh.num_vertices(), mesh.num_edges(), mesh.num_faces()].map(|n| random(n, 7));
        let (mut points, mut weights) = (Vec::new(), Vec::new());
        for face in 0..mesh.num_faces() as u32 {
            for point in surface.basis(surface.face_basis(face), rules.rules()) {
                let ([s, t], corner) = (point.point, surface.face_origin(face));
                points.push(SurfacePoint { face, corner, s, t });
                weights.push(point.weight);
            }
        }
        let functions = surface.evaluate_0(&Cochain::new(forms[0].clone()), &points).unwrap();
        let vectors = surface.evaluate_vectors(&positions, &Cochain::new(forms[1].clone()), &points).unwrap();
        let densities = surface.evaluate_2(&Cochain::new(forms[2].clone()), &points).unwrap();
        let mut sums = [0.0; 3];
        for i in 0..points.len() {
            let [a, b] = vectors[i].position.derivatives;
            let area = a.cross(&b).norm();
            sums[0] += weights[i] * area * functions[i].value * functions[i].value;
            sums[1] += weights[i] * area * vectors[i].vector.norm_squared();
            sums[2] += weights[i] / area * densities[i] * densities[i];
        }
        for k in 0..3 {
            let energy = dot(&forms[k], &apply(&elements.mass(k), &forms[k]));
            assert!((energy - sums[k]).abs() < 1e-10 * energy, "{k}: {energy} {}", sums[k]);
        }
    }
}

/// Functionals at points are evaluation, transposed.
#[test]
fn functionals_agree_with_evaluation() {
    for solid in solids::all().into_iter().filter(|s| s.genus == 2) {
        let surface = LimitSurface::new(&solid.cage, scheme(&solid.cage)).unwrap();
        let fine = surface.hierarchy().finest().mesh();
        let c: Cochain<1> = Cochain::new(random(fine.num_edges(), 3));
        let x: Cochain<0> = Cochain::new(random(fine.num_vertices(), 4));
        let w: Cochain<2> = Cochain::new(random(fine.num_faces(), 5));
        let faces = surface.hierarchy().level(0).mesh().num_faces() as u32;
        for face in (0..faces).step_by(3) {
            for [s, t] in [[0.3, 0.4], [1e-4, 2e-3], [0.6, 0.2], [0.0, 0.0]] {
                let point = SurfacePoint { face, corner: face % 3, s, t };
                let sum = |degree: usize, values: &[f64]| {
                    let weights = surface.functional(degree, &point).unwrap();
                    weights
                        .iter()
                        .fold([0.0; 2], |sum, (i, w)| [0, 1].map(|k| sum[k] + w[k] * values[*i as usize]))
                };
                let near = |a: f64, b: f64| {
                    assert!((a - b).abs() < 1e-9 * (1.0 + b.abs()), "{}: {a} {b}", solid.name)
                };
                near(sum(0, x.values())[0], surface.evaluate_0(&x, &[point]).unwrap()[0].value);
                let components = surface.evaluate_1(&c, &[point]).unwrap()[0];
                (0..2).for_each(|k| near(sum(1, c.values())[k], components[k].value));
                if s > 0.0 {
                    near(sum(2, w.values())[0], surface.evaluate_2(&w, &[point]).unwrap()[0]);
                }
            }
        }
    }
}

/// The relations between quartic edge splines: `1, 1, -1` along the three directions is the form 0.
#[test]
fn regular_triangles_have_one_relation() {
    let d = hexagonal_torus(6, 5);
    let cage = Cage::new(d).unwrap();
    let surface = LimitSurface::new(&cage, LOOP).unwrap();
    let turn = std::f64::consts::TAU;
    let ring = |v: usize| {
        let (a, b) = (turn * (v % 6) as f64 / 6.0, turn * (v / 6) as f64 / 5.0);
        Vector3::new((3.0 + b.cos()) * a.cos(), (3.0 + b.cos()) * a.sin(), b.sin())
    };
    let positions: Positions = Cochain::new((0..30).map(ring).collect());
    let elements = elements(&surface, &positions);
    let mesh = surface.hierarchy().level(0).mesh();
    let value = |&[a, b]: &[u32; 2]| {
        // Steps (1, 0) and (-1, 1) and their sum (0, 1), whatever the direction of the edge.
        let step = [(b % 6 + 6 - a % 6) % 6, (b / 6 + 5 - a / 6) % 5];
        match step {
            [1, 0] | [5, 1] | [0, 4] => 1.0,
            [5, 0] | [1, 4] | [0, 1] => -1.0,
            _ => panic!("no edge of the lattice: {step:?}"),
        }
    };
    let relation: Vec<f64> = mesh.edges().iter().map(value).collect();
    let m1 = elements.mass(1);
    let image = apply(&m1, &relation);
    assert!(image.iter().all(|x| x.abs() < 1e-13), "{:e}", image.iter().fold(0.0f64, |a, b| a.max(b.abs())));
    // It is not closed, so closed forms are seen by M1.
    let curl = Cochain::<1>::new(relation).exterior_derivative(mesh);
    assert!(curl.values().iter().all(|x| (x.abs() - 3.0).abs() < 1e-15));
    let image = apply(&elements.mass(2), curl.values());
    assert!(image.iter().all(|x| x.abs() < 1e-11));
}
