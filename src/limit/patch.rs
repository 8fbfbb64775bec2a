//! Polynomial patches: what the limit is on a face whose surroundings are regular.
//!
//! On quads the limit forms are tensor B-splines of the level's own coefficients, `N3` and `N2` the uniform
//! cubic and quadratic B-splines on unit cells:
//!
//! ```text
//! 0-form   N3(s) N3(t)  on 4 x 4 vertices          2-form   N2(s) N2(t) ds^dt  on 3 x 3 faces
//! 1-form   N2(s) N3(t) ds  on 3 x 4 edges along s,   N3(s) N2(t) dt  on 4 x 3 edges along t
//! ```
//!
//! The coefficients are those of the grid row by row, of a 1-form those along `s` first.
//!
//! On triangles they are quartic (0- and 1-forms) and cubic (2-forms) polynomials in Bernstein form;
//! [`super::triangle`] has them.

use crate::sparse::Value;
use crate::topology::SplitKind;

/// A value with its derivatives by `s` and `t`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jet<T> {
    /// The value.
    pub value: T,
    /// Its derivatives.
    pub derivatives: [T; 2],
}

fn n3(x: f64) -> ([f64; 4], [f64; 4]) {
    let y = 1.0 - x;
    let (x2, y2) = (x * x, y * y);
    (
        [
            y2 * y / 6.0,
            (4.0 - 6.0 * x2 + 3.0 * x2 * x) / 6.0,
            (4.0 - 6.0 * y2 + 3.0 * y2 * y) / 6.0,
            x2 * x / 6.0,
        ],
        [-y2 / 2.0, 1.5 * x2 - 2.0 * x, 2.0 * y - 1.5 * y2, x2 / 2.0],
    )
}

fn n2(x: f64) -> ([f64; 3], [f64; 3]) {
    let y = 1.0 - x;
    ([y * y / 2.0, 0.5 + x * y, x * x / 2.0], [-y, 1.0 - 2.0 * x, x])
}

/// `sum_ij c[j][i] a_i b_j` with its derivatives.
#[inline]
fn tensor<const M: usize, const N: usize, T: Value>(
    c: &[T],
    (a, da): ([f64; M], [f64; M]),
    (b, db): ([f64; N], [f64; N]),
) -> Jet<T> {
    let zero = c[0] * 0.0;
    let (mut value, mut by_s, mut by_t) = (zero, zero, zero);
    for j in 0..N {
        let (mut sum, mut slope) = (zero, zero);
        for i in 0..M {
            let x = c[j * M + i];
            sum = sum + x * a[i];
            slope = slope + x * da[i];
        }
        value = value + sum * b[j];
        by_s = by_s + slope * b[j];
        by_t = by_t + sum * db[j];
    }
    Jet { value, derivatives: [by_s, by_t] }
}

/// The quartic with these Bernstein coefficients, in the order of [`super::triangle::exponents`]. One step of de
/// Casteljau's algorithm is left to the end, where it gives the derivatives: with the three cubics
/// `p_u, p_v, p_w` whose coefficients are those next to each other along the sides of the triangle,
///
/// ```text
/// p = u p_u + v p_v + w p_w        dp/ds = 4 (p_v - p_u)        dp/dt = 4 (p_w - p_u)
/// ```
#[inline]
fn quartic<T: Value>(c: &[T], s: f64, t: f64) -> Jet<T> {
    // Row k, those with w^k, begins at 0, 5, 9, 12, 14.
    const CORNERS: [[usize; 3]; 10] = [
        [0, 1, 5],
        [1, 2, 6],
        [2, 3, 7],
        [3, 4, 8],
        [5, 6, 9],
        [6, 7, 10],
        [7, 8, 11],
        [9, 10, 12],
        [10, 11, 13],
        [12, 13, 14],
    ];
    let (c, weights) = (&c[..15], cubics(s, t));
    let sides: [T; 3] = std::array::from_fn(|i| {
        let sum = c[CORNERS[0][i]] * weights[0];
        (1..10).fold(sum, |sum, m| sum + c[CORNERS[m][i]] * weights[m])
    });
    let [by_u, by_v, by_w] = sides;
    let value = by_u * (1.0 - s - t) + by_v * s + by_w * t;
    Jet { value, derivatives: [(by_v - by_u) * 4.0, (by_w - by_u) * 4.0] }
}

/// The Bernstein polynomials of degree 3.
#[inline]
fn cubics(s: f64, t: f64) -> [f64; 10] {
    let (u, v, w) = (1.0 - s - t, s, t);
    let (uu, vv, ww) = (u * u, v * v, w * w);
    let (u3, v3, w3) = (3.0 * u, 3.0 * v, 3.0 * w);
    [uu * u, uu * v3, u3 * vv, vv * v, uu * w3, u3 * 2.0 * v * w, vv * w3, u3 * ww, v3 * ww, ww * w]
}

/// A 0-form.
#[inline]
pub fn form0<T: Value>(kind: SplitKind, c: &[T], [s, t]: [f64; 2]) -> Jet<T> {
    match kind {
        SplitKind::Quad => tensor(c, n3(s), n3(t)),
        SplitKind::Triangle => quartic(c, s, t),
    }
}

/// The components of a 1-form along `s` and `t`.
#[inline]
pub fn form1<T: Value>(kind: SplitKind, c: &[T], [s, t]: [f64; 2]) -> [Jet<T>; 2] {
    match kind {
        SplitKind::Quad => [tensor(&c[..12], n2(s), n3(t)), tensor(&c[12..], n3(s), n2(t))],
        SplitKind::Triangle => [quartic(&c[..15], s, t), quartic(&c[15..], s, t)],
    }
}

/// The density of a 2-form, the factor of `ds^dt`.
#[inline]
pub fn form2<T: Value>(kind: SplitKind, c: &[T], [s, t]: [f64; 2]) -> T {
    match kind {
        SplitKind::Quad => tensor(c, n2(s), n2(t)).value,
        SplitKind::Triangle => {
            let sum = |sum, (&c, weight): (&T, f64)| sum + c * weight;
            c[1..10].iter().zip(cubics(s, t).into_iter().skip(1)).fold(c[0] * cubics(s, t)[0], sum)
        }
    }
}
