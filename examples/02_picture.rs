//! Draws a refined cage with the tangent field of its 1-form, on the CPU.
//!
//! ```text
//! cargo run --release --example 02_picture -- [MESH.obj [FIELD.json [OUT.png [LEVELS]]]]
//! ```
//!
//! Everything drawn is a filled polygon in space: faces, field strokes, creases, the control cage. They
//! are sorted by distance and painted from the back (the painter's algorithm); what lies on the surface
//! is moved a little towards the eye.

mod painter;

use std::path::Path;

use formwork::cochain::Cochain;
use formwork::field::{face_centres, face_vectors};
use formwork::hierarchy::Hierarchy;
use formwork::io::{fields, obj};
use formwork::scheme::Scheme;
use formwork::topology::HalfEdge;
use painter::{Camera, LIGHT, SHADOW, SURFACE, Scene, Vec3, brightness, color, speed_color};

/// A stroke follows the field for so many steps.
const STEPS: u32 = 14;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let argument = |i, default: &str| std::env::args().nth(i).unwrap_or(default.into());
    let asset = obj::read(Path::new(&argument(1, "assets/creased_box.obj")))?;
    let hierarchy = Hierarchy::new(&asset.cage()?, Scheme::default(), argument(4, "4").parse()?)?;
    let (coarse, fine) = (hierarchy.level(0).mesh(), hierarchy.finest().mesh());
    let fields = fields::read(Path::new(&argument(2, "assets/creased_box.field.json")), coarse)?;
    let form = hierarchy.subdivide(&fields.form1.unwrap_or(Cochain::zeros(coarse.num_edges())));
    let positions = hierarchy.subdivide(&asset.positions);
    let at = |v: u32| positions[v as usize];

    let camera = Camera::facing(asset.positions.values());
    let (size, eye) = (camera.size, camera.eye());
    let mut scene = Scene::new(camera);

    let centres = face_centres(fine, &positions);
    let vectors = face_vectors(fine, &positions, &form);
    let fastest = vectors.iter().map(|v| v.norm()).fold(1e-9, f64::max);
    let normal = |f: u32| {
        let corners = fine.face_vertices(f);
        let (a, b) = (at(corners[2]) - at(corners[0]), at(corners[corners.len() - 1]) - at(corners[1]));
        a.cross(&b).try_normalize(0.0).unwrap_or(Vec3::z())
    };
    // A face and those that touch it: where a step along the field may lead.
    let around = |f: u32| {
        let fans = fine.face_vertices(f).iter().flat_map(|&v| fine.fans(v));
        fans.flat_map(|fan| fan.corners).map(|&corner| fine.corner_face(corner))
    };
    let ground = asset.positions.values().iter().map(|p| p.z).fold(f64::MAX, f64::min);
    let faces = (0..fine.num_faces() as u32).filter(|&f| !hierarchy.finest().tags().face_hole[f as usize]);
    for f in faces {
        let corners: Vec<Vec3> = fine.face_vertices(f).iter().map(|&v| at(v)).collect();
        let towards_eye = eye - centres[f as usize];
        scene.polygon(&corners, 0.0, color(SURFACE, brightness(normal(f), towards_eye), 1.0), false);
        let shadow: Vec<Vec3> = corners.iter().map(|p| p - LIGHT * ((p.z - ground) / LIGHT.z)).collect();
        scene.polygon(&shadow, -1e3 * size, color(SHADOW, 1.0, 1.0), false);

        // One face of eight cousins, picked without a pattern, starts a stroke along the field.
        if f % 8 != (f / 8).wrapping_mul(2_654_435_761) >> 29 || normal(f).dot(&towards_eye) < 0.0 {
            continue;
        }
        let (mut point, mut face) = (centres[f as usize], f);
        for step in 0..STEPS {
            let vector = vectors[face as usize];
            let speed = vector.norm() / fastest;
            let stride = vector.try_normalize(0.0).unwrap_or(vector) * (0.0015 + 0.0035 * speed) * size;
            let distance = |g: u32| (centres[g as usize] - point - stride).norm();
            face = around(face).min_by(|&g, &h| distance(g).total_cmp(&distance(h))).unwrap_or(face);
            let radius = fine.face_vertices(face).iter().map(|&v| (at(v) - centres[face as usize]).norm());
            if distance(face) > radius.fold(0.0, f64::max) {
                break; // over an edge that has nothing behind it
            }
            let off = normal(face).dot(&(point + stride - centres[face as usize]));
            let next = point + stride - normal(face) * off;
            let along = [step, step + 1].map(|t| f64::from(t) / f64::from(STEPS));
            let widths = along.map(|t| 0.0045 * size * t * (1.0 - t.powi(6)));
            scene.stroke([point, next], widths, 0.012 * size, color(speed_color(speed), 1.0, 1.0));
            point = next;
        }
    }

    // An edge of the cage and its descendants: the halves of its halves.
    let sharpness = &hierarchy.level(0).tags().edge_sharpness;
    let mut creases: Vec<(u32, f32)> =
        (0..).zip(sharpness.iter().copied()).filter(|&(_, s)| s > 0.0).collect();
    for level in 1..=hierarchy.num_levels() {
        let split = hierarchy.refinement(level).split();
        let halves = |e| [true, false].map(|along| split.even_edge(HalfEdge::new(e, along)));
        creases = creases.into_iter().flat_map(|(e, s)| halves(e).map(|half| (half, s))).collect();
    }
    for (e, sharpness) in creases {
        let ink = color([0.75, 0.10, 0.12], 1.0, if sharpness < 10.0 { 0.45 } else { 1.0 });
        scene.stroke(fine.edges()[e as usize].map(at), [0.0035 * size; 2], 0.02 * size, ink);
    }
    for ends in coarse.edges() {
        let [a, b] = ends.map(|v| asset.positions[v as usize]);
        let pieces = 32;
        for i in 0..pieces {
            let ends = [i, i + 1].map(|t| a + (b - a) * (f64::from(t) / f64::from(pieces)));
            scene.stroke(ends, [0.0012 * size; 2], 0.008 * size, color([0.25, 0.28, 0.35], 1.0, 0.55));
        }
    }

    let out = argument(3, "creased_box.png");
    scene.paint()?.save_png(&out)?;
    println!("{out}: {} faces, {} edges with a 1-form", fine.num_faces(), fine.num_edges());
    Ok(())
}
