//! Frames that rotate along with a spinning joint.
//!
//! The signs of quaternions and their averages in R⁴ require neighbours that are close together. A steadily rotating
//! joint is slowed down from both sides, half from each:
//!
//! ```text
//! p_t = L_t⁻¹ q_t S_t⁻¹,     L_0 = S_0 = 1,     L_{t+1} = exp(Ω_t / 4) L_t,     S_{t+1} = S_t exp(ω_t / 4)
//! ```
//!
//! with the means `ω_t` and `Ω_t` of the rotations from frame to frame in body and in world coordinates. The inverse
//! of a path has the inverse `p`. Constant rotations on either side, or a reversal of time, change `p` by constant
//! rotations only.

use super::super::columns::{BLOCK, Mask};
use super::align::follow_mean;
use super::joint::{SHORTEST_MEAN, carry, make_unit, seen, turns};
use crate::Error;
use crate::clip::Planes;
use crate::parallel::Interrupt;
use crate::rotations::quaternion::{conjugate_one, dot, exp_one, product, unit};
use crate::window::Boundary;

/// Radians within a standard deviation of the mask: a joint that rotates steadily and faster is spinning. Averages of
/// slower rotations are long, and neighbours keep their signs.
const FAST: f64 = 1.5;

/// Length of an average of unit quaternions below which the joint may be spinning. At 1.5 rad within a standard
/// deviation of the mask the length is `exp(−1.5²/8)`; noise alone gives it from 0.9 rad per component of the
/// rotation vector on.
const LONG_MEAN: f64 = 0.75;

/// Whether one of the means `(frames)` is so short that the joint may be spinning.
pub(super) fn may_spin(means: [&[f64]; 4], frames: usize) -> bool {
    let [w, x, y, z] = means.map(|plane| &plane[..frames]);
    let mut least = f64::INFINITY;
    for i in 0..frames {
        let mean = [w[i], x[i], y[i], z[i]];
        least = least.min(dot(mean, mean));
    }
    least < LONG_MEAN * LONG_MEAN
}

/// Computes the reference path of a spinning joint, with a mask of standard deviation `sigma`. If the joint does not
/// spin, the reference is unchanged.
pub(super) fn follow_spin(
    reference: [&mut [f64]; 4],
    (samples, trust): ([&[f64]; 4], Option<&[f64]>),
    frames: usize,
    (mask, sigma): (&Mask, f64),
    spare: &mut Planes<f64>,
    interrupt: &Interrupt,
) -> Result<(), Error> {
    let padded = frames.next_multiple_of(BLOCK);
    let mut planes = Planes::new(19, padded);
    let [a, b, c, d, e, f, weights, rest @ ..] = planes.rows_mut::<19>(0);
    let weights = trust.map(|trust| {
        for i in 0..frames - 1 {
            weights[i] = trust[i] * trust[i + 1];
        }
        &*weights
    });
    let fastest = mean_turns(samples, weights, frames, [a, b, c, d, e, f], mask, spare, interrupt)?;
    if fastest * sigma <= FAST {
        return Ok(());
    }
    let [p0, p1, p2, p3, s0, s1, s2, s3, l0, l1, l2, l3] = rest;
    let mut right = [s0, s1, s2, s3];
    let mut left_inverse = [l0, l1, l2, l3];
    roll([&*a, &*b, &*c], 0.25, frames, &mut right);
    roll([&*d, &*e, &*f], -0.25, frames, &mut left_inverse);
    let mut slow = [p0, p1, p2, p3];
    let at = |planes: &[&mut [f64]; 4], i: usize| planes.each_ref().map(|plane| plane[i]);
    for i in 0..frames {
        let q = samples.map(|plane| plane[i]);
        let p = unit(product(product(at(&left_inverse, i), q), conjugate_one(at(&right, i))));
        for (plane, x) in slow.iter_mut().zip(p) {
            plane[i] = x;
        }
    }
    let first = at(&slow, 0);
    follow_mean(slow.each_mut().map(|plane| &mut **plane), trust, 1.0, first, 0..frames);
    let mut reference = reference;
    for (mean, slow) in reference.iter_mut().zip(&slow) {
        mean.copy_from_slice(slow);
    }
    mask.means(&mut reference, trust, (frames, Boundary::Mirror), spare, interrupt)?;
    let slow = slow.each_ref().map(|plane| &**plane);
    make_unit(reference.each_mut().map(|plane| &mut **plane), slow, SHORTEST_MEAN);
    for i in 0..frames {
        let mean = reference.each_ref().map(|plane| plane[i]);
        let one = product(product(conjugate_one(at(&left_inverse, i)), mean), at(&right, i));
        for (plane, x) in reference.iter_mut().zip(one) {
            plane[i] = x;
        }
    }
    Ok(())
}

/// Averages the rotations from frame to frame in body coordinates, and in world coordinates; returns the length of
/// the longest mean.
///
/// Rotations from or to a sample of low confidence weigh less; those of weight 0 are ignored.
fn mean_turns(
    samples: [&[f64]; 4],
    weights: Option<&[f64]>,
    frames: usize,
    means: [&mut [f64]; 6],
    mask: &Mask,
    spare: &mut Planes<f64>,
    interrupt: &Interrupt,
) -> Result<f64, Error> {
    let count = frames - 1;
    let padded = count.next_multiple_of(BLOCK);
    let mut means = means.map(|plane| &mut plane[..padded]);
    let [a, b, c, of_world @ ..] = means.each_mut().map(|plane| &mut plane[..count]);
    turns(samples, [&mut *a, &mut *b, &mut *c]);
    if let Some(weights) = weights {
        for i in (0..count).filter(|&i| weights[i] == 0.0) {
            (a[i], b[i], c[i]) = (0.0, 0.0, 0.0);
        }
    }
    let mut of_world = of_world;
    for (plane, from) in of_world.iter_mut().zip([&*a, &*b, &*c]) {
        plane.copy_from_slice(from);
    }
    seen(samples, of_world);
    mask.means(&mut means, weights, (count, Boundary::Nearest), spare, interrupt)?;
    let [a, b, c, d, e, f] = means;
    let squares = |i: usize| {
        let body = a[i] * a[i] + b[i] * b[i] + c[i] * c[i];
        let world = d[i] * d[i] + e[i] * e[i] + f[i] * f[i];
        body.max(world)
    };
    Ok((0..count).map(squares).fold(0.0, f64::max).sqrt())
}

/// Develops rotations scaled by `share`: unit quaternions, the first of which is 1.
fn roll(turns: [&[f64]; 3], share: f64, frames: usize, out: &mut [&mut [f64]; 4]) {
    for i in 1..frames {
        let step = exp_one(turns.map(|plane| plane[i - 1] * share));
        for (plane, x) in out.iter_mut().zip(step) {
            plane[i] = x;
        }
    }
    carry(out, frames);
}
