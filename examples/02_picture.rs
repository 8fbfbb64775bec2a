//! Draws a refined cage with the tangent field of its 1-form, on the CPU.
//!
//! ```text
//! cargo run --release --example 02_picture -- [MESH.obj [FIELD.json [OUT.png [LEVELS]]]]
//! ```
//!
//! Everything drawn is a filled polygon in space: faces, field strokes, creases, the control cage. They
//! are sorted by distance and painted from the back (the painter's algorithm); what lies on the surface
//! is moved a little towards the eye.

use std::path::Path;

use formwork::cochain::Cochain;
use formwork::field::{face_centres, face_vectors};
use formwork::hierarchy::Hierarchy;
use formwork::io::{fields, obj};
use formwork::scheme::Scheme;
use formwork::topology::HalfEdge;
use nalgebra::{Matrix3, Vector3};
use tiny_skia::{Color, FillRule, FilterQuality, Paint, PathBuilder, Pixmap, PixmapPaint, Transform};

type Vec3 = Vector3<f64>;

const SIZE: [u32; 2] = [1400, 1000];
/// Drawn this many times larger, then averaged.
const OVERSAMPLING: u32 = 2;
/// A stroke follows the field for so many steps.
const STEPS: u32 = 14;
/// From the eye to what it sees, in diagonals.
const DISTANCE: f64 = 2.2;

const LIGHT: Vec3 = Vec3::new(-0.5, -0.6, 0.9);
const SURFACE: [f64; 3] = [0.90, 0.89, 0.86];
const SHADOW: [f64; 3] = [0.88, 0.88, 0.90];
/// The field from slow to fast.
const SPEEDS: [[f64; 3]; 4] =
    [[0.13, 0.22, 0.45], [0.10, 0.52, 0.60], [0.93, 0.62, 0.20], [0.82, 0.20, 0.16]];

/// A perspective view whose rows are right, up and towards the eye.
struct Camera {
    rows: Matrix3<f64>,
    target: Vec3,
    /// The diagonal of what is looked at; the eye is a few times that away.
    size: f64,
    scale: f64,
    middle: [f64; 2],
}

impl Camera {
    /// Looks at points from the front, right and above, and fits them in the picture.
    fn facing(points: &[Vec3]) -> Self {
        let low = points.iter().fold(points[0], |a, b| a.inf(b));
        let high = points.iter().fold(points[0], |a, b| a.sup(b));
        let forward = Vec3::new(0.52, -1.0, 0.62).normalize();
        let right = Vec3::z().cross(&forward).normalize();
        let rows = Matrix3::from_rows(&[right, forward.cross(&right), forward].map(|r| r.transpose()));
        let size = (high - low).norm().max(1e-9);
        let mut camera = Camera { rows, target: (low + high) / 2.0, size, scale: 1.0, middle: [0.0; 2] };
        let seen: Vec<[f64; 2]> = points.iter().map(|&p| camera.project(p)).collect();
        let side = |axis: usize, sign: f64| seen.iter().map(|p| sign * p[axis]).fold(f64::MIN, f64::max);
        camera.scale = f64::MAX;
        for axis in [0, 1] {
            let (low, high) = (-side(axis, -1.0), side(axis, 1.0));
            camera.middle[axis] = (low + high) / 2.0;
            camera.scale = camera.scale.min(0.92 * f64::from(SIZE[axis] * OVERSAMPLING) / (high - low));
        }
        camera
    }

    fn eye(&self) -> Vec3 {
        self.target + self.rows.row(2).transpose() * (DISTANCE * self.size)
    }

    /// Pixels right and up from the middle of the picture.
    fn project(&self, p: Vec3) -> [f64; 2] {
        let q = self.rows * (p - self.target);
        let shrink = 1.0 / (1.0 - q.z / (DISTANCE * self.size));
        [0, 1].map(|axis| self.scale * (shrink * q[axis] - self.middle[axis]))
    }
}

/// A polygon to be painted.
struct Patch {
    depth: f64,
    points: Vec<[f64; 2]>,
    color: Color,
    smooth: bool,
}

struct Scene {
    camera: Camera,
    patches: Vec<Patch>,
}

impl Scene {
    fn polygon(&mut self, points: &[Vec3], towards_eye: f64, color: Color, smooth: bool) {
        let centre = points.iter().sum::<Vec3>() / points.len() as f64;
        self.patches.push(Patch {
            depth: (centre - self.camera.eye()).norm() - towards_eye,
            points: points.iter().map(|&p| self.camera.project(p)).collect(),
            color,
            smooth,
        });
    }

    /// A stroke from `a` to `b`, `widths` wide at its ends, turned to the eye.
    fn stroke(&mut self, [a, b]: [Vec3; 2], widths: [f64; 2], towards_eye: f64, color: Color) {
        let across = (b - a).cross(&(self.camera.eye() - a));
        if let Some(side) = across.try_normalize(0.0) {
            let [wa, wb] = widths.map(|w| side * (w / 2.0));
            self.polygon(&[a - wa, b - wb, b + wb, a + wa], towards_eye, color, true);
        }
    }

    fn paint(mut self) -> Result<Pixmap, Box<dyn std::error::Error>> {
        self.patches.sort_by(|a, b| b.depth.total_cmp(&a.depth));
        let [width, height] = SIZE.map(|n| n * OVERSAMPLING);
        let mut large = Pixmap::new(width, height).ok_or("no picture that large")?;
        large.fill(Color::WHITE);
        for patch in &self.patches {
            let mut path = PathBuilder::new();
            for (i, [x, y]) in patch.points.iter().enumerate() {
                let (x, y) = ((f64::from(width) / 2.0 + x) as f32, (f64::from(height) / 2.0 - y) as f32);
                if i == 0 { path.move_to(x, y) } else { path.line_to(x, y) }
            }
            path.close();
            let Some(path) = path.finish() else { continue };
            let mut paint = Paint { anti_alias: patch.smooth, ..Default::default() };
            paint.set_color(patch.color);
            large.fill_path(&path, &paint, FillRule::Winding, Transform::identity(), None);
        }
        let mut picture = Pixmap::new(SIZE[0], SIZE[1]).ok_or("no picture that large")?;
        let average = PixmapPaint { quality: FilterQuality::Bilinear, ..Default::default() };
        let shrink = Transform::from_scale(1.0 / OVERSAMPLING as f32, 1.0 / OVERSAMPLING as f32);
        picture.draw_pixmap(0, 0, large.as_ref(), &average, shrink, None);
        Ok(picture)
    }
}

fn color([r, g, b]: [f64; 3], brightness: f64, alpha: f64) -> Color {
    let [r, g, b] = [r, g, b].map(|x| (x * brightness).clamp(0.0, 1.0) as f32);
    Color::from_rgba(r, g, b, alpha as f32).expect("clamped")
}

/// The colour of a speed between 0 and 1.
fn speed_color(speed: f64) -> [f64; 3] {
    let x = speed.clamp(0.0, 1.0) * (SPEEDS.len() - 1) as f64;
    let i = (x as usize).min(SPEEDS.len() - 2);
    [0, 1, 2].map(|c| SPEEDS[i][c] + (x - i as f64) * (SPEEDS[i + 1][c] - SPEEDS[i][c]))
}

/// A key light from the upper left, a weak one from below, on both sides of the surface.
fn brightness(normal: Vec3, to_eye: Vec3) -> f64 {
    let normal = if normal.dot(&to_eye) < 0.0 { -normal } else { normal };
    let key = normal.dot(&LIGHT.normalize()).max(0.0);
    let fill = normal.dot(&Vec3::new(0.9, -0.3, -0.2).normalize()).max(0.0);
    0.50 + 0.52 * key + 0.12 * fill
}

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
    let mut scene = Scene { camera, patches: Vec::new() };

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
