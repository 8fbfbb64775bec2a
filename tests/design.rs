//! Designed fields: features are where they were put, and nowhere else.

mod common;

use common::random;
use common::solids::{self, Solid};
use formwork::cochain::Cochain;
use formwork::design::{
    Condition, DesignError, EdgeValue, End, Hodge, Metric, Place, Source, Spec, Tracing, VectorAt, Vortex,
    seeds, singularities, streamlines,
};
use formwork::fem::{gauss, square};
use formwork::limit::{Limit, LimitSurface, SurfacePoint};
use formwork::nalgebra::Vector3;
use formwork::scheme::{BoundaryRule, Scheme, Variant};
use formwork::sparse::{apply, row_of};
use formwork::topology::Cage;

fn scheme(cage: &Cage) -> Scheme {
    match cage.descriptor().face_sizes.iter().all(|&n| n == 3) {
        true => Scheme::Loop(Variant::Loop, BoundaryRule::Reflect),
        false => Scheme::default(),
    }
}

fn find(name: &str) -> Solid {
    solids::all().into_iter().find(|s| s.name == name).unwrap()
}

fn surface(solid: &Solid) -> LimitSurface {
    LimitSurface::new(&solid.cage, scheme(&solid.cage)).unwrap()
}

fn source(vertex: u32, strength: f64) -> Source {
    Source { place: Place::Cell(vertex), strength }
}

fn vortex(face: u32, strength: f64) -> Vortex {
    Vortex { place: Place::Cell(face), strength }
}

fn pair(solid: &Solid) -> Spec {
    let (v, f) = (solid.positions.len() as u32, solid.cage.descriptor().face_sizes.len() as u32);
    Spec {
        sources: vec![source(1, 2.0), source(v - 1, -2.0)],
        vortices: vec![vortex(3, 1.5), vortex(f - 2, -1.5)],
        ..Spec::default()
    }
}

/// The divergence tested with each vertex's function, the curl of each face and the circulations are the data.
#[test]
fn features_are_where_they_were_put() {
    for solid in solids::all() {
        for metric in [Metric::Limit, Metric::ControlMesh] {
            let surface = surface(&solid);
            let hodge = Hodge::new(&surface, &solid.positions, metric, &[]).unwrap();
            let mut spec = pair(&solid);
            let wanted = random(solid.betti(), 8);
            spec.harmonic = wanted.iter().copied().enumerate().collect();
            let field = hodge.design(&spec).unwrap();
            // A source's divergence is the function of its vertex: tested with the others, a column of M0.
            let mut densities = vec![0.0; solid.positions.len()];
            spec.sources.iter().for_each(|s| match s.place {
                Place::Cell(v) => {
                    densities[v as usize] += s.strength / hodge.product().vertex_areas[v as usize]
                }
                Place::At(_) => unreachable!(),
            });
            let divergence = apply(&hodge.product().vertex_mass, &densities);
            assert!(divergence.iter().sum::<f64>().abs() < 1e-12);
            let found = hodge.weak_codifferential(&field.cochain);
            let off = found.values().iter().zip(&divergence).map(|(a, b)| (a + b).abs()).fold(0.0, f64::max);
            assert!(off < 1e-11, "{}, {metric:?}: divergence off by {off:e}", solid.name);
            let mut curl = vec![0.0; solid.cage.descriptor().face_sizes.len()];
            spec.vortices.iter().for_each(|s| match s.place {
                Place::Cell(f) => curl[f as usize] += s.strength,
                Place::At(_) => unreachable!(),
            });
            let off = field.curl.values().iter().zip(&curl).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < 1e-11, "{}: curl off by {off:e}", solid.name);
            let parts = hodge.decompose(&field.cochain);
            let off = parts.circulations.iter().zip(&wanted).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < 1e-10, "{}: circulations off by {off:e}", solid.name);
        }
    }
}

/// The same by quadrature of what evaluation says, which shares nothing with the masses: `int V . grad phi` is minus the
/// divergence put at a vertex, and the integral of the curl over a limit face is `L2` of the curl put on faces.
#[test]
fn quadrature_finds_the_data() {
    let solid = find("genus 1, quads");
    let (cage, positions) = solids::refined(&solid.cage, Scheme::default(), &solid.positions, 2);
    let surface = LimitSurface::new(&cage, Scheme::default()).unwrap();
    assert_eq!(surface.hierarchy().num_levels(), 0);
    let hodge = Hodge::new(&surface, &positions, Metric::Limit, &[]).unwrap();
    let mesh = hodge.mesh();
    let spec = Spec {
        sources: vec![source(5, 1.0), source(200, -1.0)],
        vortices: vec![vortex(100, 1.0), vortex(400, -1.0)],
        ..Spec::default()
    };
    let field = hodge.design(&spec).unwrap();
    let line = gauss(6);
    assert_eq!(square(6).len(), line.len() * line.len());
    let (mut points, mut weights) = (Vec::new(), Vec::new());
    for face in 0..mesh.num_faces() as u32 {
        // In quarters: next to irregular vertices the forms are no polynomials.
        for ([s, t], weight) in square(6) {
            for (i, j) in [(0.0, 0.0), (0.5, 0.0), (0.0, 0.5), (0.5, 0.5)] {
                points.push(SurfacePoint { face, corner: 0, s: i + s / 2.0, t: j + t / 2.0 });
                weights.push(weight / 4.0);
            }
        }
    }
    let vectors = surface.evaluate_vectors(&positions, &field.cochain, &points).unwrap();
    for v in [5usize, 200, 60, 300] {
        let mut unit = Cochain::<0>::zeros(mesh.num_vertices());
        unit[v] = 1.0;
        let gradients =
            surface.evaluate_vectors(&positions, &unit.exterior_derivative(mesh), &points).unwrap();
        let sum: f64 = (0..points.len())
            .map(|i| {
                let [a, b] = vectors[i].position.derivatives;
                weights[i] * a.cross(&b).norm() * vectors[i].vector.dot(&gradients[i].vector)
            })
            .sum();
        let expected = -field.divergence[v];
        assert!((sum - expected).abs() < 2e-4, "{v}: {sum} {expected}");
    }
    let curls = surface.evaluate_1(&field.cochain, &points).unwrap();
    let limit = Limit::new(surface.hierarchy(), 0).unwrap().apply(mesh, &field.curl);
    let per_face = points.len() / mesh.num_faces();
    for face in [100, 400, 99, 250] {
        let range = face * per_face..(face + 1) * per_face;
        let sum: f64 =
            range.map(|i| weights[i] * (curls[i][1].derivatives[0] - curls[i][0].derivatives[1])).sum();
        assert!((sum - limit[face]).abs() < 1e-3, "{face}: {sum} {}", limit[face]);
    }
    assert!(limit[100] > 0.3 && limit[250].abs() < 1e-12);
}

/// Sources at points share themselves out, prescribed values are met, soft ones nearly.
#[test]
fn prescribed_values_are_met() {
    for name in ["genus 0, quads", "genus 2, triangles", "annulus, quads", "genus 1, quads"] {
        let solid = find(name);
        let surface = surface(&solid);
        for metric in [Metric::Limit, Metric::ControlMesh] {
            let hodge = Hodge::new(&surface, &solid.positions, metric, &[]).unwrap();
            let mesh = hodge.mesh();
            let point = SurfacePoint { face: 2, corner: 0, s: 0.3, t: 0.4 };
            let far = SurfacePoint { face: 9, corner: 1, s: 0.2, t: 0.2 };
            let [a, b] = mesh.edges()[20];
            let wanted = Vector3::new(0.3, 0.7, -0.2);
            let mut spec = pair(&solid);
            spec.sources.push(Source { place: Place::At(point), strength: 0.5 });
            spec.sources.push(Source { place: Place::At(far), strength: -0.5 });
            spec.vortices.push(Vortex { place: Place::At(point), strength: 0.5 });
            spec.vortices.push(Vortex { place: Place::At(far), strength: -0.5 });
            spec.vectors = vec![VectorAt { point, vector: wanted, weight: None }];
            spec.edges = vec![EdgeValue { vertices: [b, a], value: 0.25, weight: None }];
            let field = hodge.design(&spec).unwrap();
            assert!(field.miss < 1e-9, "{name}: {:e}", field.miss);
            let form = surface.refine(&field.cochain);
            let found = surface.evaluate_vectors(hodge.positions(), &form, &[point]).unwrap()[0];
            let [t, u] = found.position.derivatives;
            let normal = t.cross(&u).normalize();
            let tangential = wanted - normal * normal.dot(&wanted);
            assert!((found.vector - tangential).norm() < 1e-9, "{name}: {} {tangential}", found.vector);
            let limit = Limit::new(surface.hierarchy(), 0).unwrap().apply(mesh, &field.cochain);
            let along = if metric == Metric::Limit { limit[20] } else { field.cochain[20] };
            assert!((along + 0.25).abs() < 1e-9, "{name}: {along}");
            // What is reported is what the field has.
            let codifferential = hodge.weak_codifferential(&field.cochain);
            let off = (0..mesh.num_vertices()).map(|v| (codifferential[v] + field.divergence[v]).abs());
            assert!(off.fold(0.0, f64::max) < 1e-9);
            // A weight lets go, the more the less it is, where no harmonic field comes for free.
            spec.harmonic = (0..solid.betti()).map(|i| (i, 0.0)).collect();
            let miss = |weight: f64| {
                let mut spec = spec.clone();
                spec.edges[0].weight = Some(weight);
                let field = hodge.design(&spec).unwrap();
                let limit = Limit::new(surface.hierarchy(), 0).unwrap().apply(mesh, &field.cochain);
                ((if metric == Metric::Limit { limit[20] } else { field.cochain[20] }) + 0.25).abs()
            };
            let misses = [1e6, 1.0, 1e-3].map(miss);
            assert!(misses[0] < 1e-3 && misses[0] < misses[1] && misses[1] < misses[2], "{name}: {misses:?}");
        }
    }
}

/// What prescribed values add is the least that does it: any other data with the same effect costs more.
#[test]
fn prescribed_values_cost_least() {
    let solid = find("genus 0, quads");
    let surface = surface(&solid);
    let hodge = Hodge::new(&surface, &solid.positions, Metric::Limit, &[]).unwrap();
    let areas = hodge.product();
    let cost = |field: &formwork::design::Field| {
        let of = |x: &[f64], a: &[f64]| x.iter().zip(a).map(|(x, a)| x * x / a).sum::<f64>();
        of(field.divergence.values(), &areas.vertex_areas) + of(field.curl.values(), &areas.face_areas)
    };
    let at = |face: u32| SurfacePoint { face, corner: 0, s: 0.5, t: 0.4 };
    let vector =
        |face: u32, x: [f64; 3]| VectorAt { point: at(face), vector: Vector3::from(x), weight: None };
    let wanted = Spec { vectors: vec![vector(0, [0.1, 1.0, 0.3])], ..Spec::default() };
    let field = hodge.design(&wanted).unwrap();
    let least = cost(&field);
    assert!(least > 0.0);
    // The same wish, on top of some data of another kind: never cheaper.
    for seed in 0..10 {
        let x = random(4, seed);
        let mut other = wanted.clone();
        other.sources = vec![source(0, 0.01 * x[0]), source(7, -0.01 * x[0])];
        other.vortices = vec![vortex(1, 0.01 * x[1]), vortex(4, -0.01 * x[1])];
        assert!(cost(&hodge.design(&other).unwrap()) >= least * (1.0 - 1e-12));
    }
    // Twice the weight everywhere changes nothing.
    let mut heavy = wanted.clone();
    let faces = (0..14).collect();
    heavy.regions = vec![formwork::design::Region { faces, weight: 2.0 }];
    let same = hodge.design(&heavy).unwrap();
    let off =
        (field.cochain.clone() + same.cochain * -1.0).values().iter().fold(0.0f64, |m, x| m.max(x.abs()));
    assert!(off < 1e-10, "{off:e}");
    heavy.regions[0].faces = vec![1, 2];
    let other = hodge.design(&heavy).unwrap();
    let off = (field.cochain + other.cochain * -1.0).values().iter().fold(0.0f64, |m, x| m.max(x.abs()));
    assert!(off > 1e-4, "a region makes a difference");
}

#[test]
fn data_that_do_not_balance_are_refused_or_balanced() {
    let solid = find("genus 0, quads");
    let surface = surface(&solid);
    let hodge = Hodge::new(&surface, &solid.positions, Metric::Limit, &[]).unwrap();
    let mut spec = Spec { sources: vec![source(2, 0.75)], ..Spec::default() };
    match hodge.design(&spec).unwrap_err() {
        DesignError::Unbalanced { what, sum, .. } => assert_eq!((what, sum), ("sources", 0.75)),
        other => panic!("{other}"),
    }
    spec.balance = true;
    let field = hodge.design(&spec).unwrap();
    assert_eq!(field.balanced, [0.75, 0.0]);
    let found = hodge.weak_codifferential(&field.cochain);
    let area: f64 = hodge.product().vertex_areas.iter().sum();
    let product = hodge.product();
    for v in 0..solid.positions.len() {
        let (columns, entries) = row_of(&product.vertex_mass, v);
        let at_2 = columns.iter().position(|&c| c == 2).map_or(0.0, |i| entries[i] / product.vertex_areas[2]);
        let expected = 0.75 * (at_2 - product.vertex_areas[v] / area);
        assert!((found[v] + expected).abs() < 1e-12, "{v}");
    }
    let spec = Spec { vortices: vec![vortex(2, 0.5), vortex(3, 0.25)], ..Spec::default() };
    let message = hodge.design(&spec).unwrap_err().to_string();
    assert!(
        message.contains("vortices") && message.contains("0.75") && message.contains("balance"),
        "{message}"
    );
    // A disc lets curl out through a tangential boundary, and sources through a normal one.
    let disc = find("disc, quads");
    let disc_surface = self::surface(&disc);
    let hodge = Hodge::new(&disc_surface, &disc.positions, Metric::Limit, &[]).unwrap();
    assert!(hodge.design(&Spec { vortices: vec![vortex(1, 1.0)], ..Spec::default() }).is_ok());
    assert!(hodge.design(&Spec { sources: vec![source(1, 1.0)], ..Spec::default() }).is_err());
    let hodge = Hodge::new(&disc_surface, &disc.positions, Metric::Limit, &[Condition::Normal]).unwrap();
    assert!(hodge.design(&Spec { vortices: vec![vortex(1, 1.0)], ..Spec::default() }).is_err());
    let field = hodge.design(&Spec { sources: vec![source(1, 1.0)], ..Spec::default() }).unwrap();
    for &h in &hodge.homology().loops()[0] {
        assert_eq!(field.cochain.along(h), 0.0, "normal at the boundary");
    }
}

#[test]
fn bad_specs_are_refused_by_name() {
    let solid = find("genus 1, quads");
    let surface = surface(&solid);
    let hodge = Hodge::new(&surface, &solid.positions, Metric::Limit, &[]).unwrap();
    let refuse = |spec: Spec, words: &str| {
        let message = hodge.design(&spec).unwrap_err().to_string();
        assert!(message.contains(words), "{message}");
    };
    refuse(Spec { sources: vec![source(999, 1.0)], ..Spec::default() }, "no vertex 999");
    refuse(Spec { vortices: vec![vortex(999, 1.0)], ..Spec::default() }, "no face 999");
    refuse(Spec { sources: vec![source(0, f64::NAN)], ..Spec::default() }, "source 0");
    refuse(Spec { harmonic: vec![(2, 1.0)], ..Spec::default() }, "generator 2");
    let edge = |vertices, value| EdgeValue { vertices, value, weight: None };
    let [a, b] = hodge.mesh().edges()[0];
    refuse(Spec { edges: vec![edge([a, a], 1.0)], ..Spec::default() }, "share no edge");
    refuse(Spec { edges: vec![edge([a, b], 1.0), edge([b, a], 1.0)], ..Spec::default() }, "contradict");
    hodge.design(&Spec { edges: vec![edge([a, b], 1.0), edge([b, a], -1.0)], ..Spec::default() }).unwrap();
    let outside = SurfacePoint { face: 0, corner: 0, s: 2.0, t: 0.0 };
    refuse(
        Spec { sources: vec![Source { place: Place::At(outside), strength: 1.0 }], ..Spec::default() },
        "outside",
    );
    assert!(Hodge::new(&surface, &solid.positions, Metric::Limit, &[Condition::Normal]).is_err());
}

/// Poincare and Hopf, and every zero is one.
#[test]
fn indices_sum_to_the_euler_characteristic() {
    let mut checked = 0;
    for solid in solids::all().into_iter() {
        let surface = surface(&solid);
        let hodge = Hodge::new(&surface, &solid.positions, Metric::Limit, &[]).unwrap();
        let field = hodge.design(&pair(&solid)).unwrap();
        let found = singularities(&surface, &solid.positions, &field.cochain, 4).unwrap();
        assert_eq!(found.euler, solid.euler(), "{}", solid.name);
        assert!(
            found.holds(),
            "{}: {} {} {}",
            solid.name,
            found.index_sum,
            found.euler,
            found.boundary_turns
        );
        let inside = found.zeros.iter().filter(|zero| zero.residual < 1e-7 * found.largest).count();
        assert!(
            inside * 10 >= found.zeros.len() * 9,
            "{}: {inside} of {}: {:?}",
            solid.name,
            found.zeros.len(),
            found.zeros
        );
        assert!(found.zeros.iter().any(|zero| zero.index == 1), "{}", solid.name);
        checked += 1;
    }
    assert!(checked >= 10);
}

/// A source and a sink at the poles of a refined cube, both zeros of index 1, at the poles.
#[test]
fn zeros_are_where_sources_are() {
    let cube = find("genus 0, triangles");
    for (cage, positions) in [(cube.cage.clone(), cube.positions.clone())] {
        let (d, positions) = (cage, positions);
        let (cage, positions) = solids::refined(&d, scheme(&d), &positions, 3);
        let surface = LimitSurface::new(&cage, scheme(&cage)).unwrap();
        let hodge = Hodge::new(&surface, &positions, Metric::Limit, &[]).unwrap();
        let spec = Spec { sources: vec![source(0, 1.0), source(7, -1.0)], ..Spec::default() };
        let field = hodge.design(&spec).unwrap();
        let found = singularities(&surface, &positions, &field.cochain, 1).unwrap();
        assert_eq!(found.zeros.iter().map(|z| z.index).collect::<Vec<_>>(), [1, 1], "{:?}", found.zeros);
        let limit = Limit::new(surface.hierarchy(), 0).unwrap().apply(hodge.mesh(), &positions);
        for v in [0, 7] {
            let nearest = found.zeros.iter().map(|z| (z.position - limit[v]).norm()).fold(f64::MAX, f64::min);
            assert!(nearest < 0.03, "{v}: {nearest}");
        }
    }
}

/// Lines of the field `(-y, x)` on a flat sheet are circles, to the fourth order of the step.
#[test]
fn streamlines_follow_the_field() {
    let n = 8u32;
    let d = common::meshes::grid(n, n, false);
    let point = |v: u32| Vector3::new(f64::from(v % (n + 1)) - 4.0, f64::from(v / (n + 1)) - 4.0, 0.0);
    let positions = Cochain::new((0..(n + 1) * (n + 1)).map(point).collect::<Vec<_>>());
    let cage = Cage::new(d).unwrap();
    let surface = LimitSurface::new(&cage, Scheme::default()).unwrap();
    let mesh = surface.hierarchy().level(0).mesh();
    // Circulations of (-y, x) along straight edges; B-splines reproduce linear forms.
    let along = |&[a, b]: &[u32; 2]| {
        let (a, b) = (positions[a as usize], positions[b as usize]);
        let m = (a + b) / 2.0;
        Vector3::new(-m.y, m.x, 0.0).dot(&(b - a))
    };
    let form: Cochain<1> = Cochain::new(mesh.edges().iter().map(along).collect());
    let seed = SurfacePoint { face: 36, corner: 0, s: 0.9, t: 0.3 };
    let radius_of = |p: &Vector3<f64>| (p.x * p.x + p.y * p.y).sqrt();
    let mut errors = Vec::new();
    for step in [0.2, 0.1] {
        let tracing = Tracing { step, length: 4.0, both_ways: true, least: 1e-9 };
        let lines = streamlines(&surface, &positions, &form, &[seed], &tracing).unwrap();
        let line = &lines[0];
        assert_eq!(line.points.len(), line.positions.len());
        let radius = radius_of(&line.positions[line.seed]);
        errors.push(line.positions.iter().map(|p| (radius_of(p) - radius).abs()).fold(0.0, f64::max));
        let length: f64 = line.positions.windows(2).map(|p| (p[1] - p[0]).norm()).sum();
        assert!((length - 8.0).abs() < 0.3 || line.ends[1] == End::Closed, "{length}");
        // They turn counter-clockwise.
        let [p, q] = [line.positions[0], line.positions[1]];
        assert!(p.x * q.y - p.y * q.x > 0.0);
    }
    assert!(errors[1] < errors[0] / 10.0 && errors[0] < 1e-3, "{errors:?}");
    let tracing = Tracing { step: 0.1, length: 50.0, both_ways: true, least: 1e-9 };
    let lines = streamlines(&surface, &positions, &form, &[seed], &tracing).unwrap();
    assert_eq!(lines[0].ends[1], End::Closed);
    // A constant field runs into the boundary, and is there to rounding.
    let form: Cochain<1> = Cochain::new(
        mesh.edges().iter().map(|&[a, b]| positions[b as usize].x - positions[a as usize].x).collect(),
    );
    let lines = streamlines(&surface, &positions, &form, &[seed], &tracing).unwrap();
    assert_eq!(lines[0].ends, [End::Boundary; 2]);
    let (first, last) = (lines[0].positions[0], lines[0].positions[lines[0].positions.len() - 1]);
    assert!((last - first - Vector3::new(8.0, 0.0, 0.0)).norm() < 1e-9, "{first} {last}");
}

/// Lines cross from face to face on any surface, and seeds are spread by area.
#[test]
fn streamlines_stay_on_the_surface() {
    for name in ["genus 2, quads", "genus 1, triangles", "torus with a hole, quads"] {
        let solid = find(name);
        let surface = surface(&solid);
        let hodge = Hodge::new(&surface, &solid.positions, Metric::Limit, &[]).unwrap();
        let mut circulations = vec![0.0; solid.betti()];
        circulations[0] = 1.0;
        let field = hodge.harmonic(&circulations);
        let seeds = seeds(&surface, &solid.positions, 40);
        let tracing = Tracing { step: 0.02, length: 3.0, both_ways: false, least: 1e-6 };
        let lines = streamlines(&surface, &solid.positions, &field, &seeds, &tracing).unwrap();
        let whole = lines.iter().filter(|line| line.ends[1] == End::Length).count();
        assert!(whole > 30, "{name}: {whole}");
        for line in &lines {
            let jets = surface.evaluate_0(hodge.positions(), &line.points).unwrap();
            for (jet, position) in jets.iter().zip(&line.positions) {
                assert!((jet.value - position).norm() < 1e-9, "{name}");
            }
            let worst = line.positions.windows(2).map(|p| (p[1] - p[0]).norm()).fold(0.0, f64::max);
            assert!(worst < 0.02 * 1.05, "{name}: a step of {worst}");
        }
    }
}
