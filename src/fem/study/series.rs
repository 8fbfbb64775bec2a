//! The solution of `-u_xx - u_yy = 1`, `u = 0` on the boundary of the L-shape, by particular solutions.

use nalgebra::{DMatrix, DVector};

use crate::limit::Taylor;

/// So many singular functions, fitted at so many points of each far side.
const TERMS: usize = 36;
const POINTS: usize = 60;

/// `u = p + sum_k a_k r^(2k/3) sin(2k t/3)` with `t` from the positive x axis round to the negative y axis, and
/// `p = -y^2/2 - (r^2 ln r sin 2t + r^2 t cos 2t) / (3 pi)`, which is 0 on both of them. The coefficients fit `u = 0` on the
/// other sides: Fox, Henrici, Moler, 1967. `a_1 = 0.40193` is a number others know too.
#[derive(Clone, Debug)]
pub struct Series {
    coefficients: Vec<f64>,
}

impl Series {
    /// Fits the coefficients.
    pub fn fit() -> Self {
        // From (1, 0) by (1, 1), (-1, 1), (-1, -1) to (0, -1), denser towards the ends of each.
        let corners = [[1.0, 0.0], [1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [0.0, -1.0]];
        let mut points = Vec::new();
        for side in corners.windows(2) {
            for i in 0..POINTS {
                let x = 0.5 - 0.5 * (std::f64::consts::PI * (i as f64 + 0.5) / POINTS as f64).cos();
                points.push([0, 1].map(|k| side[0][k] + x * (side[1][k] - side[0][k])));
            }
        }
        let at = |point: [f64; 2]| point.map(Taylor::constant).map(|x| x.truncated(0));
        // Scaled to 1 at the far corner.
        let scale = |k: usize| 2.0f64.powf(-(k as f64) / 3.0);
        let matrix = DMatrix::from_fn(points.len(), TERMS, |i, k| {
            let [x, y] = at(points[i]);
            singular(k + 1, x, y).value() * scale(k + 1)
        });
        let right = DVector::from_iterator(
            points.len(),
            points.iter().map(|&p| {
                let [x, y] = at(p);
                -particular(x, y).value()
            }),
        );
        let solution = matrix.svd(true, true).solve(&right, 1e-14).expect("both factors were asked for");
        Series { coefficients: (0..TERMS).map(|k| solution[k] * scale(k + 1)).collect() }
    }

    /// The solution at a point, which is not the corner that points inwards.
    pub fn at(&self, x: Taylor, y: Taylor) -> Taylor {
        let terms = self.coefficients.iter().enumerate();
        terms.fold(particular(x, y), |sum, (k, &a)| sum + singular(k + 1, x, y) * a)
    }

    /// `a_1`.
    pub fn leading(&self) -> f64 {
        self.coefficients[0]
    }
}

/// The angle from the positive x axis; it jumps in the quadrant that is missing.
fn angle(x: Taylor, y: Taylor) -> Taylor {
    (-x - y).atan2(&(y - x)) + Taylor::constant(0.75 * std::f64::consts::PI)
}

fn singular(k: usize, x: Taylor, y: Taylor) -> Taylor {
    let power = k as f64 / 3.0;
    (x * x + y * y).powf(power) * (angle(x, y) * (2.0 * power)).sin()
}

fn particular(x: Taylor, y: Taylor) -> Taylor {
    let (rr, t) = (x * x + y * y, angle(x, y));
    let log = (rr.ln() * (t * 2.0).sin() * 0.5 + t * (t * 2.0).cos()) * rr;
    y * y * -0.5 - log * (1.0 / (3.0 * std::f64::consts::PI))
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
            [[1.0, 0.3], [0.2, 1.0], [-1.0, 1.0], [-1.0, -0.6], [-0.4, -1.0], [0.6, 0.0], [0.0, -0.3]];
        for point in boundary {
            let [x, y] = point.map(|x| Taylor::linear(x, [0.0; 2], 0));
            assert!(series.at(x, y).value().abs() < 1e-5, "{point:?}: {:e}", series.at(x, y).value());
        }
        assert!((series.leading() - 0.4019).abs() < 1e-4, "{}", series.leading());
    }
}
