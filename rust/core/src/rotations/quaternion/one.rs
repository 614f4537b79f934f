//! One quaternion: arrays `[w, x, y, z]`, all `#[inline(always)]`, to be used inside of SIMD bodies.

use crate::Real;

/// The quaternion in the first four elements of `row`.
#[inline(always)]
#[must_use]
pub fn of_row<T: Real>(row: &[T]) -> [T; 4] {
    [row[0], row[1], row[2], row[3]]
}

/// Hamilton product `a·b`: first the rotation `b`, then `a`.
#[inline(always)]
#[must_use]
pub fn product<T: Real>(a: [T; 4], b: [T; 4]) -> [T; 4] {
    [
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    ]
}

/// Conjugate, the inverse of a unit quaternion.
#[inline(always)]
#[must_use]
pub fn conjugate_one<T: Real>(q: [T; 4]) -> [T; 4] {
    [q[0], -q[1], -q[2], -q[3]]
}

/// `a⁻¹·b` of unit quaternions.
///
/// Terms that cancel for equal quaternions are adjacent, so the vector part of the result is exactly 0 for them.
#[inline(always)]
#[must_use]
pub fn between<T: Real>(a: [T; 4], b: [T; 4]) -> [T; 4] {
    [
        dot(a, b),
        (a[0] * b[1] - a[1] * b[0]) + (a[3] * b[2] - a[2] * b[3]),
        (a[0] * b[2] - a[2] * b[0]) + (a[1] * b[3] - a[3] * b[1]),
        (a[0] * b[3] - a[3] * b[0]) + (a[2] * b[1] - a[1] * b[2]),
    ]
}

/// Inner product in R⁴.
#[inline(always)]
#[must_use]
pub fn dot<T: Real>(a: [T; 4], b: [T; 4]) -> T {
    (a[0] * b[0] + a[1] * b[1]) + (a[2] * b[2] + a[3] * b[3])
}

/// The normalised quaternion.
#[inline(always)]
#[must_use]
pub fn unit<T: Real>(q: [T; 4]) -> [T; 4] {
    let scale = T::ONE / dot(q, q).sqrt();
    [q[0] * scale, q[1] * scale, q[2] * scale, q[3] * scale]
}

/// Quaternion logarithm `φ·u` of `(cos φ, sin φ·u)`, `φ ∈ [0, π]`: half the rotation vector.
///
/// The length of `q` does not matter. At `−1` the axis is not defined; the first one is taken.
#[inline(always)]
#[must_use]
pub fn log_one<T: Real>(q: [T; 4]) -> [T; 3] {
    let square = q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    // Not a sum: near −1 the result is `π·v/|v|`, which depends on every digit of the length. NaN propagates.
    let sine = (if square < T::TINY_SQUARE { T::TINY_SQUARE } else { square }).sqrt();
    let factor = sine.atan2_nonnegative(q[0]) / sine;
    let opposite = (square < T::TINY_SQUARE) & (q[0] <= T::ZERO);
    [
        if opposite { T::PI } else { q[1] * factor },
        if opposite { T::ZERO } else { q[2] * factor },
        if opposite { T::ZERO } else { q[3] * factor },
    ]
}

/// Quaternion logarithm of `q` or `−q`, whichever has `w ≥ 0`: half the rotation vector of the shorter rotation.
#[inline(always)]
#[must_use]
pub fn log_short<T: Real>(q: [T; 4]) -> [T; 3] {
    let square = q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    let sine = (square + T::TINY_SQUARE).sqrt();
    let factor = (sine.atan2_nonnegative(q[0].abs()) / sine).copysign(q[0]);
    [q[1] * factor, q[2] * factor, q[3] * factor]
}

/// Quaternion exponential `(cos φ, sin φ·u)` of `v = φ·u`, for `φ ≤` [`Real::SIN_COS_LIMIT`].
#[inline(always)]
#[must_use]
pub fn exp_one<T: Real>(v: [T; 3]) -> [T; 4] {
    let square = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    let angle = (square + T::TINY_SQUARE).sqrt();
    let (sine, cosine) = angle.sin_cos();
    let factor = sine / angle;
    [cosine, v[0] * factor, v[1] * factor, v[2] * factor]
}

/// Rotation angle between two rotations, in `[0, π]` radians.
///
/// The result does not depend on the lengths. Accurate to a few ulp for small and for large angles, unlike `acos`.
#[inline(always)]
#[must_use]
pub fn angle_between<T: Real>(a: [T; 4], b: [T; 4]) -> T {
    let d = between(a, b);
    let sine = (d[1] * d[1] + d[2] * d[2] + d[3] * d[3]).sqrt();
    T::TWO * sine.atan2_nonnegative(d[0].abs())
}

/// The rotation at the fraction `part` (0 … 1) of the shorter geodesic from `a` to `b`.
#[inline(always)]
#[must_use]
pub fn geodesic<T: Real>(a: [T; 4], b: [T; 4], part: T) -> [T; 4] {
    let way = log_short(between(a, b));
    product(a, exp_one([way[0] * part, way[1] * part, way[2] * part]))
}

/// The vector `v` rotated by the unit quaternion `q`.
#[inline(always)]
#[must_use]
pub fn rotate<T: Real>(q: [T; 4], v: [T; 3]) -> [T; 3] {
    let [w, x, y, z] = q;
    let t = [T::TWO * (y * v[2] - z * v[1]), T::TWO * (z * v[0] - x * v[2]), T::TWO * (x * v[1] - y * v[0])];
    [
        v[0] + w * t[0] + (y * t[2] - z * t[1]),
        v[1] + w * t[1] + (z * t[0] - x * t[2]),
        v[2] + w * t[2] + (x * t[1] - y * t[0]),
    ]
}

/// The same rotation with the other sign.
#[inline(always)]
#[must_use]
pub fn negative<T: Real>(q: [T; 4]) -> [T; 4] {
    [-q[0], -q[1], -q[2], -q[3]]
}

/// Whether the first non-zero component is negative: the half of S³ that does not contain the identity.
#[must_use]
pub fn lower<T: Real>(q: [T; 4]) -> bool {
    q.into_iter().find(|&x| x != T::ZERO).is_some_and(|x| x < T::ZERO)
}

/// Whether a sample is missing: a component that is not finite, or four zeros.
#[inline(always)]
#[must_use]
pub fn is_missing<T: Real>(q: [T; 4]) -> bool {
    let finite = q[0].is_finite() & q[1].is_finite() & q[2].is_finite() & q[3].is_finite();
    let zero = (q[0] == T::ZERO) & (q[1] == T::ZERO) & (q[2] == T::ZERO) & (q[3] == T::ZERO);
    !finite | zero
}
