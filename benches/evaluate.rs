//! Evaluation at points, beside OpenSubdiv's `Bfr` at its default levels in the same run.
//!
//! A million random points, sorted by face: the tangent vector of a 1-form with the surface's position and
//! derivatives, and those alone. `Bfr` knows no forms; its position with derivatives is the yardstick. It sets a
//! face up when it comes to it, for which its cost is shown with and without.

mod common;

use std::f64::consts::TAU;
use std::hint::black_box;

use common::{RUNS, Random, meshes, paired};
use formwork::cochain::Cochain;
use formwork::limit::{LimitSurface, SurfacePoint};
use formwork::nalgebra::Vector3;
use formwork::osd::{BFR_SHARP_LEVEL, BFR_SMOOTH_LEVEL, Refiner, Rule};
use formwork::scheme::{BoundaryRule, Scheme, Variant};
use formwork::topology::{Cage, Descriptor, Mesh, SplitKind};

const POINTS: usize = 1_000_000;

/// A name, how to make the mesh, and its scheme.
type Case = (&'static str, fn() -> Descriptor, Scheme);

fn main() {
    println!("{POINTS} points; medians of {RUNS}; as ratios to Bfr's position and derivatives, one thread");
    let catmark = Scheme::default();
    let loop_ = Scheme::Loop(Variant::Loop, BoundaryRule::Reflect);
    // `cargo bench --bench evaluate -- set-up` runs what has this in its name.
    let wanted = std::env::args().skip(1).find(|arg| !arg.starts_with('-')).unwrap_or_default();
    let meshes: [Case; 4] = [
        ("quads, regular", || meshes::grid(100, 100, true), catmark),
        ("quads, irregular", || quads_of(&random_triangles(40)), catmark),
        ("triangles, regular", || meshes::hexagonal_torus(100, 50), loop_),
        ("triangles, irregular", || random_triangles(70), loop_),
    ];
    for (name, mesh, scheme) in meshes {
        if name.contains(&wanted) {
            compare(name, mesh(), scheme, name.ends_with("irregular"));
        }
    }
    if !"set-up".contains(&wanted) {
        return;
    }
    println!("\nSet-up of a surface, nanoseconds a face of the cage");
    println!("{:>20} {:>10} {:>12} {:>12}", "", "faces", "one thread", "two threads");
    for side in [40, 80, 160] {
        set_up("quads, irregular", quads_of(&random_triangles(side)), catmark);
    }
    for side in [70, 140, 280] {
        set_up("triangles, irregular", random_triangles(side), loop_);
    }
}

fn pool(threads: usize) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap()
}

fn set_up(name: &str, descriptor: Descriptor, scheme: Scheme) {
    let cage = Cage::new(descriptor).unwrap();
    let (one, two) = (pool(1), pool(2));
    let build = || drop(black_box(LimitSurface::new(&cage, scheme).unwrap()));
    let times = paired([&mut || one.install(build), &mut || two.install(build)]);
    let faces = cage.descriptor().face_sizes.len();
    let [one, two] = times.map(|ms| ms * 1e6 / faces as f64);
    println!("{name:>20} {faces:>10} {one:>12.0} {two:>12.0}");
}

/// A torus of cells cut along random diagonals: valences 4 to 8.
fn random_triangles(side: u32) -> Descriptor {
    let mut random = Random::new();
    let cuts: Vec<u8> = (0..side * side).map(|_| 1 + random.below(2) as u8).collect();
    meshes::cut_grid(side, side, true, &cuts)
}

/// Three quads for each triangle: each touches a vertex of the triangles and one of valence 3.
fn quads_of(triangles: &Descriptor) -> Descriptor {
    let cage = Cage::new(triangles.clone()).unwrap();
    let hierarchy = formwork::hierarchy::Hierarchy::new(&cage, Scheme::Bilinear, 1).unwrap();
    let mesh = hierarchy.finest().mesh();
    let faces: Vec<_> = (0..mesh.num_faces() as u32).map(|f| mesh.face_vertices(f).to_vec()).collect();
    meshes::polygons(mesh.num_vertices(), &faces)
}

/// Whether a face touches a vertex that is not regular.
fn is_irregular(mesh: &Mesh, kind: SplitKind, face: u32) -> bool {
    let regular = if kind == SplitKind::Quad { 4 } else { 6 };
    let valence = |&v: &u32| mesh.fans(v).map(|fan| fan.corners.len()).sum::<usize>();
    mesh.face_vertices(face).iter().any(|v| valence(v) != regular)
}

fn compare(name: &str, descriptor: Descriptor, scheme: Scheme, irregular: bool) {
    let cage = Cage::new(descriptor).unwrap();
    let mut surface = None;
    let [prepare] = paired([&mut || surface = Some(LimitSurface::new(&cage, scheme).unwrap())]);
    let surface = surface.unwrap();
    let (mesh, kind) = (surface.hierarchy().level(0).mesh(), surface.hierarchy().split_kind());
    assert!(surface.hierarchy().level(0).tags().vertex_rule.iter().all(|&rule| rule == Rule::Smooth));
    let faces: Vec<u32> =
        (0..mesh.num_faces() as u32).filter(|&f| is_irregular(mesh, kind, f) == irregular).collect();

    let mut random = Random::new();
    let place = |random: &mut Random, face: u32| {
        let (s, t) = (random.unit(), random.unit());
        let folded = kind == SplitKind::Triangle && s + t > 1.0;
        let (s, t) = if folded { (1.0 - s, 1.0 - t) } else { (s, t) };
        SurfacePoint { face, corner: 0, s, t }
    };
    let mut points: Vec<SurfacePoint> =
        (0..POINTS).map(|i| place(&mut random, faces[i * faces.len() / POINTS])).collect();
    points.sort_by_key(|point| point.face);

    let positions: Vec<[f64; 3]> = (0..mesh.num_vertices())
        .map(|v| {
            let (a, b) = (v as f64 * 0.618, v as f64 / mesh.num_vertices() as f64 * TAU);
            [(3.0 + a.cos()) * b.cos(), (3.0 + a.cos()) * b.sin(), a.sin()]
        })
        .collect();
    let x = surface.refine(&Cochain::new(positions.iter().map(|&x| Vector3::from(x)).collect()));
    let form = Cochain::<1>::new((0..mesh.num_edges()).map(|e| (e as f64 * 0.37).sin()).collect());
    let form = surface.refine(&form);

    let refiner = Refiner::new(&cage, scheme.opensubdiv(kind)).unwrap();
    let bfr = refiner.bfr(BFR_SMOOTH_LEVEL, BFR_SHARP_LEVEL).unwrap();
    let flat = positions.as_flattened();
    let at: Vec<u32> = points.iter().map(|point| point.face).collect();
    let uv: Vec<[f64; 2]> = points.iter().map(|point| [point.s, point.t]).collect();
    let one_each = vec![[0.3, 0.4]; faces.len()];
    let (one, two) = (pool(1), pool(2));
    let vectors = || drop(black_box(surface.evaluate_vectors(&x, &form, &points).unwrap()));
    let jets = || drop(black_box(surface.evaluate_0(&x, &points).unwrap()));

    // One in ten, face by face no longer.
    let mut scattered: Vec<usize> = (0..POINTS).step_by(10).collect();
    (1..scattered.len()).rev().for_each(|i| scattered.swap(i, random.below(i as u32 + 1) as usize));
    let few: Vec<SurfacePoint> = scattered.iter().map(|&i| points[i]).collect();
    let few_at: Vec<u32> = few.iter().map(|point| point.face).collect();
    let few_uv: Vec<[f64; 2]> = few.iter().map(|point| [point.s, point.t]).collect();
    let few_vectors = || drop(black_box(surface.evaluate_vectors(&x, &form, &few).unwrap()));

    let [theirs_few, ours_few] =
        paired([&mut || drop(black_box(bfr.evaluate(flat, &few_at, &few_uv).unwrap())), &mut || {
            one.install(few_vectors)
        }]);
    let [ours, ours_jets, ours_2, ours_jets_2, theirs, theirs_jets, set_up, set_up_jets] = paired([
        &mut || one.install(vectors),
        &mut || one.install(jets),
        &mut || two.install(vectors),
        &mut || two.install(jets),
        &mut || drop(black_box(bfr.evaluate_positions(flat, &at, &uv).unwrap())),
        &mut || drop(black_box(bfr.evaluate(flat, &at, &uv).unwrap())),
        &mut || drop(black_box(bfr.evaluate_positions(flat, &faces, &one_each).unwrap())),
        &mut || drop(black_box(bfr.evaluate(flat, &faces, &one_each).unwrap())),
    ]);
    println!(
        "\n{name}: {} faces, set up here in {prepare:.0} ms\n{:<56} {:>8} {:>12} {:>8}",
        faces.len(),
        "",
        "ns/point",
        "Mpoints/s",
        "ratio"
    );
    let per = |ms: f64, points: usize| ms * 1e6 / points as f64;
    // With e for a point and s for a face, two runs are P e + F s and F e + F s.
    let alone = |all: f64, set_up: f64| per(all - set_up, POINTS - faces.len());
    let yardstick = per(theirs_jets, POINTS);
    let line = |what: &str, ns: f64| {
        println!("  {what:<54} {ns:>8.0} {:>12.2} {:>7.2}x", 1e3 / ns, ns / yardstick);
    };
    line("Bfr: position", per(theirs, POINTS));
    line("Bfr: position, faces set up before", alone(theirs, set_up));
    line("Bfr: position and derivatives", yardstick);
    line("Bfr: position and derivatives, faces set up before", alone(theirs_jets, set_up_jets));
    line("formwork: position and derivatives", per(ours_jets, POINTS));
    line("formwork: the same and the vector of a 1-form", per(ours, POINTS));
    line("formwork: position and derivatives, two threads", per(ours_jets_2, POINTS));
    line("formwork: the same and the vector, two threads", per(ours_2, POINTS));
    println!("  in random order");
    line("Bfr: position and derivatives", per(theirs_few, few.len()));
    line("formwork: the same and the vector of a 1-form", per(ours_few, few.len()));
}
