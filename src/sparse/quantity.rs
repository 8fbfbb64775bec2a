//! What a cochain may hold.

use std::ops::{Add, Mul, Sub};

use nalgebra::SVector;

/// What a cochain may hold and an operator may act on: a number or a vector of a few numbers, in double or
/// single precision. Weights are `f64` and rounded to the precision of the values.
///
/// Implemented for `f64`, `f32`, and `nalgebra`'s vectors of them, `Vector3<f64>` among them.
pub trait Quantity: Copy + Send + Sync + Add<Output = Self> + Sub<Output = Self> {
    /// The zero.
    fn zero() -> Self;

    /// The value times a weight.
    fn scale(self, weight: f64) -> Self;
}

/// An [`Quantity`] in double precision, with the multiplication written as such.
///
/// Implemented for every type with these operations, `f64` and `nalgebra::Vector3<f64>` among them.
pub trait Value: Quantity + Mul<f64, Output = Self> {}

impl<T: Quantity + Mul<f64, Output = T>> Value for T {}

impl Quantity for f64 {
    fn zero() -> Self {
        0.0
    }

    #[inline]
    fn scale(self, weight: f64) -> Self {
        self * weight
    }
}

impl Quantity for f32 {
    fn zero() -> Self {
        0.0
    }

    #[inline]
    fn scale(self, weight: f64) -> Self {
        self * weight as f32
    }
}

impl<const N: usize> Quantity for SVector<f64, N> {
    fn zero() -> Self {
        Self::zeros()
    }

    #[inline]
    fn scale(self, weight: f64) -> Self {
        self * weight
    }
}

impl<const N: usize> Quantity for SVector<f32, N> {
    fn zero() -> Self {
        Self::zeros()
    }

    #[inline]
    fn scale(self, weight: f64) -> Self {
        self * weight as f32
    }
}
