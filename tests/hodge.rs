//! Hodge decomposition: exact orthogonality, cohomology of the right dimension, harmonic fields.

mod common;

use common::random;
use common::solids::{self, Solid};
use formwork::cochain::Cochain;
use formwork::design::{Condition, Hodge, Homology, Metric};
use formwork::limit::LimitSurface;
use formwork::scheme::{BoundaryRule, Scheme, Variant};
use formwork::sparse::apply;
use formwork::topology::{Cage, HalfEdge};

pub fn scheme(cage: &Cage) -> Scheme {
    match cage.descriptor().face_sizes.iter().all(|&n| n == 3) {
        true => Scheme::Loop(Variant::Loop, BoundaryRule::Reflect),
        false => Scheme::default(),
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

fn largest(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |m, x| m.max(x.abs()))
}

/// The laws of a decomposition, to rounding; the dimension of the harmonic space is `betti`.
fn check(solid: &Solid, metric: Metric, conditions: &[Condition], betti: usize) -> [f64; 4] {
    let surface = LimitSurface::new(&solid.cage, scheme(&solid.cage)).unwrap();
    let hodge = Hodge::new(&surface, &solid.positions, metric, conditions).unwrap();
    let (name, mesh) = (format!("{}, {metric:?}, {conditions:?}", solid.name), hodge.mesh());
    assert_eq!(hodge.homology().generators().len(), betti, "{name}");
    assert_eq!(hodge.homology().loops().len(), solid.loops, "{name}");
    let c: Cochain<1> = Cochain::new(random(mesh.num_edges(), 11));
    let parts = hodge.decompose(&c);
    let forms = [&parts.exact, &parts.coexact, &parts.harmonic];
    let product = |a: &Cochain<1>, b: &Cochain<1>| dot(a.values(), hodge.mass(b).values());
    let norm = |a: &Cochain<1>| product(a, a).abs().sqrt();

    let mut worst = [0.0f64; 4];
    for i in 0..3 {
        for j in 0..i {
            let scale = (norm(forms[i]) * norm(forms[j])).max(f64::MIN_POSITIVE);
            if norm(forms[i]) > 0.0 && norm(forms[j]) > 0.0 {
                worst[0] = worst[0].max(product(forms[i], forms[j]).abs() / scale);
            }
        }
    }
    let sum = forms[0].clone() + forms[1].clone() + forms[2].clone();
    worst[1] = largest((sum + c.clone() * -1.0).values()) / largest(c.values());
    // The coexact part is the codifferential of its stream function.
    let image = hodge.mass(&parts.coexact);
    let size = largest(image.values()).max(f64::MIN_POSITIVE);
    for e in (0..mesh.num_edges() as u32).filter(|&e| !hodge.homology().is_fixed_edge(e)) {
        let h = HalfEdge::new(e, true);
        let at = |h| mesh.left_corner(h).map_or(0.0, |c| parts.stream[mesh.corner_face(c) as usize]);
        let off = (at(h) - at(h.twin()) - image[e as usize]).abs();
        assert!(off < 1e-11 * size, "{name}: the stream function is {:e} off at edge {e}", off / size);
    }
    // d d a = 0 and d h = 0: sums of a few numbers.
    let scale = largest(c.values());
    worst[2] = largest(parts.exact.exterior_derivative(mesh).values()) / scale;
    for (i, h) in hodge.harmonic_basis().iter().enumerate() {
        let h: Cochain<1> = Cochain::new(h.clone());
        let size = largest(h.values());
        worst[2] = worst[2].max(largest(h.exterior_derivative(mesh).values()) / size);
        let codifferential = hodge.weak_codifferential(&h);
        let free = (0..mesh.num_vertices() as u32).filter(|&v| !hodge.homology().is_fixed_vertex(v));
        let free: Vec<f64> = free.map(|v| codifferential[v as usize]).collect();
        worst[3] = worst[3].max(largest(&free) / norm(&h));
        // Fixed edges have no part in it, and circulations round cycles are units.
        assert!(
            (0..mesh.num_edges() as u32).all(|e| !hodge.homology().is_fixed_edge(e) || h[e as usize] == 0.0)
        );
        for j in 0..betti {
            let round: f64 = hodge.homology().cycle(mesh, j).iter().map(|&edge| h.along(edge)).sum();
            assert!((round - f64::from(u8::from(i == j))).abs() < 1e-12, "{name}: {i} {j} {round}");
        }
    }
    // The cycles are closed paths, or arcs between normal loops.
    for j in 0..betti {
        let cycle = hodge.homology().cycle(mesh, j);
        assert!(cycle.windows(2).all(|pair| mesh.head(pair[0]) == mesh.tail(pair[1])), "{name}");
        let (start, end) = (mesh.tail(cycle[0]), mesh.head(cycle[cycle.len() - 1]));
        let arc = hodge.homology().is_fixed_vertex(start) && hodge.homology().is_fixed_vertex(end);
        assert!(start == end || arc, "{name}: {start} {end}");
    }
    // A harmonic field is found again, with its circulations; decomposing parts changes nothing.
    let wanted = random(betti, 5);
    let again = hodge.decompose(&hodge.harmonic(&wanted));
    assert!(largest(again.exact.values()) < 1e-11 && largest(again.coexact.values()) < 1e-11, "{name}");
    assert!(wanted.iter().zip(&again.circulations).all(|(a, b)| (a - b).abs() < 1e-11), "{name}");
    let exact = hodge.decompose(&parts.exact);
    assert!(norm(&exact.coexact) + norm(&exact.harmonic) < 1e-11 * norm(&parts.exact), "{name}");
    let coexact = hodge.decompose(&parts.coexact);
    assert!(norm(&coexact.exact) + norm(&coexact.harmonic) < 1e-11 * norm(&c), "{name}");
    worst
}

fn assert_laws(solid: &Solid, metric: Metric, conditions: &[Condition], betti: usize) -> [f64; 4] {
    let worst = check(solid, metric, conditions, betti);
    let [orthogonal, sum, closed, coclosed] = worst;
    let name = format!("{}, {metric:?}, {conditions:?}: {worst:?}", solid.name);
    assert!(orthogonal < 1e-12, "not orthogonal: {name}");
    assert!(sum < 1e-12, "the parts do not sum up: {name}");
    assert!(closed < 1e-13, "not closed: {name}");
    assert!(coclosed < 1e-11, "not coclosed: {name}");
    worst
}

#[test]
fn decompositions_are_exact_on_every_topology() {
    let mut worst = [0.0f64; 4];
    for solid in solids::all() {
        for metric in [Metric::Limit, Metric::ControlMesh] {
            let found = assert_laws(&solid, metric, &[], solid.betti());
            (0..4).for_each(|k| worst[k] = worst[k].max(found[k]));
        }
    }
    println!(
        "worst: orthogonality {:.1e}, sum {:.1e}, d h {:.1e}, delta h {:.1e}",
        worst[0], worst[1], worst[2], worst[3]
    );
}

/// Relative forms have as many dimensions as absolute ones, mixed conditions one less.
#[test]
fn boundary_conditions_change_the_harmonic_space() {
    use Condition::{Normal, Tangential};
    for solid in solids::all().into_iter().filter(|s| s.loops > 0) {
        assert_laws(&solid, Metric::Limit, &vec![Normal; solid.loops], solid.betti());
        if solid.loops == 2 {
            let mixed = 2 * solid.genus + solid.loops - 2;
            assert_laws(&solid, Metric::Limit, &[Tangential, Normal], mixed);
            assert_laws(&solid, Metric::ControlMesh, &[Normal], mixed);
        }
    }
}

/// Modified Loop, bilinear and Whitney's forms are complexes as well.
#[test]
fn every_scheme_decomposes() {
    let solid = solids::all().into_iter().find(|s| s.name == "genus 1, triangles").unwrap();
    let quads = solids::all().into_iter().find(|s| s.name == "genus 1, quads").unwrap();
    let modified = Scheme::Loop(Variant::ModifiedLoop, BoundaryRule::Dct);
    for (solid, scheme) in [
        (&solid, modified),
        (&solid, Scheme::Whitney),
        (&solid, Scheme::default()),
        (&quads, Scheme::Bilinear),
    ] {
        let surface = LimitSurface::new(&solid.cage, scheme).unwrap();
        let hodge = Hodge::new(&surface, &solid.positions, Metric::Limit, &[]).unwrap();
        let c: Cochain<1> = Cochain::new(random(hodge.mesh().num_edges(), 2));
        let parts = hodge.decompose(&c);
        let image = hodge.mass(&parts.coexact);
        let off = dot(parts.exact.values(), image.values()).abs()
            + dot(parts.harmonic.values(), image.values()).abs();
        assert!(off < 1e-12 * dot(c.values(), hodge.mass(&c).values()), "{scheme:?}: {off:e}");
        assert_eq!(parts.circulations.len(), 2);
    }
}

/// On a flat annulus of quads the harmonic field is known: `d theta`, with length `1 / r`.
#[test]
fn the_harmonic_field_of_an_annulus_is_known() {
    let mut errors = Vec::new();
    for n in [1u32, 2, 4] {
        let (around, across) = (12 * n, 3 * n);
        let at = |i: u32, j: u32| i % around + j * around;
        let faces: Vec<Vec<u32>> = (0..around * across)
            .map(|f| (f % around, f / around))
            .map(|(i, j)| vec![at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)])
            .collect();
        let points = (0..around * (across + 1)).map(|v| {
            let (angle, r) = (
                std::f64::consts::TAU * f64::from(v % around) / f64::from(around),
                1.0 + f64::from(v / around) / f64::from(across),
            );
            formwork::nalgebra::Vector3::new(r * angle.cos(), r * angle.sin(), 0.0)
        });
        let positions = Cochain::new(points.collect::<Vec<_>>());
        let cage = Cage::new(common::meshes::polygons(positions.len(), &faces)).unwrap();
        let surface = LimitSurface::new(&cage, Scheme::default()).unwrap();
        let hodge = Hodge::new(&surface, &positions, Metric::Limit, &[]).unwrap();
        let h = hodge.harmonic(&[1.0]);
        let points: Vec<_> = (0..cage.descriptor().face_sizes.len() as u32)
            .map(|face| formwork::limit::SurfacePoint { face, corner: 0, s: 0.4, t: 0.6 })
            .collect();
        let found =
            surface.evaluate_vectors(&surface.refine(&positions), &surface.refine(&h), &points).unwrap();
        let worst = found.iter().map(|v| {
            let p = v.position.value;
            let theta =
                formwork::nalgebra::Vector3::new(-p.y, p.x, 0.0) / p.norm_squared() / std::f64::consts::TAU;
            (v.vector - theta).norm().min((v.vector + theta).norm())
        });
        errors.push(worst.fold(0.0, f64::max));
    }
    println!("{errors:?}");
    assert!(errors[2] < errors[1] / 6.0 && errors[1] < errors[0] / 6.0, "{errors:?}");
}

/// `d1 c = curl` exactly, where curl balances.
#[test]
fn prescribed_curl_is_met_exactly() {
    for solid in solids::all() {
        let surface = LimitSurface::new(&solid.cage, scheme(&solid.cage)).unwrap();
        let mesh = surface.hierarchy().level(0).mesh();
        let homology = Homology::new(mesh, &[]).unwrap();
        let mut curl = random(mesh.num_faces(), 9);
        if solid.loops == 0 {
            let mean = curl.iter().sum::<f64>() / curl.len() as f64;
            curl.iter_mut().for_each(|x| *x -= mean);
        }
        let c = homology.with_curl(mesh, &curl, &random(solid.betti(), 3));
        let found = apply(&mesh.d1(), &c);
        let off = found.iter().zip(&curl).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off < 1e-13 * curl.len() as f64, "{}: {off:e}", solid.name);
    }
}
