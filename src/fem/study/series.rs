//! The solution of `-u_xx - u_yy = 1`, `u = 0` on the boundary of the L-shape, by particular solutions.

use std::f64::consts::PI;

use nalgebra::{DMatrix, DVector};

use crate::limit::Taylor;

/// So many powers, fitted at so many points of each far side.
const POWERS: usize = 30;
const POINTS: usize = 80;

/// The ends of the far sides, round from the positive x axis to the negative y axis.
const CORNERS: [[f64; 2]; 5] = [[1.0, 0.0], [1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [0.0, -1.0]];

/// `u = p + sum a_j Im f_j(w)`, `w = z^(2/3)`, with functions `f_j` that are real for real `w`: on the two sides at the
/// corner that points inwards, where `w` is real, all terms are 0. With `t` the angle from the positive x axis,
///
/// ```text
/// p = -y^2/2 - (r^2 ln r sin 2t + r^2 t cos 2t) / (3 pi)
/// f = w^k,  and for the singularities of the corners c of the far sides, at w_c,
/// f = q(w / w_c) + q(w / conj w_c),  i q(w / w_c) - i q(w / conj w_c),  q(x) = (1 - x)^k ln(1 - x),  k = 2, 3
/// ```
///
/// The coefficients fit `u = 0` on the far sides, to about 1e-8: Fox, Henrici, Moler, 1967, with the terms of
/// Gopal, Trefethen, 2019, for the other corners.
#[derive(Clone, Debug)]
pub struct Series {
    coefficients: Vec<f64>,
}

impl Series {
    /// Fits the coefficients.
    pub fn fit() -> Self {
        let mut points = Vec::new();
        for side in CORNERS.windows(2) {
            for i in 0..POINTS {
                // Denser towards the ends.
                let x = 0.5 - 0.5 * (PI * (i as f64 + 0.5) / POINTS as f64).cos();
                points.push([0, 1].map(|k| side[0][k] + x * (side[1][k] - side[0][k])));
            }
        }
        let at = |point: [f64; 2]| point.map(|x| Taylor::linear(x, [0.0; 2], 0));
        let rows: Vec<Vec<f64>> = points
            .iter()
            .map(|&point| terms(folded(at(point))).iter().map(Taylor::value).collect())
            .collect();
        let matrix = DMatrix::from_fn(rows.len(), rows[0].len(), |i, j| rows[i][j]);
        let right = points.iter().map(|&point| -particular(at(point)).value());
        let right = DVector::from_iterator(points.len(), right);
        let solution = matrix.svd(true, true).solve(&right, 1e-14).expect("both factors were asked for");
        Series { coefficients: solution.data.into() }
    }

    /// The solution at a point, which is none of the corners.
    pub fn at(&self, x: Taylor, y: Taylor) -> Taylor {
        let terms = terms(folded([x, y]));
        terms.iter().zip(&self.coefficients).fold(particular([x, y]), |sum, (&term, &a)| sum + term * a)
    }

    /// The factor of `r^(2/3) sin(2t/3)` in the solution at the corner that points inwards: 0.40193, as others found.
    pub fn leading(&self) -> f64 {
        let w = [Taylor::linear(0.0, [0.0; 2], 1), Taylor::linear(0.0, [1.0, 0.0], 1)];
        let slopes = terms(w).into_iter().map(|term| term.derivative(1, 0));
        slopes.zip(&self.coefficients).map(|(slope, a)| slope * a).sum()
    }
}

/// The angle from the positive x axis; it jumps in the quadrant that is missing.
fn angle([x, y]: [Taylor; 2]) -> Taylor {
    (-x - y).atan2(&(y - x)) + Taylor::constant(0.75 * PI)
}

fn particular([x, y]: [Taylor; 2]) -> Taylor {
    let (rr, t) = (x * x + y * y, angle([x, y]));
    let log = (rr.ln() * (t * 2.0).sin() * 0.5 + t * (t * 2.0).cos()) * rr;
    y * y * -0.5 - log * (1.0 / (3.0 * PI))
}

/// Real and imaginary part.
type Complex = [Taylor; 2];

fn times([a, b]: Complex, [c, d]: Complex) -> Complex {
    [a * c - b * d, a * d + b * c]
}

/// `w = z^(2/3)`: the corner that points inwards becomes a half plane.
fn folded([x, y]: [Taylor; 2]) -> Complex {
    let (size, angle) = ((x * x + y * y).powf(1.0 / 3.0), angle([x, y]) * (2.0 / 3.0));
    [size * angle.cos(), size * angle.sin()]
}

/// The imaginary parts of all `f_j`.
fn terms(w: Complex) -> Vec<Taylor> {
    let mut terms = Vec::with_capacity(POWERS + 16);
    // Scaled to size 1 at the farthest corners.
    let unit = w.map(|x| x * 0.5f64.powf(1.0 / 3.0));
    let mut power = unit;
    for _ in 0..POWERS {
        terms.push(power[1]);
        power = times(power, unit);
    }
    for corner in CORNERS {
        let [a, b] = folded(corner.map(|x| Taylor::linear(x, [0.0; 2], 0))).map(|x| x.value());
        let singular = |b: f64| {
            // 1 - w / (a + ib) and its logarithm: the cut is beyond the corner.
            let size = a * a + b * b;
            let over = [Taylor::constant(a / size), Taylor::constant(-b / size)];
            let [x, y] = times(w, over);
            let x = [Taylor::constant(1.0) - x, -y];
            let log = [(x[0] * x[0] + x[1] * x[1]).ln() * 0.5, x[1].atan2(&x[0])];
            let second = times(times(x, x), log);
            [second, times(x, second)]
        };
        // On the axis, but for rounding, the two are one.
        if b.abs() < 1e-9 {
            terms.extend(singular(0.0).map(|q| q[1]));
        } else {
            let (q, mirrored) = (singular(b), singular(-b));
            for (q, mirrored) in q.into_iter().zip(mirrored) {
                terms.push(q[1] + mirrored[1]);
                terms.push(q[0] - mirrored[0]);
            }
        }
    }
    terms
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_series_solves_its_problem() {
        let series = Series::fit();
        for point in [[0.5, 0.5], [-0.3, 0.7], [-0.9, -0.8], [-0.01, -0.02]] {
            let [x, y] = Taylor::variables(point, 2);
            let u = series.at(x, y);
            assert!((u.derivative(2, 0) + u.derivative(0, 2) + 1.0).abs() < 1e-8, "{point:?}");
        }
        let boundary =
            [[1.0, 0.3], [0.2, 1.0], [-0.999, 1.0], [-1.0, -0.6], [-0.4, -1.0], [0.6, 0.0], [0.0, -0.3]];
        for point in boundary {
            let [x, y] = point.map(|x| Taylor::linear(x, [0.0; 2], 0));
            assert!(series.at(x, y).value().abs() < 1e-7, "{point:?}: {:e}", series.at(x, y).value());
        }
        // 0.401931, by 160 powers alone, converged to the digits given.
        assert!((series.leading() - 0.401931).abs() < 1e-6, "{}", series.leading());
    }
}
