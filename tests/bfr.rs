//! Evaluation at points beside OpenSubdiv's own, its `Bfr`.
//!
//! `Bfr` refines irregular vertices to a level and closes what is left, within 2^-level of the vertex, by a patch
//! that is not the limit surface; outside it is exact. [`bfr_closes_in_on_us`] measures both, and so justifies the
//! tolerances of the other tests, rounding only, at points that stay outside.

mod common;

use common::meshes::{bipyramid, fan, grid, hexagonal_torus, triangle_fan};
use common::shapes::shapes;
use formwork::cochain::Cochain;
use formwork::limit::{LimitSurface, SurfaceError, SurfacePoint};
use formwork::nalgebra::Vector3;
use formwork::osd::{Refiner, Rule};
use formwork::scheme::{BoundaryRule, Scheme, Variant};
use formwork::topology::{Cage, Corner, Crease, Descriptor, SplitKind};

const LOOP: Scheme = Scheme::Loop(Variant::Loop, BoundaryRule::Reflect);

/// Rounding, for positions and derivatives where the control points are of size 1.
const SAME: [f64; 2] = [1e-14, 1e-13];

/// The level of Bfr.
const LEVEL: u8 = 10;

/// The distance of points from corners in the parameters; Bfr's patches end at 2^-LEVEL.
const CLEARANCE: f64 = 1.0 / 64.0;

fn show(found: [f64; 2]) -> String {
    format!("{:.1e}, {:.1e}", found[0], found[1])
}

struct Random(u64);

impl Random {
    /// From 0 to 1.
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn positions(&mut self, count: usize) -> Vec<[f64; 3]> {
        (0..count).map(|_| [0; 3].map(|_| 2.0 * self.next() - 1.0)).collect()
    }

    /// A point of the unit square, or of the triangle below its diagonal.
    fn point(&mut self, kind: SplitKind) -> [f64; 2] {
        let (s, t) = (self.next(), self.next());
        match kind {
            SplitKind::Triangle if s + t > 1.0 => [1.0 - s, 1.0 - t],
            _ => [s, t],
        }
    }

    /// Points of a face, some on its edges, so far at least from its corners.
    fn points(&mut self, kind: SplitKind, clearance: f64) -> Vec<[f64; 2]> {
        let mut points: Vec<[f64; 2]> = (0..10).map(|_| self.point(kind)).collect();
        points.extend([
            [0.3, 0.0],
            [0.0, 0.7],
            if kind == SplitKind::Quad { [0.4, 1.0] } else { [0.4, 0.6] },
        ]);
        // On a triangle Bfr's patches are triangles too.
        let near = |s: f64, t: f64| match kind {
            SplitKind::Quad => s.max(t) < clearance,
            SplitKind::Triangle => s + t < clearance,
        };
        points.retain(|&[s, t]| match kind {
            SplitKind::Quad => !near(s.min(1.0 - s), t.min(1.0 - t)),
            SplitKind::Triangle => {
                let u = 1.0 - s - t;
                !near(s, t) && !near(u, t) && !near(s, u)
            }
        });
        points
    }
}

/// The greatest differences of positions and of derivatives between ours and Bfr's at some points of each face
/// that has a surface.
fn differences(
    cage: &Cage,
    scheme: Scheme,
    level: u8,
    positions: &[[f64; 3]],
    mut points: impl FnMut(SplitKind) -> Vec<[f64; 2]>,
) -> Result<[f64; 2], SurfaceError> {
    let surface = LimitSurface::new(cage, scheme)?;
    let kind = surface.hierarchy().split_kind();
    let x = surface.refine(&Cochain::new(positions.iter().map(|&x| Vector3::from(x)).collect()));
    let refiner = Refiner::new(cage, scheme.opensubdiv(kind)).unwrap();
    let bfr = refiner.bfr(level, level).unwrap();
    let holes = &surface.hierarchy().level(0).tags().face_hole;
    let mut worst = [0.0f64; 2];
    for (face, _) in holes.iter().enumerate().filter(|(_, hole)| !**hole) {
        let uv = points(kind);
        let at = |&[s, t]: &[f64; 2]| SurfacePoint { face: face as u32, corner: 0, s, t };
        let ours = surface.evaluate_0(&x, &uv.iter().map(at).collect::<Vec<_>>()).unwrap();
        let theirs = bfr.evaluate(positions.as_flattened(), &vec![face as u32; uv.len()], &uv).unwrap();
        for (ours, theirs) in ours.iter().zip(&theirs) {
            let [p, u, v] = theirs.map(Vector3::from);
            worst[0] = worst[0].max((ours.value - p).amax());
            worst[1] = worst[1].max((ours.derivatives[0] - u).amax().max((ours.derivatives[1] - v).amax()));
        }
    }
    Ok(worst)
}

#[track_caller]
fn assert_same(name: &str, descriptor: Descriptor, scheme: Scheme) {
    let mut random = Random(1);
    let positions = random.positions(descriptor.num_vertices);
    let cage = Cage::new(descriptor).unwrap();
    let found = differences(&cage, scheme, LEVEL, &positions, |kind| random.points(kind, CLEARANCE)).unwrap();
    println!("{name}: {}", show(found));
    assert!(found[0] <= SAME[0] && found[1] <= SAME[1], "{name}: {}", show(found));
}

fn sharp(edges: &[[u32; 2]], corners: &[u32], descriptor: Descriptor) -> Descriptor {
    Descriptor {
        creases: edges.iter().map(|&vertices| Crease { vertices, sharpness: 10.0 }).collect(),
        corners: corners.iter().map(|&vertex| Corner { vertex, sharpness: 10.0 }).collect(),
        ..descriptor
    }
}

#[test]
fn quads() {
    let catmark = Scheme::default();
    assert_same("torus", grid(5, 4, true), catmark);
    assert_same("open grid", grid(4, 3, false), catmark);
    for k in 3..=12 {
        assert_same(&format!("fan of {k}"), fan(&vec![4; k]), catmark);
    }
    // A crease round the torus; one across an open grid, and one that ends on it; a sharp vertex.
    let ring: Vec<_> = (0..5).map(|i| [10 + i, 10 + (i + 1) % 5]).collect();
    assert_same("ring", sharp(&ring, &[], grid(5, 5, true)), catmark);
    let lines = [[2, 7], [7, 12], [12, 17], [17, 22], [12, 13], [13, 14]];
    assert_same("lines", sharp(&lines, &[6], grid(4, 4, false)), catmark);
    for k in 3..=8 {
        let creased = sharp(&[[0, 1], [0, 3]], &[], fan(&vec![4; k]));
        assert_same(&format!("fan of {k} with a crease"), creased, catmark);
    }
}

#[test]
fn triangles() {
    assert_same("torus", hexagonal_torus(5, 4), LOOP);
    assert_same("open grid", common::meshes::cut_grid(4, 3, false, &[2; 12]), LOOP);
    for k in 3..=12 {
        assert_same(&format!("bipyramid of {k}"), bipyramid(k), LOOP);
        assert_same(&format!("fan of {k}"), triangle_fan(k, true), LOOP);
        assert_same(&format!("half fan of {k}"), triangle_fan(k, false), LOOP);
    }
    let ring: Vec<_> = (0..5).map(|i| [10 + i, 10 + (i + 1) % 5]).collect();
    assert_same("ring", sharp(&ring, &[], hexagonal_torus(5, 5)), LOOP);
    let lines = [[2, 7], [7, 12], [12, 17], [17, 22], [12, 13], [13, 14]];
    let plain = common::meshes::cut_grid(4, 4, false, &[2; 16]);
    assert_same("lines", sharp(&lines, &[6], plain), LOOP);
    for k in 4..=8 {
        let creased = sharp(&[[0, 2], [0, 4]], &[], bipyramid(k));
        assert_same(&format!("bipyramid of {k} with a crease"), sharp(&[[2, 1], [1, 4]], &[], creased), LOOP);
    }
}

/// Outside its closing patches Bfr agrees to rounding at every level. Inside, positions differ by as much less as
/// the patch is smaller in space, by a half to two thirds with each level; derivatives by the parameters, which
/// have no limit at the vertex, do not, and are not compared there.
#[test]
fn bfr_closes_in_on_us() {
    for (name, descriptor, scheme) in [
        ("3 quads", fan(&[4; 3]), Scheme::default()),
        ("5 quads", fan(&[4; 5]), Scheme::default()),
        ("bipyramid of 7", bipyramid(7), LOOP),
    ] {
        let positions = Random(3).positions(descriptor.num_vertices);
        let cage = Cage::new(descriptor).unwrap();
        let mut before = f64::INFINITY;
        for level in [2, 4, 6, 8, 10] {
            let mut random = Random(5);
            let outside = |kind| random.points(kind, 0.5f64.powi(level.into()));
            let outside = differences(&cage, scheme, level, &positions, outside).unwrap();
            let same = outside[0] <= SAME[0] && outside[1] <= SAME[1];
            assert!(same, "{name}, level {level}: {}", show(outside));

            // As many points at each distance from 1 to 2^-20 of the first corner.
            let everywhere = |kind| {
                let near = |_| {
                    let scale = 0.5f64.powf(20.0 * random.next());
                    random.point(kind).map(|x| x * scale)
                };
                (0..200).map(near).collect()
            };
            let found = differences(&cage, scheme, level, &positions, everywhere).unwrap();
            println!("{name}, level {level}: {} outside, {} with the patch", show(outside), show(found));
            assert!(found[0] < 0.45 * before, "{name}, level {level}: {found:?} after {before}");
            before = found[0];
        }
    }
}

#[test]
fn every_shape() {
    for (family, kind, scheme) in
        [("catmark", SplitKind::Quad, Scheme::default()), ("loop", SplitKind::Triangle, LOOP)]
    {
        let Some(shapes) = shapes(family) else { return };
        let (mut count, mut worst) = (0, [0.0f64; 2]);
        for shape in shapes {
            let mut descriptor = shape.descriptor();
            descriptor.collapse();
            let cage = Cage::new(descriptor).unwrap();
            let refiner = Refiner::new(&cage, scheme.opensubdiv(kind)).unwrap();
            let (mesh, tags) = (refiner.mesh(0).unwrap(), refiner.tags(0).unwrap());
            let size = if kind == SplitKind::Quad { 4 } else { 3 };
            let settled = |s: &f32| *s == 0.0 || *s >= 10.0;
            let plain = (0..mesh.num_faces() as u32).all(|f| mesh.face_size(f) == size)
                && tags.edge_sharpness.iter().chain(&tags.vertex_sharpness).all(settled)
                && !tags.vertex_rule.contains(&Rule::Dart)
                && (0..mesh.num_vertices() as u32)
                    .all(|v| mesh.fans(v).all(|fan| !fan.cyclic || fan.corners.len() > 2));
            if !plain {
                continue;
            }
            let mut random = Random(7);
            let positions = random.positions(mesh.num_vertices());
            match differences(&cage, scheme, LEVEL, &positions, |kind| random.points(kind, CLEARANCE)) {
                Ok(found) => {
                    println!("{}: {}", shape.name, show(found));
                    let same = found[0] <= SAME[0] && found[1] <= SAME[1];
                    assert!(same, "{}: {}", shape.name, show(found));
                    worst = [worst[0].max(found[0]), worst[1].max(found[1])];
                    count += 1;
                }
                Err(SurfaceError::NonManifold { .. }) => println!("{}: non-manifold", shape.name),
                Err(error) => panic!("{}: {error}", shape.name),
            }
        }
        println!("{count} {family} shapes: {}", show(worst));
    }
}
