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

    /// One, or the vector of ones.
    fn one() -> Self;

    /// The value times a weight.
    fn scale(self, weight: f64) -> Self;

    /// The value, or its negative, without a branch: signs of edges are as good as random.
    fn negate_if(self, negative: bool) -> Self;
}

/// An [`Quantity`] in double precision, with the multiplication written as such.
///
/// Implemented for every type with these operations, `f64` and `nalgebra::Vector3<f64>` among them.
pub trait Value: Quantity + Mul<f64, Output = Self> {}

impl<T: Quantity + Mul<f64, Output = T>> Value for T {}

impl Quantity for f64 {
    #[inline]
    fn negate_if(self, negative: bool) -> Self {
        f64::from_bits(self.to_bits() ^ (u64::from(negative) << 63))
    }

    #[inline]
    fn zero() -> Self {
        0.0
    }

    #[inline]
    fn one() -> Self {
        1.0
    }

    #[inline]
    fn scale(self, weight: f64) -> Self {
        self * weight
    }
}

impl Quantity for f32 {
    #[inline]
    fn negate_if(self, negative: bool) -> Self {
        f32::from_bits(self.to_bits() ^ (u32::from(negative) << 31))
    }

    #[inline]
    fn zero() -> Self {
        0.0
    }

    #[inline]
    fn one() -> Self {
        1.0
    }

    #[inline]
    fn scale(self, weight: f64) -> Self {
        self * weight as f32
    }
}

impl<const N: usize> Quantity for SVector<f64, N> {
    #[inline]
    fn negate_if(self, negative: bool) -> Self {
        self.map(|x| x.negate_if(negative))
    }

    #[inline]
    fn zero() -> Self {
        Self::zeros()
    }

    #[inline]
    fn one() -> Self {
        Self::repeat(1.0)
    }

    #[inline]
    fn scale(self, weight: f64) -> Self {
        self * weight
    }
}

impl<const N: usize> Quantity for SVector<f32, N> {
    #[inline]
    fn negate_if(self, negative: bool) -> Self {
        self.map(|x| x.negate_if(negative))
    }

    #[inline]
    fn zero() -> Self {
        Self::zeros()
    }

    #[inline]
    fn one() -> Self {
        Self::repeat(1.0)
    }

    #[inline]
    fn scale(self, weight: f64) -> Self {
        self * weight as f32
    }
}
