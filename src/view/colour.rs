//! Colours: one home for the page and the picture.

use nalgebra::Vector3;

/// Red, green and blue, from 0 to 1.
pub(super) type Rgb = [f64; 3];

/// The surface where nothing colours it.
pub(super) const SURFACE: Rgb = [0.90, 0.89, 0.86];
/// Its shadow on the ground of a picture.
pub(super) const SHADOW: Rgb = [0.905, 0.905, 0.92];
/// Sharp edges.
pub(super) const CREASE: Rgb = [0.75, 0.10, 0.12];
/// The control cage.
pub(super) const CAGE: Rgb = [0.25, 0.28, 0.35];
/// Zeros of index 1 and -1.
pub(super) const ZEROS: [Rgb; 2] = [[0.80, 0.15, 0.12], [0.12, 0.25, 0.65]];
/// The key light and the weak one from below.
pub(super) const LIGHTS: [[f64; 3]; 2] = [[-0.5, -0.6, 0.9], [0.9, -0.3, -0.2]];
/// How bright the surface is without light, and what each light adds.
pub(super) const BRIGHTNESS: [f64; 3] = [0.50, 0.52, 0.12];
/// Lines of equal height: as many bands from end to end of the scale, every other one a little darker.
pub(super) const BANDS: f64 = 24.0;

/// Colours for a scale, from its low end to its high one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ramp {
    /// Lengths: from dark blue by teal to orange and red.
    Speed,
    /// Values of no particular sign: from dark violet by green to yellow, even in lightness.
    Height,
    /// Values of either sign: from blue by the colour of the surface to red.
    Signed,
}

impl Ramp {
    /// The colours at equal distances.
    pub fn stops(self) -> &'static [[f64; 3]] {
        match self {
            Ramp::Speed => &[[0.13, 0.22, 0.45], [0.10, 0.52, 0.60], [0.93, 0.62, 0.20], [0.82, 0.20, 0.16]],
            Ramp::Height => &[
                [0.27, 0.20, 0.47],
                [0.22, 0.37, 0.60],
                [0.16, 0.55, 0.60],
                [0.30, 0.72, 0.50],
                [0.68, 0.84, 0.35],
                [0.98, 0.92, 0.45],
            ],
            Ramp::Signed => &[
                [0.13, 0.28, 0.55],
                [0.38, 0.60, 0.80],
                [0.90, 0.89, 0.86],
                [0.91, 0.58, 0.42],
                [0.68, 0.16, 0.16],
            ],
        }
    }

    /// The colour at a part of the scale; beyond its ends that of the end.
    pub fn at(self, part: f64) -> [f64; 3] {
        let stops = self.stops();
        let place = part.clamp(0.0, 1.0) * (stops.len() - 1) as f64;
        let i = (place as usize).min(stops.len() - 2);
        [0, 1, 2].map(|c| stops[i][c] + (stops[i + 1][c] - stops[i][c]) * (place - i as f64))
    }
}

/// How bright the surface is: a key light from the upper left, a weak one from below, on both sides.
pub(super) fn brightness(normal: Vector3<f64>, to_eye: Vector3<f64>) -> f64 {
    let normal = if normal.dot(&to_eye) < 0.0 { -normal } else { normal };
    let light = |k: usize| normal.dot(&Vector3::from(LIGHTS[k]).normalize()).max(0.0);
    BRIGHTNESS[0] + BRIGHTNESS[1] * light(0) + BRIGHTNESS[2] * light(1)
}
