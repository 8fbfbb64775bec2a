//! Functions on grids of points, as colours and lines of equal value.

use super::{Colour, Mark, Panel, Picture, Point};

/// Values at points of the plane, joined to triangles.
#[derive(Default)]
pub struct Grid {
    pub points: Vec<Point>,
    pub values: Vec<f64>,
    pub triangles: Vec<[usize; 3]>,
}

/// Shades of the colour scale: few enough that a picture is small, more than the eye tells apart.
const SHADES: usize = 192;
/// Lines of equal value on each side of 0.
const LINES: usize = 8;

const STOPS: [[f64; 3]; 7] = [
    [33.0, 60.0, 120.0],
    [67.0, 117.0, 180.0],
    [150.0, 190.0, 220.0],
    [248.0, 247.0, 243.0],
    [238.0, 170.0, 130.0],
    [206.0, 84.0, 66.0],
    [120.0, 20.0, 40.0],
];

/// Blue below 0, pale at 0, red above; `x` from -1 to 1.
pub fn diverging(x: f64) -> Colour {
    let place = (x.clamp(-1.0, 1.0) + 1.0) / 2.0 * (STOPS.len() - 1) as f64;
    let i = (place as usize).min(STOPS.len() - 2);
    let part = place - i as f64;
    [0, 1, 2].map(|k| (STOPS[i][k] + part * (STOPS[i + 1][k] - STOPS[i][k])).round() as u8)
}

impl Grid {
    /// Adds the points of one face, `rows` of them joined to triangles by their number in it.
    pub fn extend(&mut self, points: &[Point], values: &[f64], triangles: &[[usize; 3]]) {
        let first = self.points.len();
        self.points.extend(points);
        self.values.extend(values);
        self.triangles.extend(triangles.iter().map(|t| t.map(|i| first + i)));
    }

    /// The largest modulus; or, if a few values near an irregular vertex are much larger than all others, that which all but
    /// one in two hundred stay below.
    pub fn range(&self) -> f64 {
        let sizes = self.values.iter().map(|x| x.abs());
        let mut sizes: Vec<f64> = sizes.filter(|x| x.is_finite() && *x > 1e-9).collect();
        sizes.sort_by(f64::total_cmp);
        let Some(&most) = sizes.last() else { return 1e-12 };
        let nearly = sizes[(0.995 * (sizes.len() as f64 - 1.0)) as usize];
        if most < 1.6 * nearly { most } else { nearly }
    }

    /// Paints the values, `range` in the full colours, with lines of equal value. Triangles with a value that does not exist are left out.
    pub fn paint(&self, picture: &mut Picture, panel: &Panel, range: f64) {
        let placed = panel.place_all(&self.points);
        let mut shades: Vec<Vec<Vec<Point>>> = vec![Vec::new(); SHADES + 1];
        let mut lines = Vec::new();
        let mut zero = Vec::new();
        for t in &self.triangles {
            let values = t.map(|i| self.values[i] / range);
            // Outside its support a form is 0: nothing to see.
            if !values.iter().all(|x| x.is_finite()) || values.iter().all(|x| x.abs() < 1e-9) {
                continue;
            }
            let mean = (values.iter().sum::<f64>() / 3.0).clamp(-1.0, 1.0);
            let shade = ((mean + 1.0) / 2.0 * SHADES as f64).round() as usize;
            shades[shade].push(t.map(|i| placed[i]).to_vec());
            for level in 1..2 * LINES {
                let value = (level as f64 - LINES as f64) / LINES as f64;
                // Where a form dies out its sign is rounding.
                if level == LINES && values.iter().all(|x| x.abs() < 0.01) {
                    continue;
                }
                if let Some(line) = crossing(values.map(|x| x - value - 1e-9), t.map(|i| placed[i])) {
                    if level == LINES { zero.push(line) } else { lines.push(line) }
                }
            }
        }
        for (shade, polygons) in shades.into_iter().enumerate().filter(|(_, p)| !p.is_empty()) {
            let colour = diverging(2.0 * shade as f64 / SHADES as f64 - 1.0);
            picture.marks.push(Mark::Fill { polygons, colour });
        }
        picture.lines(lines, [90, 90, 96], 0.35);
        picture.lines(zero, [60, 60, 66], 0.6);
    }
}

/// Where a linear function on a triangle is 0.
fn crossing(values: [f64; 3], points: [Point; 3]) -> Option<Vec<Point>> {
    let mut ends = Vec::new();
    for (i, j) in [(0, 1), (1, 2), (2, 0)] {
        if (values[i] > 0.0) != (values[j] > 0.0) {
            let part = values[i] / (values[i] - values[j]);
            ends.push([0, 1].map(|k| points[i][k] + part * (points[j][k] - points[i][k])));
        }
    }
    (ends.len() == 2).then_some(ends)
}

/// The colours from `-range` to `range` in a bar, with numbers.
pub fn legend(picture: &mut Picture, corner: Point, size: Point, range: f64) {
    const STEPS: usize = 48;
    for step in 0..STEPS {
        let [a, b] = [step, step + 1].map(|s| corner[0] + size[0] * s as f64 / STEPS as f64);
        let colour = diverging((2.0 * step as f64 + 1.0) / STEPS as f64 - 1.0);
        let (low, high) = (corner[1], corner[1] + size[1]);
        let polygons = vec![vec![[a, low], [b, low], [b, high], [a, high]]];
        picture.marks.push(Mark::Fill { polygons, colour });
    }
    for (place, value) in [(0.0, -range), (0.5, 0.0), (1.0, range)] {
        let at = [corner[0] + place * size[0], corner[1] + size[1] + 13.0];
        let text = if value == 0.0 { "0".to_owned() } else { format!("{value:.2}") };
        picture.text(at, text, 10.5, super::INK, place);
    }
}
