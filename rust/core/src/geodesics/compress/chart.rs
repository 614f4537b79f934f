//! Principal geodesic coordinates: a rotation as three successive rotations about the axes of a frame.
//!
//! `q = c · exp(s₁ v₁) · exp(s₂ v₂) · exp(s₃ v₃)` with orthonormal `v`. With `p = a⁻¹ c⁻¹ q a = exp(s₁ x) exp(s₂ y)
//! exp(s₃ z)`, where `a` rotates x, y and z to the axes,
//!
//! - `p_w + p_y = (cos s₂ + sin s₂) cos(s₁ + s₃)`, `p_x + p_z = (cos s₂ + sin s₂) sin(s₁ + s₃)`,
//! - `p_w − p_y = (cos s₂ − sin s₂) cos(s₁ − s₃)`, `p_x − p_z = (cos s₂ − sin s₂) sin(s₁ − s₃)`,
//!
//! so three geodesics reach every rotation, and the coordinates have full precision everywhere. Both radii may change
//! their sign. Then the path continues straight through points where an angle is not defined, and the angle about the
//! first axis is unbounded. The order of all operations is part of the format.

use crate::Real;
use crate::rotations::quaternion::{angle_between, conjugate_one, exp_one, log_short, product};
use crate::simd::multiversion;
use std::f64::consts::{FRAC_PI_2, PI};

/// Adding this to a number below 2⁵¹ rounds to an integer, ties to even.
const ROUND: f64 = 6_755_399_441_055_744.0;

/// Samples whose intermediate results fit in the first-level cache.
const CHUNK: usize = 64;

/// Coordinates of a path: three planes of `s`, half of the angles.
pub(super) type Coordinates = [Vec<f64>; 3];

/// A frame: its centre, and the rotation that takes x, y and z to its axes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    pub(super) centre: [f64; 4],
    pub(super) axes: [f64; 4],
}

#[inline(always)]
fn round_even(x: f64) -> f64 {
    (x + ROUND) - ROUND
}

#[inline(always)]
fn atan2(y: f64, x: f64) -> f64 {
    Real::copysign(Real::abs(y).atan2_nonnegative(x), y)
}

multiversion! {
    /// Angles and radii of both pairs, `[upper angle, lower angle, upper radius, lower radius]`.
    fn polar(path: &[[f64; 4]], left: [f64; 4], right: [f64; 4], out: &mut [Vec<f64>; 4]) {
        for (first, q) in path.chunks(CHUNK).enumerate() {
            let mut results = [[0.0; CHUNK]; 4];
            let mut near = [[1.0; CHUNK]; 4];
            for (i, q) in q.iter().enumerate() {
                for c in 0..4 {
                    near[c][i] = q[c];
                }
            }
            for i in 0..CHUNK {
                let q = [near[0][i], near[1][i], near[2][i], near[3][i]];
                let folded = q.map(|x| if q[0] < 0.0 { -x } else { x });
                let [w, x, y, z] = product(product(left, folded), right);
                let (ux, uy, lx, ly) = (w + y, x + z, w - y, x - z);
                results[0][i] = atan2(uy, ux);
                results[1][i] = atan2(ly, lx);
                results[2][i] = Real::sqrt(ux * ux + uy * uy);
                results[3][i] = Real::sqrt(lx * lx + ly * ly);
            }
            for (out, results) in out.iter_mut().zip(&results) {
                out[first * CHUNK..first * CHUNK + q.len()].copy_from_slice(&results[..q.len()]);
            }
        }
    }
}

multiversion! {
    /// The middle angle, from both radii.
    fn middle(upper: &[f64], lower: &[f64], out: &mut [f64]) {
        for ((&a, &b), out) in upper.iter().zip(lower).zip(out) {
            *out = atan2(a - b, a + b);
        }
    }
}

/// Shifts angles by whole periods so that successive ones differ by at most half a period. Calls `odd` for each
/// sample shifted by an odd number of periods.
fn unwrap(angles: &mut [f64], period: f64, mut odd: impl FnMut(usize)) {
    let mut turns = 0.0;
    let mut before = angles.first().copied().unwrap_or(0.0);
    for (i, angle) in angles.iter_mut().enumerate() {
        if i > 0 {
            turns += round_even((before - *angle) / period);
        }
        before = *angle;
        *angle += turns * period;
        if turns - 2.0 * (turns * 0.5).floor() != 0.0 {
            odd(i);
        }
    }
}

/// Coordinates of a path, continuous where the path is.
pub(super) fn coordinates(path: &[[f64; 4]], frame: Frame) -> Coordinates {
    let n = path.len();
    let left = conjugate_one(product(frame.centre, frame.axes));
    let mut planes: [Vec<f64>; 4] = std::array::from_fn(|_| vec![0.0; n]);
    polar(path, left, frame.axes, &mut planes);
    let [mut upper, mut lower, mut radius_upper, mut radius_lower] = planes;
    unwrap(&mut upper, PI, |i| radius_upper[i] = -radius_upper[i]);
    unwrap(&mut lower, PI, |i| radius_lower[i] = -radius_lower[i]);
    let mut second = vec![0.0; n];
    middle(&radius_upper, &radius_lower, &mut second);
    unwrap(&mut second, PI, |_| ());
    for (upper, lower) in upper.iter_mut().zip(&mut lower) {
        (*upper, *lower) = ((*upper + *lower) * 0.5, (*upper - *lower) * 0.5);
    }
    [upper, second, lower]
}

multiversion! {
    /// Rotations with these coordinates, rounded to `T` and widened again.
    fn compose<T: Real>(s: &Coordinates, left: [f64; 4], right: [f64; 4], out: &mut [[f64; 4]]) {
        for (first, out) in out.chunks_mut(CHUNK).enumerate() {
            let mut near = [[0.0; CHUNK]; 3];
            for (near, s) in near.iter_mut().zip(s) {
                near[..out.len()].copy_from_slice(&s[first * CHUNK..first * CHUNK + out.len()]);
            }
            let mut results = [[0.0; CHUNK]; 4];
            for i in 0..CHUNK {
                let (s1, c1) = Real::sin_cos(near[0][i]);
                let (s2, c2) = Real::sin_cos(near[1][i]);
                let (s3, c3) = Real::sin_cos(near[2][i]);
                let p = [
                    c1 * c2 * c3 - s1 * s2 * s3,
                    s1 * c2 * c3 + c1 * s2 * s3,
                    c1 * s2 * c3 - s1 * c2 * s3,
                    c1 * c2 * s3 + s1 * s2 * c3,
                ];
                let q = product(product(left, p), right);
                for c in 0..4 {
                    results[c][i] = T::from_f64(q[c]).to_f64();
                }
            }
            for (i, out) in out.iter_mut().enumerate() {
                *out = [results[0][i], results[1][i], results[2][i], results[3][i]];
            }
        }
    }
}

/// Rotations with these coordinates, as stored in `T`.
pub(super) fn rotations<T: Real>(s: &Coordinates, frame: Frame) -> Vec<[f64; 4]> {
    let mut out = vec![[0.0; 4]; s[0].len()];
    compose::<T>(s, product(frame.centre, frame.axes), conjugate_one(frame.axes), &mut out);
    out
}

multiversion! {
    /// The largest rotation angle between two paths; infinite if one is NaN.
    fn farthest(a: &[[f64; 4]], b: &[[f64; 4]]) -> f64 {
        let mut largest = 0.0;
        for (a, b) in a.chunks(CHUNK).zip(b.chunks(CHUNK)) {
            let mut near = [[[1.0; CHUNK]; 4]; 2];
            for (i, (a, b)) in a.iter().zip(b).enumerate() {
                for c in 0..4 {
                    near[0][c][i] = a[c];
                    near[1][c][i] = b[c];
                }
            }
            let mut results = [0.0; CHUNK];
            for i in 0..CHUNK {
                let a = [near[0][0][i], near[0][1][i], near[0][2][i], near[0][3][i]];
                let b = [near[1][0][i], near[1][1][i], near[1][2][i], near[1][3][i]];
                results[i] = angle_between(a, b);
            }
            for &angle in &results[..a.len().min(CHUNK)] {
                largest = if angle <= largest { largest } else if Real::is_nan(angle) { f64::INFINITY } else { angle };
            }
        }
        largest
    }
}

/// The largest rotation angle between the rotations of two paths.
pub(super) fn largest_angle(a: &[[f64; 4]], b: &[[f64; 4]]) -> f64 {
    farthest(a, b)
}

multiversion! {
    /// Largest residuals with the first 0, 1 or 2 coordinates, the largest coordinate, and the sine of the largest
    /// deviation of the angle between the first and the last axis from 90°.
    fn sizes(s: &Coordinates) -> [f64; 5] {
        let mut largest = [0.0; 5];
        for ((&a, &b), &c) in s[0].iter().zip(&s[1]).zip(&s[2]) {
            let two = b * b + c * c;
            let all = a * a + b * b + c * c;
            let coordinate = Real::max(Real::max(Real::abs(a), Real::abs(b)), Real::abs(c));
            let skew = Real::abs(Real::sin_cos(2.0 * b).0);
            for (largest, one) in largest.iter_mut().zip([all, two, Real::abs(c), coordinate, skew]) {
                *largest = Real::max(one, *largest);
            }
        }
        largest
    }
}

/// Residuals, as rotation angles, with the first 0, 1, 2 or all coordinates; the largest coordinate; and the skew of
/// the axes.
pub(super) fn left(s: &Coordinates) -> ([f64; 4], f64, f64) {
    let [all, two, last, coordinate, skew] = sizes(s);
    ([2.0 * Real::sqrt(all), 2.0 * Real::sqrt(two), 2.0 * last, 0.0], coordinate, skew)
}

multiversion! {
    /// Coordinates in fractions of a step, rounded.
    fn scaled(s: &[f64], scale: f64, out: &mut [i64]) {
        for (&s, out) in s.iter().zip(out) {
            // The integer is in the low bits of the shifted number.
            let shifted = s * scale + ROUND;
            *out = shifted.to_bits().wrapping_sub(ROUND.to_bits()).cast_signed();
        }
    }
}

/// Coordinates in fractions of a step, rounded; below 2⁵¹.
pub(super) fn in_steps(s: &[f64], scale: f64) -> Vec<i64> {
    let mut out = vec![0; s.len()];
    scaled(s, scale, &mut out);
    out
}

/// A rotation as three integers of `width` bits: its logarithm, in units of π/2.
#[allow(clippy::cast_possible_truncation, reason = "below 2³¹")]
pub(super) fn rounded(q: [f64; 4], width: u32) -> [i64; 3] {
    let scale = greatest(width) / FRAC_PI_2;
    log_short(q).map(|part| round_even(part * scale) as i64)
}

/// The rotation of three integers.
pub(super) fn from_rounded(numbers: [i64; 3], width: u32) -> [f64; 4] {
    let scale = FRAC_PI_2 / greatest(width);
    exp_one(numbers.map(|number| number as f64 * scale))
}

/// The largest signed number of `width` bits.
fn greatest(width: u32) -> f64 {
    ((1_i64 << (width - 1)) - 1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rotations::quaternion::unit;

    #[test]
    fn three_turns_reach_every_rotation() {
        let frame = Frame { centre: unit([0.3, -0.2, 0.9, 0.1]), axes: unit([0.5, 0.1, 0.2, -0.7]) };
        let path: Vec<[f64; 4]> = (0..5000)
            .map(|i| {
                let t = f64::from(i) * 0.02;
                unit([Real::sin_cos(t).0, Real::sin_cos(1.3 * t).1, Real::sin_cos(0.7 * t).0, 0.3])
            })
            .collect();
        let s = coordinates(&path, frame);
        assert!(largest_angle(&path, &rotations::<f64>(&s, frame)) < 1e-14);
    }
}
