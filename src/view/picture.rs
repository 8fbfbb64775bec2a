use nalgebra::Vector3;
use tiny_skia::{IntSize, Pixmap};

use super::View;
use super::camera::Camera;
use super::colour::{self, Ramp, Rgb, brightness};
use super::raster::{Depth, Raster, Triangle};

type Vec3 = Vector3<f64>;

/// A painted view.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
    /// Red, green, blue; row by row from the top.
    pub pixels: Vec<[u8; 3]>,
}

/// Why a picture cannot be had.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)] // the messages say what the fields are
pub enum PictureError {
    #[error("{width}x{height} is not the size of a picture: choose from 16x16 to 16 million pixels")]
    Size { width: u32, height: u32 },
    #[error("the picture cannot be encoded ({0})")]
    Encoding(String),
}

impl Picture {
    /// The same as a PNG file.
    ///
    /// # Errors
    /// If it cannot be encoded.
    pub fn encode_png(&self) -> Result<Vec<u8>, PictureError> {
        let bytes = self.pixels.iter().flat_map(|&[r, g, b]| [r, g, b, 255]).collect();
        let size = IntSize::from_wh(self.width, self.height);
        let map = size.and_then(|size| Pixmap::from_vec(bytes, size));
        let size = PictureError::Size { width: self.width, height: self.height };
        map.ok_or(size)?.encode_png().map_err(|error| PictureError::Encoding(error.to_string()))
    }
}

impl View {
    /// Paints the view as the page shows it first, on white, on the CPU: the finest level from the front, the right and
    /// above, lit through its exact normals, and what [`View::layers`] says on it.
    ///
    /// The same picture for any number of threads.
    ///
    /// # Errors
    /// If the size is none.
    pub fn picture(&self, [width, height]: [u32; 2]) -> Result<Picture, PictureError> {
        let pixels = u64::from(width) * u64::from(height);
        if width.min(height) < 16 || pixels > 1 << 24 {
            return Err(PictureError::Size { width, height });
        }
        // Drawn this many times larger, then averaged.
        let oversampling = if pixels > 1 << 22 { 2 } else { 3 };
        let [wide, high] = [width, height].map(|n| n as usize * oversampling);
        let mut points: Vec<Vec3> = self.finest().vertices.iter().map(|v| v.position).collect();
        if self.layers.cage {
            points.extend(self.cage.iter().flatten());
        }
        let camera = Camera::facing(&points, self.bounds, [wide as f64, high as f64]);
        let mut canvas = Canvas { raster: Raster::new(wide, high, [1.0; 3]), camera, size: self.size() };
        self.paint_surface(&mut canvas);
        self.paint_layers(&mut canvas);
        let pixels = canvas.raster.reduced(oversampling);
        Ok(Picture { width, height, pixels })
    }

    fn paint_surface(&self, canvas: &mut Canvas) {
        let level = self.finest();
        let (camera, eye) = (&canvas.camera, canvas.camera.eye());
        let seen: Vec<Vec3> = level.vertices.iter().map(|v| camera.project(v.position)).collect();
        let triangles: Vec<[u32; 3]> = level.triangles().collect();

        let ground = level.vertices.iter().map(|v| v.position.z).fold(f64::MAX, f64::min);
        let light = Vec3::from(colour::LIGHTS[0]);
        let fall = |p: Vec3| camera.project(p - light * ((p.z - ground) / light.z));
        let fallen: Vec<Vec3> = level.vertices.iter().map(|v| fall(v.position)).collect();
        let shadow = |t: &[u32; 3]| Triangle { points: t.map(|v| fallen[v as usize]), values: [[]; 3] };
        let shadow: Vec<Triangle<0>> = triangles.iter().map(shadow).collect();

        let degree = self.degree.unwrap_or(1);
        let corner = |v: u32| {
            let vertex = &level.vertices[v as usize];
            let (n, e) = (vertex.normal, eye - vertex.position);
            [n.x, n.y, n.z, e.x, e.y, e.z, vertex.values[degree]].map(|x| x as f32)
        };
        let triangle = |t: &[u32; 3]| Triangle { points: t.map(|v| seen[v as usize]), values: t.map(corner) };
        let faces: Vec<Triangle<7>> = triangles.iter().map(triangle).collect();

        let [r, g, b] = colour::SHADOW.map(|x| x as f32);
        canvas.raster.paint(&shadow, Depth::Ground, |_| [r, g, b, 1.0]);
        let shown = self.forms[degree].as_ref().filter(|_| degree != 1);
        canvas.raster.paint(&faces, Depth::Solid, |values| {
            let [nx, ny, nz, ex, ey, ez, value] = values.map(f64::from);
            let normal = Vec3::new(nx, ny, nz).try_normalize(0.0).unwrap_or(Vec3::z());
            let ink = shown.map_or(colour::SURFACE, |shown| {
                let [low, high] = shown.scale;
                let part = (value - low) / (high - low);
                let dark = shown.ramp == Ramp::Height && (part * colour::BANDS).floor() % 2.0 != 0.0;
                shown.ramp.at(part).map(|x| if dark { 0.93 * x } else { x })
            });
            let [r, g, b] = ink.map(|x| (x * brightness(normal, Vec3::new(ex, ey, ez))) as f32);
            [r, g, b, 1.0]
        });
    }

    fn paint_layers(&self, canvas: &mut Canvas) {
        let (size, layers) = (self.size(), &self.layers);
        let speed = self.forms[1].as_ref().map_or(1.0, |shown| shown.scale[1]);
        // Over colours, strokes are dark and thin.
        let over = self.degree != Some(1);
        let ink = |of: f64| if over { [0.1, 0.12, 0.16] } else { Ramp::Speed.at(of / speed) };
        if layers.strokes {
            let mut ribbons = Vec::new();
            for stroke in &self.strokes {
                let last = stroke.times[stroke.times.len() - 1];
                let width = |i: usize| {
                    // Pointed where it comes from, round where it goes.
                    let t = if last > 0.0 { stroke.times[i] / last } else { 0.0 };
                    (if over { 0.002 } else { 0.0042 }) * size * t * (1.0 - t.powi(8))
                };
                for i in 1..stroke.points.len() {
                    let ends = [stroke.points[i - 1], stroke.points[i]];
                    let colours = [stroke.speeds[i - 1], stroke.speeds[i]].map(ink);
                    ribbons.extend(canvas.ribbon(ends, [width(i - 1), width(i)], colours));
                }
            }
            canvas.ink(&ribbons, 0.006, if over { 0.35 } else { 1.0 });
        }
        if layers.arrows {
            let arrows: Vec<Triangle<3>> = self
                .arrows
                .iter()
                .flat_map(|arrow| self.arrow(canvas, arrow, ink(arrow.vector.norm())))
                .collect();
            canvas.ink(&arrows, 0.006, 1.0);
        }
        if layers.creases {
            for (ends, sharpness) in &self.creases {
                let ribbon = canvas.ribbon(*ends, [0.0035 * size; 2], [colour::CREASE; 2]);
                canvas.ink(&ribbon, 0.008, if *sharpness < 10.0 { 0.45 } else { 1.0 });
            }
        }
        if layers.cage {
            // A long line leaves the distance that its ends have.
            let pieces = 32;
            let part = |[a, b]: [Vec3; 2], i: i32| a + (b - a) * (f64::from(i) / f64::from(pieces));
            let ribbons = self
                .cage
                .iter()
                .flat_map(|&ends| (0..pieces).flat_map(move |i| [(part(ends, i), part(ends, i + 1))]));
            let ribbons: Vec<Triangle<3>> = ribbons
                .flat_map(|(a, b)| canvas.ribbon([a, b], [0.0012 * size; 2], [colour::CAGE; 2]))
                .collect();
            canvas.ink(&ribbons, 0.004, 0.55);
        }
        if layers.zeros {
            for zero in &self.zeros {
                let fill = colour::ZEROS[usize::from(zero.index < 0)];
                for (radius, ink) in [(0.0105, [1.0; 3]), (0.0085, fill)] {
                    let disc = canvas.disc(zero.position, radius * size, ink);
                    canvas.ink(&disc, 0.01, 1.0);
                }
            }
        }
    }

    /// An arrow lies on the surface, its length and its width in proportion to the vector's.
    fn arrow(&self, canvas: &Canvas, arrow: &super::Arrow, ink: Rgb) -> Vec<Triangle<3>> {
        let fast = self.forms[1].as_ref().map_or(1.0, |shown| shown.scale[1]);
        let speed = arrow.vector.norm();
        let [rest, full] = ARROW_LENGTHS;
        let length = self.size() * (rest + (full - rest) * (speed / fast).min(1.0));
        let along = arrow.vector / speed;
        let across = arrow.normal.cross(&along);
        let at = |p: [f64; 2]| arrow.position + (along * p[0] + across * p[1]) * length;
        let triangles = ARROW.map(|t| t.map(|i| canvas.camera.project(at(ARROW_POINTS[i]))));
        triangles.map(|points| Triangle { points, values: [ink.map(|x| x as f32); 3] }).to_vec()
    }
}

/// An arrow of length 1 along the first axis, about its middle.
pub(super) const ARROW_POINTS: [[f64; 2]; 7] =
    [[-0.5, 0.045], [-0.5, -0.045], [0.12, -0.045], [0.12, 0.045], [0.12, 0.17], [0.12, -0.17], [0.5, 0.0]];
/// Its triangles.
pub(super) const ARROW: [[usize; 3]; 3] = [[0, 1, 2], [0, 2, 3], [4, 5, 6]];

/// How long arrows are at rest and at full speed, in diagonals.
pub(super) const ARROW_LENGTHS: [f64; 2] = [0.018, 0.05];

struct Canvas {
    raster: Raster,
    camera: Camera,
    size: f64,
}

impl Canvas {
    /// A band from end to end, turned to the eye.
    fn ribbon(&self, [a, b]: [Vec3; 2], widths: [f64; 2], colours: [Rgb; 2]) -> Vec<Triangle<3>> {
        let across = (b - a).cross(&(self.camera.eye() - a));
        let Some(side) = across.try_normalize(0.0) else { return Vec::new() };
        let [wa, wb] = widths.map(|w| side * (w / 2.0));
        let [p, q, r, s] = [a - wa, b - wb, b + wb, a + wa].map(|p| self.camera.project(p));
        let [from, to] = colours.map(|colour| colour.map(|x| x as f32));
        vec![
            Triangle { points: [p, q, r], values: [from, to, to] },
            Triangle { points: [p, r, s], values: [from, to, from] },
        ]
    }

    /// A disc turned to the eye.
    fn disc(&self, centre: Vec3, radius: f64, ink: Rgb) -> Vec<Triangle<3>> {
        let towards = (self.camera.eye() - centre).try_normalize(1e-9 * self.size).unwrap_or(Vec3::z());
        let u = towards.cross(&Vec3::z()).try_normalize(0.0).unwrap_or(Vec3::x());
        let v = towards.cross(&u);
        let at = |k: usize| {
            let angle = std::f64::consts::TAU * k as f64 / 32.0;
            self.camera.project(centre + (u * angle.cos() + v * angle.sin()) * radius)
        };
        let middle = self.camera.project(centre);
        let values = [ink.map(|x| x as f32); 3];
        (0..32).map(|k| Triangle { points: [middle, at(k), at(k + 1)], values }).collect()
    }

    fn ink(&mut self, triangles: &[Triangle<3>], bias: f32, alpha: f32) {
        self.raster.paint(triangles, Depth::Ink(bias), |[r, g, b]| [r, g, b, alpha]);
    }
}
