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
//! On triangles they are quartic (0- and 1-forms) and cubic (2-forms) polynomials, homogeneous in the
//! barycentric coordinates; [`super::triangle`] has them.

use crate::sparse::Value;
use crate::topology::SplitKind;

/// Numbers of coefficients of a patch, by degree: grids of 16 vertices, 24 edges (those along `s` first, row by
/// row), 9 faces; polynomials of 15, two times 15, 10 coefficients.
pub fn sizes(kind: SplitKind) -> [usize; 3] {
    match kind {
        SplitKind::Quad => [16, 24, 9],
        SplitKind::Triangle => [15, 30, 10],
    }
}

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

/// The monomials `u^i v^j w^k` of degree `N` with `u = 1 - s - t`, `v = s`, `w = t`, in the order of
/// [`super::triangle::exponents`], contracted with the coefficients.
#[inline]
fn polynomial<const N: usize, T: Value>(c: &[T], s: f64, t: f64) -> Jet<T> {
    let zero = c[0] * 0.0;
    let powers = |x: f64| {
        let mut p = [1.0; 5];
        for i in 1..=N {
            p[i] = p[i - 1] * x;
        }
        p
    };
    let (u, v, w) = (powers(1.0 - s - t), powers(s), powers(t));
    let slope = |p: &[f64; 5], i: usize| if i == 0 { 0.0 } else { i as f64 * p[i - 1] };
    let (mut value, mut by_s, mut by_t) = (zero, zero, zero);
    let mut at = 0;
    for k in 0..=N {
        for j in 0..=N - k {
            let i = N - k - j;
            let x = c[at];
            at += 1;
            let by_u = slope(&u, i) * v[j] * w[k];
            value = value + x * (u[i] * v[j] * w[k]);
            by_s = by_s + x * (u[i] * slope(&v, j) * w[k] - by_u);
            by_t = by_t + x * (u[i] * v[j] * slope(&w, k) - by_u);
        }
    }
    Jet { value, derivatives: [by_s, by_t] }
}

/// A 0-form.
#[inline]
pub fn form0<T: Value>(kind: SplitKind, c: &[T], [s, t]: [f64; 2]) -> Jet<T> {
    match kind {
        SplitKind::Quad => tensor(c, n3(s), n3(t)),
        SplitKind::Triangle => polynomial::<4, T>(c, s, t),
    }
}

/// The components of a 1-form along `s` and `t`.
#[inline]
pub fn form1<T: Value>(kind: SplitKind, c: &[T], [s, t]: [f64; 2]) -> [Jet<T>; 2] {
    match kind {
        SplitKind::Quad => [tensor(&c[..12], n2(s), n3(t)), tensor(&c[12..], n3(s), n2(t))],
        SplitKind::Triangle => [polynomial::<4, T>(&c[..15], s, t), polynomial::<4, T>(&c[15..], s, t)],
    }
}

/// The density of a 2-form, the factor of `ds^dt`.
#[inline]
pub fn form2<T: Value>(kind: SplitKind, c: &[T], [s, t]: [f64; 2]) -> T {
    match kind {
        SplitKind::Quad => tensor(c, n2(s), n2(t)).value,
        SplitKind::Triangle => polynomial::<3, T>(c, s, t).value,
    }
}
