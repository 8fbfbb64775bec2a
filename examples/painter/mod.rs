//! A painter for the examples: filled polygons in space, sorted by distance and painted from the back.
#![allow(dead_code)] // each example uses its own part

use nalgebra::{Matrix3, Vector3};
use tiny_skia::{Color, FillRule, FilterQuality, Paint, PathBuilder, Pixmap, PixmapPaint, Transform};

pub type Vec3 = Vector3<f64>;

pub const SIZE: [u32; 2] = [1400, 1000];
/// Drawn this many times larger, then averaged.
const OVERSAMPLING: u32 = 2;
/// From the eye to what it sees, in diagonals.
const DISTANCE: f64 = 2.2;

pub const LIGHT: Vec3 = Vec3::new(-0.5, -0.6, 0.9);
pub const SURFACE: [f64; 3] = [0.90, 0.89, 0.86];
pub const SHADOW: [f64; 3] = [0.88, 0.88, 0.90];
/// The field from slow to fast.
const SPEEDS: [[f64; 3]; 4] =
    [[0.13, 0.22, 0.45], [0.10, 0.52, 0.60], [0.93, 0.62, 0.20], [0.82, 0.20, 0.16]];

/// A perspective view whose rows are right, up and towards the eye.
pub struct Camera {
    rows: Matrix3<f64>,
    target: Vec3,
    /// The diagonal of what is looked at; the eye is a few times that away.
    pub size: f64,
    scale: f64,
    middle: [f64; 2],
}

impl Camera {
    /// Looks at points from the front, right and above, and fits them in the picture.
    pub fn facing(points: &[Vec3]) -> Self {
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

    pub fn eye(&self) -> Vec3 {
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

pub struct Scene {
    pub camera: Camera,
    patches: Vec<Patch>,
}

impl Scene {
    pub fn new(camera: Camera) -> Self {
        Scene { camera, patches: Vec::new() }
    }

    pub fn polygon(&mut self, points: &[Vec3], towards_eye: f64, color: Color, smooth: bool) {
        let centre = points.iter().sum::<Vec3>() / points.len() as f64;
        self.patches.push(Patch {
            depth: (centre - self.camera.eye()).norm() - towards_eye,
            points: points.iter().map(|&p| self.camera.project(p)).collect(),
            color,
            smooth,
        });
    }

    /// A stroke from `a` to `b`, `widths` wide at its ends, turned to the eye.
    pub fn stroke(&mut self, [a, b]: [Vec3; 2], widths: [f64; 2], towards_eye: f64, color: Color) {
        let across = (b - a).cross(&(self.camera.eye() - a));
        if let Some(side) = across.try_normalize(0.0) {
            let [wa, wb] = widths.map(|w| side * (w / 2.0));
            self.polygon(&[a - wa, b - wb, b + wb, a + wa], towards_eye, color, true);
        }
    }

    pub fn paint(mut self) -> Result<Pixmap, Box<dyn std::error::Error>> {
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

pub fn color([r, g, b]: [f64; 3], brightness: f64, alpha: f64) -> Color {
    let [r, g, b] = [r, g, b].map(|x| (x * brightness).clamp(0.0, 1.0) as f32);
    Color::from_rgba(r, g, b, alpha as f32).expect("clamped")
}

/// The colour of a speed between 0 and 1.
pub fn speed_color(speed: f64) -> [f64; 3] {
    let x = speed.clamp(0.0, 1.0) * (SPEEDS.len() - 1) as f64;
    let i = (x as usize).min(SPEEDS.len() - 2);
    [0, 1, 2].map(|c| SPEEDS[i][c] + (x - i as f64) * (SPEEDS[i + 1][c] - SPEEDS[i][c]))
}

/// A key light from the upper left, a weak one from below, on both sides of the surface.
pub fn brightness(normal: Vec3, to_eye: Vec3) -> f64 {
    let normal = if normal.dot(&to_eye) < 0.0 { -normal } else { normal };
    let key = normal.dot(&LIGHT.normalize()).max(0.0);
    let fill = normal.dot(&Vec3::new(0.9, -0.3, -0.2).normalize()).max(0.0);
    0.50 + 0.52 * key + 0.12 * fill
}
