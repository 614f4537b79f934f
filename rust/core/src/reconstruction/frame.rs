//! Position and heading of the root about the up axis.

use crate::Real;
use std::f64::consts::TAU;

/// The two horizontal axes for each up axis, ordered so that a rotation by 90° about the up axis takes the first to
/// the second.
pub const HORIZONTAL: [[usize; 2]; 3] = [[1, 2], [2, 0], [0, 1]];

/// Heading: the rotation angle about the axis `up`, in `[−π, π]`, radians; 0 where the up axis points down.
#[must_use]
pub fn heading(q: [f64; 4], up: usize) -> f64 {
    let along = q[1 + up] * 1.0_f64.copysign(q[0]);
    (2.0 * along.abs().atan2_nonnegative(q[0].abs())).copysign(along)
}

/// Quaternion of a rotation about the axis `up` by an angle in radians.
#[must_use]
pub fn rotation_about(angle: f64, up: usize) -> [f64; 4] {
    let (sine, cosine) = Real::sin_cos(0.5 * (angle % (2.0 * TAU)));
    let mut q = [cosine, 0.0, 0.0, 0.0];
    q[1 + up] = sine;
    q
}

/// World coordinates of a step along the two horizontal axes of a frame with the heading `angle`.
#[must_use]
pub fn rotated(step: [f64; 2], angle: f64, up: usize) -> [f64; 3] {
    let [first, second] = HORIZONTAL[up];
    let (sine, cosine) = Real::sin_cos(angle % TAU);
    let mut result = [0.0; 3];
    result[first] = cosine * step[0] - sine * step[1];
    result[second] = sine * step[0] + cosine * step[1];
    result
}
