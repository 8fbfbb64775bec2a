//! Triangles into pixels, nearest first.

use nalgebra::Vector3;
use rayon::prelude::*;

/// Rows that one thread paints at a time.
const BAND: usize = 64;

/// A picture in the making.
pub(super) struct Raster {
    pub width: usize,
    pub height: usize,
    colours: Vec<[u8; 3]>,
    /// How near what is painted is; 0 is endlessly far away.
    near: Vec<f32>,
}

/// A triangle in pixels, the third coordinate being how near it is, with values at its corners that are interpolated.
#[derive(Clone)]
pub(super) struct Triangle<const N: usize> {
    pub points: [Vector3<f64>; 3],
    pub values: [[f32; N]; 3],
}

/// What hides a triangle, and what it hides.
#[derive(Clone, Copy)]
pub(super) enum Depth {
    /// Nothing hides it, and it hides nothing: the ground.
    Ground,
    /// What is nearer hides it, and it hides what is farther away.
    Solid,
    /// Ink on a surface: it hides nothing, and is hidden by what is nearer by more than this part of the distance.
    Ink(f32),
}

impl Raster {
    pub fn new(width: usize, height: usize, ground: [f64; 3]) -> Self {
        let colours = vec![ground.map(to_byte); width * height];
        Raster { width, height, colours, near: vec![0.0; width * height] }
    }

    /// Paints triangles one after the other. `shade` says the colour and the opacity of interpolated values.
    pub fn paint<const N: usize>(
        &mut self,
        triangles: &[Triangle<N>],
        depth: Depth,
        shade: impl Fn([f32; N]) -> [f32; 4] + Sync,
    ) {
        let (width, height) = (self.width, self.height);
        let bands = self.colours.par_chunks_mut(BAND * width).zip(self.near.par_chunks_mut(BAND * width));
        bands.enumerate().for_each(|(band, (colours, near))| {
            let (top, bottom) = (band * BAND, ((band + 1) * BAND).min(height));
            for triangle in triangles {
                let Some(edges) = Edges::new(&triangle.points) else { continue };
                for y in rows(&triangle.points, 1, top, bottom) {
                    for x in rows(&triangle.points, 0, 0, width) {
                        let Some(weights) = edges.weights(x as f64 + 0.5, y as f64 + 0.5) else { continue };
                        let mix = |of: [f32; 3]| (0..3).map(|i| weights[i] * of[i]).sum::<f32>();
                        let here = mix([0, 1, 2].map(|i| triangle.points[i].z as f32));
                        let place = (y - top) * width + x;
                        let visible = match depth {
                            Depth::Ground => true,
                            Depth::Solid => here > near[place],
                            Depth::Ink(bias) => here * (1.0 + bias) > near[place],
                        };
                        if !visible {
                            continue;
                        }
                        let values = std::array::from_fn(|k| mix([0, 1, 2].map(|i| triangle.values[i][k])));
                        let [r, g, b, alpha] = shade(values);
                        let below = colours[place];
                        colours[place] = std::array::from_fn(|k| {
                            let ink = 255.0 * [r, g, b][k].clamp(0.0, 1.0);
                            (f32::from(below[k]) + (ink - f32::from(below[k])) * alpha + 0.5) as u8
                        });
                        if matches!(depth, Depth::Solid) {
                            near[place] = here;
                        }
                    }
                }
            }
        });
    }

    /// The means of squares of `side` pixels.
    pub fn reduced(&self, side: usize) -> Vec<[u8; 3]> {
        let (width, height) = (self.width / side, self.height / side);
        let mean = |i: usize| {
            let (x, y) = (i % width * side, i / width * side);
            let square = (0..side * side).map(|k| self.colours[(y + k / side) * self.width + x + k % side]);
            let sums = square.fold([0u32; 3], |sum, c| [0, 1, 2].map(|k| sum[k] + u32::from(c[k])));
            let count = (side * side) as u32;
            sums.map(|sum| ((sum + count / 2) / count) as u8)
        };
        (0..width * height).into_par_iter().map(mean).collect()
    }
}

pub(super) fn to_byte(x: f64) -> u8 {
    (255.0 * x.clamp(0.0, 1.0) + 0.5) as u8
}

/// The pixels from `from` to `to` whose centres may lie in a triangle.
fn rows(points: &[Vector3<f64>; 3], axis: usize, from: usize, to: usize) -> std::ops::Range<usize> {
    let all = points.iter().map(|p| p[axis]);
    let (low, high) = (all.clone().fold(f64::MAX, f64::min), all.fold(f64::MIN, f64::max));
    let pixel = |x: f64| (x.clamp(from as f64, to as f64)) as usize;
    pixel((low - 0.5).ceil())..pixel((high - 0.5).floor() + 1.0)
}

/// A triangle that is not seen edge on.
struct Edges {
    origin: [f64; 2],
    /// The inverse of its edges.
    inverse: [[f64; 2]; 2],
}

impl Edges {
    fn new(points: &[Vector3<f64>; 3]) -> Option<Self> {
        let [a, b] = [1, 2].map(|i| [0, 1].map(|k| points[i][k] - points[0][k]));
        let determinant = a[0] * b[1] - a[1] * b[0];
        let inverse = [[b[1], -b[0]], [-a[1], a[0]]].map(|row| row.map(|x| x / determinant));
        let usable = inverse.iter().flatten().all(|x: &f64| x.is_finite());
        usable.then_some(Edges { origin: [points[0].x, points[0].y], inverse })
    }

    /// The weights of the corners at a point; `None` outside.
    fn weights(&self, x: f64, y: f64) -> Option<[f32; 3]> {
        let p = [x - self.origin[0], y - self.origin[1]];
        let [u, v] = self.inverse.map(|row| row[0] * p[0] + row[1] * p[1]);
        let w = 1.0 - u - v;
        // Neighbours share the pixels between them: none stays empty for rounding.
        (u >= -1e-9 && v >= -1e-9 && w >= -1e-9).then_some([w as f32, u as f32, v as f32])
    }
}
