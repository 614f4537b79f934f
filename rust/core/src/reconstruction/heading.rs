//! Heading of a body: the rotation angle of its root about the vertical.
//!
//! One joint in one pass, in float64 and on the calling thread: each heading continues the previous one.

use crate::error::check_length;
use crate::rotations::quaternion::{is_missing, of_row, product};
use crate::{Error, Real};
use std::f64::consts::{PI, TAU};

/// Twist of a rotation about the axis `up` (1, 2 or 3 of the quaternion's components), in `[−π, π]`.
fn twist(q: [f64; 4], up: usize) -> f64 {
    let along = q[up] * 1.0_f64.copysign(q[0]);
    (2.0 * along.abs().atan2_nonnegative(q[0].abs())).copysign(along)
}

/// Splits rotations `(frames, 4)` into headings about the axis `up` (0, 1 or 2), `(frames)`, and the remaining
/// rotations, `(frames, 4)`.
///
/// Headings have no jumps from one valid sample to the next. The remaining rotation is relative to the heading as
/// rounded to `T`. Both are NaN at missing samples.
///
/// # Errors
/// [`Error::Length`] if the lengths of slices do not agree; [`Error::Parameter`] if `up` is not 0, 1 or 2.
pub fn split_heading<T: Real>(
    roots: &[T],
    up: usize,
    heading: &mut [T],
    rest: &mut [T],
) -> Result<(), Error> {
    check_length("heading", roots.len() / 4, heading.len())?;
    check_length("rest", roots.len(), rest.len())?;
    if up > 2 {
        return Err(Error::Parameter { name: "up", expected: "0, 1 or 2" });
    }
    let mut before: Option<f64> = None;
    let mut turns = 0.0;
    for ((q, heading), rest) in roots.chunks_exact(4).zip(heading).zip(rest.chunks_exact_mut(4)) {
        let q = of_row(q);
        if is_missing(q) {
            *heading = T::nan();
            rest.fill(T::nan());
            continue;
        }
        let q = q.map(T::to_f64);
        let turned = twist(q, up + 1);
        let step = turned - before.unwrap_or(turned);
        if step.abs() > PI {
            turns += 1.0_f64.copysign(step);
        }
        before = Some(turned);
        *heading = T::from_f64(turned - TAU * turns);
        let (sine, cosine) = Real::sin_cos((heading.to_f64() * 0.5) % TAU);
        let mut back = [cosine, 0.0, 0.0, 0.0];
        back[up + 1] = -sine;
        rest.copy_from_slice(&product(back, q).map(T::from_f64));
    }
    Ok(())
}
