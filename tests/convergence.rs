//! How fast the limit of fitted cochains approaches a smooth field: a field of R^3 restricted to surfaces, its
//! circulations along the limit edges taken by quadrature, the control cochain fitted so that its limit has exactly
//! those, and the tangent vector compared at random points.

mod common;

use common::random;
use formwork::cochain::{Cochain, Value};
use formwork::field::sharp;
use formwork::hierarchy::Hierarchy;
use formwork::limit::{Limit, LimitSurface, SurfacePoint};
use formwork::scheme::{BoundaryRule, Scheme, Variant};
use formwork::topology::{Cage, Descriptor, Mesh, SplitKind};
use nalgebra::Vector3;

/// The field.
fn field(x: Vector3<f64>) -> Vector3<f64> {
    Vector3::new((x.y + 0.3 * x.z).sin(), (1.3 * x.x).cos() + 0.5 * x.z, x.x * x.y + 0.2)
}

/// Gauss' rule of four points on `[0, 1]`.
fn gauss() -> [(f64, f64); 4] {
    let root = (6.0f64 / 5.0).sqrt();
    let (a, b) = ((3.0 / 7.0 - 2.0 / 7.0 * root).sqrt(), (3.0 / 7.0 + 2.0 / 7.0 * root).sqrt());
    let (wa, wb) = ((18.0 + 30f64.sqrt()) / 36.0, (18.0 - 30f64.sqrt()) / 36.0);
    [(-b, wb), (-a, wa), (a, wa), (b, wb)].map(|(x, weight)| ((1.0 + x) / 2.0, weight / 2.0))
}

/// Richardson's iteration for `L x = values`: `sweeps` of them, and the size of what is left.
///
/// The limit operators average, `L = I + O(h^2)` on smooth data, so each sweep gains two orders there. Where `L` is
/// regular, as on quads, the iteration goes on until nothing is left; on triangles the edge splines depend on each
/// other, and a few sweeps are all that makes sense.
fn fit<const K: usize, T: Value>(
    limit: &Limit,
    mesh: &Mesh,
    values: &Cochain<K, T>,
    sweeps: usize,
    norm: impl Fn(T) -> f64,
) -> (Cochain<K, T>, f64) {
    let mut x = values.clone();
    let mut left = f64::INFINITY;
    for _ in 0..sweeps {
        let rest = values.clone() + limit.apply(mesh, &x) * -1.0;
        left = rest.values().iter().map(|&rest| norm(rest)).fold(0.0, f64::max);
        x = x + rest;
        if left < 1e-12 {
            break;
        }
    }
    (x, left)
}

/// The largest and the root mean square difference of the vectors, on a cage whose limit vertices are moved by
/// `place` onto the surface.
fn errors(descriptor: Descriptor, scheme: Scheme, points_of: &Cochain<0, Vector3<f64>>) -> (f64, f64) {
    let cage = Cage::new(descriptor).unwrap();
    let hierarchy = Hierarchy::new(&cage, scheme, 0).unwrap();
    let mesh = hierarchy.level(0).mesh();
    let limit = Limit::new(&hierarchy, 0).unwrap();
    let (positions, left) = fit(&limit, mesh, points_of, 2000, |x: Vector3<f64>| x.norm());
    assert!(left < 1e-12, "{left:e}");
    let surface = LimitSurface::new(&cage, scheme).unwrap();
    let x = surface.refine(&positions);

    // Panels that shrink towards the ends, which may be irregular.
    let mut ends: Vec<f64> = (2..12).rev().map(|i| 0.5f64.powi(i)).collect();
    ends.insert(0, 0.0);
    ends.push(0.5);
    ends.extend((0..ends.len() - 1).rev().map(|i| 1.0 - ends[i]).collect::<Vec<_>>());
    let rule: Vec<(f64, f64)> = ends
        .windows(2)
        .flat_map(|w| gauss().map(|(at, weight)| (w[0] + (w[1] - w[0]) * at, weight * (w[1] - w[0]))))
        .collect();
    let circulation = |e: u32| {
        let (h, sign) = [(2 * e, 1.0), (2 * e + 1, -1.0)]
            .into_iter()
            .find_map(|(h, sign)| Some((mesh.left_corner(formwork::topology::HalfEdge(h))?, sign)))
            .unwrap();
        let face = mesh.corner_face(h);
        let corner = h - mesh.corners(face).start;
        let points: Vec<_> = rule.iter().map(|&(s, _)| SurfacePoint { face, corner, s, t: 0.0 }).collect();
        let jets = surface.evaluate_0(&x, &points).unwrap();
        let along = jets.iter().zip(&rule);
        sign * along.map(|(jet, (_, weight))| weight * field(jet.value).dot(&jet.derivatives[0])).sum::<f64>()
    };
    let samples = Cochain::<1>::new((0..mesh.num_edges() as u32).map(circulation).collect());
    let sweeps = if hierarchy.split_kind() == SplitKind::Quad { 2000 } else { 4 };
    let (form, left) = fit(&limit, mesh, &samples, sweeps, f64::abs);
    assert!(sweeps == 4 || left < 1e-12, "{left:e}");
    let form = surface.refine(&form);

    let numbers = random(8 * mesh.num_faces(), 1);
    let points: Vec<SurfacePoint> = numbers
        .chunks(2)
        .enumerate()
        .map(|(i, pair)| {
            let [mut s, mut t] = [pair[0].abs(), pair[1].abs()];
            if surface.hierarchy().split_kind() == SplitKind::Triangle && s + t > 1.0 {
                (s, t) = (1.0 - s, 1.0 - t);
            }
            SurfacePoint { face: i as u32 / 4, corner: 0, s, t }
        })
        .collect();
    let positions = surface.evaluate_0(&x, &points).unwrap();
    let forms = surface.evaluate_1(&form, &points).unwrap();
    let differences: Vec<f64> = positions
        .iter()
        .zip(&forms)
        .map(|(x, form)| {
            let normal = x.derivatives[0].cross(&x.derivatives[1]).normalize();
            let exact = field(x.value);
            let tangential = exact - normal * exact.dot(&normal);
            (sharp(x.derivatives, form.map(|component| component.value)) - tangential).norm()
        })
        .collect();
    let largest = differences.iter().copied().fold(0.0, f64::max);
    let square: f64 = differences.iter().map(|x| x * x).sum();
    (largest, (square / differences.len() as f64).sqrt())
}

/// Prints the table of a sequence and returns the last rates, of the largest difference and of the mean.
fn rates(name: &str, errors: &[(f64, f64)]) -> [f64; 2] {
    println!("{name}\n   largest  rate   root mean square  rate");
    let mut last = [0.0; 2];
    for (i, &(largest, mean)) in errors.iter().enumerate() {
        if i > 0 {
            last = [(errors[i - 1].0 / largest).log2(), (errors[i - 1].1 / mean).log2()];
        }
        println!("  {largest:8.2e}  {:4.2}   {mean:16.2e}  {:4.2}", last[0], last[1]);
    }
    last
}

/// A torus of revolution, `n` by `2n` quads.
fn torus(n: u32, triangles: bool) -> (Descriptor, Cochain<0, Vector3<f64>>) {
    let descriptor = match triangles {
        true => common::meshes::hexagonal_torus(n, 2 * n),
        false => common::meshes::grid(n, 2 * n, true),
    };
    let point = |v: u32| {
        let turn = std::f64::consts::TAU;
        let (a, b) = (turn * f64::from(v % n) / f64::from(n), turn * f64::from(v / n) / f64::from(2 * n));
        let radius = 2.0 + a.cos();
        Vector3::new(radius * b.cos(), radius * b.sin(), a.sin())
    };
    let points = (0..descriptor.num_vertices as u32).map(point).collect();
    (descriptor, Cochain::new(points))
}

/// A refined cube or octahedron on the unit sphere.
fn sphere(levels: usize, scheme: Scheme) -> (Descriptor, Cochain<0, Vector3<f64>>) {
    let quads = matches!(scheme, Scheme::Catmark(_));
    let (descriptor, points): (Descriptor, Vec<Vector3<f64>>) = if quads {
        let faces = [[0u32, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [1, 3, 7, 5], [3, 2, 6, 7], [2, 0, 4, 6]];
        let sign = |v: u32, bit: u32| if v >> bit & 1 == 1 { 1.0 } else { -1.0 };
        let points = (0..8).map(|v| Vector3::new(sign(v, 0), sign(v, 1), sign(v, 2))).collect();
        (common::meshes::polygons(8, &faces.map(|face| face.to_vec())), points)
    } else {
        let faces =
            [[0u32, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
        let axes = [Vector3::x(), -Vector3::x(), Vector3::y(), -Vector3::y(), Vector3::z(), -Vector3::z()];
        (common::meshes::polygons(6, &faces.map(|face| face.to_vec())), axes.to_vec())
    };
    let hierarchy = Hierarchy::new(&Cage::new(descriptor).unwrap(), scheme, levels).unwrap();
    let mesh = hierarchy.finest().mesh();
    let refined = hierarchy.subdivide(&Cochain::<0, _>::new(points));
    let on_sphere = refined.values().iter().map(|x| x.normalize()).collect();
    let faces: Vec<Vec<u32>> = (0..mesh.num_faces() as u32).map(|f| mesh.face_vertices(f).to_vec()).collect();
    (common::meshes::polygons(mesh.num_vertices(), &faces), Cochain::new(on_sphere))
}

const LOOP: Scheme = Scheme::Loop(Variant::Loop, BoundaryRule::Reflect);

#[test]
fn order_3_on_regular_quads() {
    let of = |n| {
        let (descriptor, points) = torus(n, false);
        errors(descriptor, Scheme::default(), &points)
    };
    let [largest, mean] = rates("torus, quads", &[8, 16, 32].map(of));
    assert!(largest > 2.7 && mean > 2.8, "{largest} {mean}");
}

#[test]
fn order_3_on_regular_triangles() {
    let of = |n| {
        let (descriptor, points) = torus(n, true);
        errors(descriptor, LOOP, &points)
    };
    let [largest, mean] = rates("torus, triangles", &[8, 16, 32].map(of));
    assert!(largest > 2.7 && mean > 2.8, "{largest} {mean}");
}

#[test]
fn irregular_vertices_limit_the_order() {
    for (name, scheme) in [("sphere, quads", Scheme::default()), ("sphere, triangles", LOOP)] {
        let of = |levels| {
            let (descriptor, points) = sphere(levels, scheme);
            errors(descriptor, scheme, &points)
        };
        let [_, mean] = rates(name, &[1, 2, 3].map(of));
        assert!(mean > 1.0, "{name}: {mean}");
    }
}
