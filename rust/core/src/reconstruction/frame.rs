//! Where a pose stands: heading about the up axis, and the place of the root.

use crate::Real;
use std::f64::consts::TAU;

/// The two level axes of each up axis, in the order in which a turn by 90 degrees about it takes the first to the second.
pub const HORIZONTAL: [[usize; 2]; 3] = [[1, 2], [2, 0], [0, 1]];

/// Angle of the turn of a rotation about the axis `up`, in `[−π, π]`, radians; 0 where a body hangs head down.
#[must_use]
pub fn heading(q: [f64; 4], up: usize) -> f64 {
    let along = q[1 + up] * 1.0_f64.copysign(q[0]);
    (2.0 * along.abs().atan2_nonnegative(q[0].abs())).copysign(along)
}

/// Quaternion of a turn about the axis `up` by an angle in radians.
#[must_use]
pub fn rotation_about(angle: f64, up: usize) -> [f64; 4] {
    let (sine, cosine) = Real::sin_cos(0.5 * (angle % (2.0 * TAU)));
    let mut q = [cosine, 0.0, 0.0, 0.0];
    q[1 + up] = sine;
    q
}

/// A step along the two level axes of a frame of this heading, as the world sees it.
#[must_use]
pub fn rotated(step: [f64; 2], angle: f64, up: usize) -> [f64; 3] {
    let [first, second] = HORIZONTAL[up];
    let (sine, cosine) = Real::sin_cos(angle % TAU);
    let mut result = [0.0; 3];
    result[first] = cosine * step[0] - sine * step[1];
    result[second] = sine * step[0] + cosine * step[1];
    result
}
