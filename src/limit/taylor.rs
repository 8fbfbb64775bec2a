//! Truncated Taylor polynomials in two variables: values with all their derivatives, computed exactly.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// The highest order that is kept.
const MOST: usize = 5;
const TERMS: usize = (MOST + 1) * (MOST + 2) / 2;

/// A function of two variables near a point, up to terms of some order (5 at most): the value and the derivatives by
/// the variables. Arithmetic on them is exact differentiation; the order of a result is the least of its parts.
///
/// ```
/// use formwork::limit::Taylor;
///
/// let [x, y] = Taylor::variables([2.0, 0.5], 3);
/// let f = x * x * y.sin();
/// assert_eq!(f.derivative(2, 0), 2.0 * 0.5f64.sin());
/// assert!((f.derivative(1, 1) - 4.0 * 0.5f64.cos()).abs() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Taylor {
    order: usize,
    /// The coefficient of `ds^i dt^j` at `(i + j)(i + j + 1) / 2 + j`; 0 above the order.
    terms: [f64; TERMS],
}

const fn place(i: usize, j: usize) -> usize {
    (i + j) * (i + j + 1) / 2 + j
}

impl Taylor {
    /// A constant, of the highest order.
    pub const fn constant(value: f64) -> Self {
        let mut terms = [0.0; TERMS];
        terms[0] = value;
        Taylor { order: MOST, terms }
    }

    /// The linear function with a value and derivatives, up to an order.
    ///
    /// # Panics
    /// If the order exceeds 5.
    pub fn linear(value: f64, slopes: [f64; 2], order: usize) -> Self {
        assert!(order <= MOST, "Taylor polynomials have order {MOST} at most");
        let mut terms = [0.0; TERMS];
        terms[0] = value;
        if order > 0 {
            (terms[1], terms[2]) = (slopes[0], slopes[1]);
        }
        Taylor { order, terms }
    }

    /// The two variables at a point.
    ///
    /// # Panics
    /// If the order exceeds 5.
    pub fn variables(at: [f64; 2], order: usize) -> [Self; 2] {
        [Self::linear(at[0], [1.0, 0.0], order), Self::linear(at[1], [0.0, 1.0], order)]
    }

    /// The order.
    pub fn order(&self) -> usize {
        self.order
    }

    /// The value.
    pub fn value(&self) -> f64 {
        self.terms[0]
    }

    /// The derivative, `i` times by the first variable and `j` times by the second.
    ///
    /// # Panics
    /// If `i + j` exceeds the order.
    pub fn derivative(&self, i: usize, j: usize) -> f64 {
        assert!(i + j <= self.order, "a derivative above the order");
        let factorial = |n: usize| (1..=n).product::<usize>() as f64;
        self.terms[place(i, j)] * factorial(i) * factorial(j)
    }

    /// The derivative by a variable, of an order less.
    ///
    /// # Panics
    /// If the order is 0.
    pub fn by(&self, variable: usize) -> Self {
        assert!(self.order > 0, "a derivative above the order");
        let order = self.order - 1;
        let mut terms = [0.0; TERMS];
        for n in 0..=order {
            for j in 0..=n {
                let i = n - j;
                terms[place(i, j)] = match variable {
                    0 => (i + 1) as f64 * self.terms[place(i + 1, j)],
                    _ => (j + 1) as f64 * self.terms[place(i, j + 1)],
                };
            }
        }
        Taylor { order, terms }
    }

    /// The same up to a lower order.
    pub fn truncated(mut self, order: usize) -> Self {
        if order < self.order {
            self.order = order;
            self.terms[place(order + 1, 0)..].fill(0.0);
        }
        self
    }

    /// `f` of this, `series` being the coefficients of the Taylor series of `f` at its value.
    fn apply(&self, series: [f64; MOST + 1]) -> Self {
        let mut step = *self;
        step.terms[0] = 0.0;
        let mut sum = Self::constant(series[self.order]).truncated(self.order);
        for k in (0..self.order).rev() {
            sum = sum * step;
            sum.terms[0] += series[k];
        }
        sum
    }

    /// `1 / x`.
    pub fn recip(&self) -> Self {
        self.powf(-1.0)
    }

    /// The square root.
    pub fn sqrt(&self) -> Self {
        self.powf(0.5)
    }

    /// A power.
    pub fn powf(&self, power: f64) -> Self {
        let x = self.value();
        let mut binomial = 1.0;
        self.apply(std::array::from_fn(|k| {
            if k > 0 {
                binomial *= (power - (k - 1) as f64) / k as f64;
            }
            // Whole powers end: 0 times an infinity is none of theirs.
            if binomial == 0.0 { 0.0 } else { binomial * x.powf(power - k as f64) }
        }))
    }

    /// The exponential.
    pub fn exp(&self) -> Self {
        let e = self.value().exp();
        self.apply([e, e, e / 2.0, e / 6.0, e / 24.0, e / 120.0])
    }

    /// The natural logarithm.
    pub fn ln(&self) -> Self {
        let x = self.value();
        let r = 1.0 / x;
        self.apply(std::array::from_fn(|k| match k {
            0 => x.ln(),
            _ => -(-r).powi(k as i32) / k as f64,
        }))
    }

    /// The sine.
    pub fn sin(&self) -> Self {
        let (s, c) = self.value().sin_cos();
        self.apply([s, c, -s / 2.0, -c / 6.0, s / 24.0, c / 120.0])
    }

    /// The cosine.
    pub fn cos(&self) -> Self {
        let (s, c) = self.value().sin_cos();
        self.apply([c, -s, -c / 2.0, s / 6.0, c / 24.0, -s / 120.0])
    }

    /// The angle of the point `(x, self)`, from `-pi` to `pi`.
    pub fn atan2(&self, x: &Self) -> Self {
        let (b, a) = (self.value(), x.value());
        let ratio = (*self * a - *x * b) / (*x * a + *self * b);
        ratio.apply([b.atan2(a), 1.0, 0.0, -1.0 / 3.0, 0.0, 0.2])
    }

    /// This polynomial of two functions whose values are the point it is about.
    pub fn compose(&self, x: &Self, y: &Self) -> Self {
        let order = self.order.min(x.order).min(y.order);
        let (mut dx, mut dy) = (x.truncated(order), y.truncated(order));
        (dx.terms[0], dy.terms[0]) = (0.0, 0.0);
        let horner = |i: usize| {
            let mut sum = Self::constant(self.terms[place(i, order - i)]).truncated(order);
            for j in (0..order - i).rev() {
                sum = sum * dy;
                sum.terms[0] += self.terms[place(i, j)];
            }
            sum
        };
        (0..order).rev().fold(horner(order), |sum, i| sum * dx + horner(i))
    }
}

impl Add for Taylor {
    type Output = Taylor;
    #[inline]
    fn add(mut self, other: Taylor) -> Taylor {
        let order = self.order.min(other.order);
        self.terms.iter_mut().zip(&other.terms).for_each(|(a, b)| *a += b);
        if order == self.order.max(other.order) {
            return self;
        }
        self.order = MOST;
        self.truncated(order)
    }
}

impl Neg for Taylor {
    type Output = Taylor;
    fn neg(self) -> Taylor {
        self * -1.0
    }
}

impl Sub for Taylor {
    type Output = Taylor;
    fn sub(self, other: Taylor) -> Taylor {
        self.add(-other)
    }
}

impl Mul<f64> for Taylor {
    type Output = Taylor;
    #[inline]
    fn mul(mut self, factor: f64) -> Taylor {
        self.terms.iter_mut().for_each(|x| *x *= factor);
        self
    }
}

impl Mul for Taylor {
    type Output = Taylor;
    fn mul(self, other: Taylor) -> Taylor {
        let order = self.order.min(other.order);
        let mut terms = [0.0; TERMS];
        for n in 0..=order {
            for j in 0..=n {
                let a = self.terms[place(n - j, j)];
                for m in 0..=order - n {
                    for l in 0..=m {
                        terms[place(n - j + m - l, j + l)] += a * other.terms[place(m - l, l)];
                    }
                }
            }
        }
        Taylor { order, terms }
    }
}

impl Div for Taylor {
    type Output = Taylor;
    fn div(self, other: Taylor) -> Taylor {
        self.mul(other.recip())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(a: &Taylor, b: &Taylor) {
        assert_eq!(a.order, b.order);
        a.terms
            .iter()
            .zip(&b.terms)
            .for_each(|(a, b)| assert!((a - b).abs() < 1e-13 * (1.0 + b.abs()), "{a} {b}"));
    }

    #[test]
    fn functions_satisfy_their_identities() {
        let [x, y] = Taylor::variables([0.7, -0.4], 5);
        let one = Taylor::constant(1.0);
        near(&(x.sin() * x.sin() + x.cos() * x.cos()), &one);
        let z = x * x + y * y * 3.0 + x * y;
        near(&(z * z.recip()), &one);
        near(&(z.sqrt() * z.sqrt()), &z);
        near(&z.ln().exp(), &z);
        near(&z.powf(3.0), &(z * z * z));
        near(&(z.sqrt().recip() * z.sqrt().recip()), &z.recip());
        let (r, angle) = ((x * x + y * y).sqrt(), y.atan2(&x));
        near(&(r * angle.cos()), &x);
        near(&(r * angle.sin()), &y);
        // Derivatives of a monomial, at 0 too.
        let [x, y] = Taylor::variables([0.0, 2.0], 4);
        assert_eq!((x * x * y * y).derivative(2, 2), 4.0);
        assert_eq!(x.powf(2.0), x * x);
        assert_eq!((x * x * y).by(0).by(1).derivative(1, 0), 2.0);
    }

    #[test]
    fn composition_is_substitution() {
        let [s, t] = Taylor::variables([0.3, 0.2], 5);
        let (x, y) = (s * s - t, (s * t).exp());
        let [u, v] = Taylor::variables([x.value(), y.value()], 5);
        near(&(u * v.sin() + u * u * u).compose(&x, &y), &(x * y.sin() + x * x * x));
        near(&(u * v).truncated(2).compose(&x, &y), &(x * y).truncated(2));
    }
}
