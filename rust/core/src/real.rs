//! float32 and float64 as one trait for generic kernels.

use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

/// A real number: `f32` or `f64`, with the elementary functions that vectorise.
///
/// The functions are defined in [`crate::elementary`], where their accuracy is stated.
pub trait Real:
    Copy
    + Debug
    + Default
    + PartialOrd
    + PartialEq
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + DivAssign
{
    /// 0.
    const ZERO: Self;
    /// 1/2.
    const HALF: Self;
    /// 1.
    const ONE: Self;
    /// 2.
    const TWO: Self;
    /// π.
    const PI: Self;
    /// π/2.
    const HALF_PI: Self;
    /// The distance from 1 to the next larger number.
    const EPSILON: Self;
    /// A square below which `x²` has lost digits to underflow.
    ///
    /// Added to the square of a sine or an angle, it avoids 0/0 in `φ / sin φ`: the ratio is even and smooth, so such
    /// a small shift of both has no effect.
    const TINY_SQUARE: Self;
    /// The smallest number whose square has full precision. Squares of smaller ones are many times slower.
    const LEAST_SQUARED: Self;
    /// The largest argument that [`Real::sin_cos`] reduces accurately.
    const SIN_COS_LIMIT: Self;
    /// The largest argument of [`Real::exp`].
    const EXP_LIMIT: Self;

    /// Rounds an `f64`.
    fn from_f64(x: f64) -> Self;
    /// Widens to `f64`.
    fn to_f64(self) -> f64;
    /// Square root, correctly rounded.
    #[must_use]
    fn sqrt(self) -> Self;
    /// Absolute value.
    #[must_use]
    fn abs(self) -> Self;
    /// The magnitude of `self` with the sign of `sign`.
    #[must_use]
    fn copysign(self, sign: Self) -> Self;
    /// Neither NaN nor infinite.
    #[must_use]
    fn is_finite(self) -> bool;
    /// Not a number.
    #[must_use]
    fn is_nan(self) -> bool;
    /// NaN.
    #[must_use]
    fn nan() -> Self;
    /// The integer part; 0 for negative numbers and NaN.
    #[must_use]
    fn to_count(self) -> usize;
    /// `exp(x)` for `x ≤` [`Real::EXP_LIMIT`]; exactly 0 where the result would be subnormal.
    #[must_use]
    fn exp(self) -> Self;
    /// `(sin x, cos x)` for `|x| ≤` [`Real::SIN_COS_LIMIT`].
    #[must_use]
    fn sin_cos(self) -> (Self, Self);
    /// The angle of the point `(x, self)` for `self ≥ 0`, in `[0, π]`; 0 at the origin.
    #[must_use]
    fn atan2_nonnegative(self, x: Self) -> Self;
    /// The squared angle `θ²` of a rotation whose unit quaternion has the chord `√self = 2 sin(θ/4)` to 1, for `self`
    /// in `[0, 2]`: `(4 asin(√self / 2))²`, computed without a square root.
    #[must_use]
    fn square_of_angle(self) -> Self;

    /// The smaller of two numbers; `other` if `self` is NaN.
    #[inline(always)]
    #[must_use]
    fn min(self, other: Self) -> Self {
        if self < other { self } else { other }
    }

    /// The larger of two numbers; `other` if `self` is NaN.
    #[inline(always)]
    #[must_use]
    fn max(self, other: Self) -> Self {
        if self > other { self } else { other }
    }
}
