//! Euler angles: rotations as three successive rotations about coordinate axes, as in motion files.
//!
//! The angles `(a₀, a₁, a₂)` about the axes `(i, j, k)`, a permutation of x, y and z, represent `R =
//! R_i(a₀)·R_j(a₁)·R_k(a₂)`: each rotation is about the axis as rotated by the previous ones. The same rotation has a
//! second triple `(a₀ + π, π − a₁, a₂ + π)`, and multiples of 2π may be added to each angle. At `a₁ = ±π/2` there is
//! gimbal lock: only `a₀ ± a₂` is determined.
//!
//! Reference: E. Bernardes, S. Viollet, "Quaternion to Euler angles conversion: a direct, general and computationally
//! efficient method", PLOS ONE 17(11), 2022.

use super::quaternion::{map_rows, rows};
use crate::error::check_length;
use crate::simd::multiversion;
use crate::{Error, Real};

/// Orders of the axes x, y and z.
const ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [1, 0, 2], [2, 1, 0]];

/// The first orders are right-handed: `i × j = k`. In the others `i × j = −k`.
const RIGHT_HANDED: usize = 3;

/// Distance from gimbal lock (sine of half the remaining angle) below which the third angle is set to 0. The rotation
/// changes by as much, which is below the precision of the decimals in a file.
const LOCK: f64 = 1e-12;

/// The same for the second angle of a triple from a file or from [`to_euler`], in radians.
const NEARLY_LOCKED: f64 = 4e-12;

/// The order of the axes of Euler angles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Axes(usize);

impl Axes {
    /// The order that a word such as `ZXY` names.
    ///
    /// # Errors
    /// [`Error::Parameter`] unless the word has each of `X`, `Y` and `Z` once.
    pub fn named(word: &str) -> Result<Self, Error> {
        let letters = |order: [usize; 3]| order.map(|axis| b"XYZ"[axis]);
        ORDERS
            .iter()
            .position(|&order| letters(order) == word.as_bytes())
            .map(Self)
            .ok_or(Error::Parameter { name: "axes", expected: "each of X, Y and Z once" })
    }

    /// 1 for right-handed orders, −1 for the others.
    fn parity(self) -> f64 {
        parity(self.0)
    }
}

#[inline(always)]
fn parity<T: Real>(order: usize) -> T {
    if order < RIGHT_HANDED { T::ONE } else { -T::ONE }
}

/// The quaternion of Euler angles from the sines and cosines of half of them.
#[inline(always)]
fn combine<T: Real>(order: usize, s: [T; 3], c: [T; 3]) -> [T; 4] {
    let last = parity::<T>(order) * s[2];
    let [i, j, k] = ORDERS[order];
    let mut q = [c[0] * c[1] * c[2] - s[0] * s[1] * last, T::ZERO, T::ZERO, T::ZERO];
    q[1 + i] = s[0] * c[1] * c[2] + c[0] * s[1] * last;
    q[1 + j] = c[0] * s[1] * c[2] - s[0] * c[1] * last;
    q[1 + k] = parity::<T>(order) * (c[0] * c[1] * last + s[0] * s[1] * c[2]);
    q
}

/// The angle of the point `(x, y)` in `(−π, π]`.
#[inline(always)]
fn angle_of<T: Real>(y: T, x: T) -> T {
    y.abs().atan2_nonnegative(x).copysign(y)
}

/// `angle` in `[−2π, 2π]`, moved by multiples of 2π to `[−π, π]`.
#[inline(always)]
fn wrapped<T: Real>(angle: T) -> T {
    let turn = T::TWO * T::PI;
    let below = if angle > T::PI { angle - turn } else { angle };
    if below < -T::PI { below + turn } else { below }
}

/// Let `c' = ±a₂` by the parity. `qw + qj` and `qi + qk'` are the cosine and sine of `(a₀ + c')/2` times one factor,
/// `qw − qj` and `qi − qk'` those of `(a₀ − c')/2` times another. The tangent of `a₁/2 + π/4` is the ratio of the two
/// factors.
#[inline(always)]
fn split<T: Real>(order: usize, q: [T; 4]) -> [T; 3] {
    let [i, j, k] = ORDERS[order];
    let (w, x, y, z) = (q[0], q[1 + i], q[1 + j], parity::<T>(order) * q[1 + k]);
    let (sine_of_sum, cosine_of_sum) = (x + z, w + y);
    let (sine_of_rest, cosine_of_rest) = (x - z, w - y);
    let upper = (sine_of_sum * sine_of_sum + cosine_of_sum * cosine_of_sum).sqrt();
    let lower = (sine_of_rest * sine_of_rest + cosine_of_rest * cosine_of_rest).sqrt();
    let lock = T::from_f64(LOCK) * (upper + lower);
    let half_sum = angle_of(sine_of_sum, cosine_of_sum);
    let half_rest = angle_of(sine_of_rest, cosine_of_rest);
    let sum = if upper < lock { half_rest } else { half_sum };
    let rest = if lower < lock { half_sum } else { half_rest };
    // NaN for missing samples, else 0.
    let missing = T::ZERO / (upper + lower);
    [
        wrapped(sum + rest) + missing,
        T::TWO * upper.atan2_nonnegative(lower) - T::HALF_PI + missing,
        wrapped(parity::<T>(order) * (sum - rest)) + missing,
    ]
}

multiversion! {
    fn combine_rows<T: Real, const ORDER: usize>(angles: &[T], out: &mut [T]) {
        map_rows(angles, out, |angles: [T; 3]| {
            let turns = angles.map(|angle| (angle * T::HALF).sin_cos());
            combine(ORDER, turns.map(|(sine, _)| sine), turns.map(|(_, cosine)| cosine))
        });
    }
}
multiversion! {
    fn split_rows<T: Real, const ORDER: usize>(q: &[T], out: &mut [T]) {
        map_rows(q, out, |q: [T; 4]| split(ORDER, q));
    }
}

/// [`combine`] for angles beyond the range of the vectorised sine.
#[cold]
#[expect(
    clippy::disallowed_methods,
    reason = "only libm reduces large arguments exactly; rare, and not in a hot loop"
)]
fn combine_far(order: usize, angles: &[f64], out: &mut [f64]) {
    let half = [angles[0] * 0.5, angles[1] * 0.5, angles[2] * 0.5];
    out.copy_from_slice(&combine(order, half.map(f64::sin), half.map(f64::cos)));
}

/// Unit quaternions of Euler angles in radians, `(n, 3)` → `(n, 4)`; NaN where an angle is NaN.
///
/// # Errors
/// [`Error::Length`] if the lengths of slices do not agree.
pub fn from_euler(angles: &[f64], axes: Axes, out: &mut [f64]) -> Result<(), Error> {
    check_length("out", angles.len() / 3 * 4, out.len())?;
    let combine = match axes.0 {
        0 => combine_rows::<f64, 0>,
        1 => combine_rows::<f64, 1>,
        2 => combine_rows::<f64, 2>,
        3 => combine_rows::<f64, 3>,
        4 => combine_rows::<f64, 4>,
        _ => combine_rows::<f64, 5>,
    };
    rows(angles.len() / 3, 8, out, 4, |r, out| {
        let angles = &angles[r.start * 3..r.end * 3];
        combine(angles, out);
        for (angles, out) in angles.chunks_exact(3).zip(out.chunks_exact_mut(4)) {
            if angles.iter().any(|angle| angle.abs() > f64::SIN_COS_LIMIT) {
                combine_far(axes.0, angles, out);
            }
        }
    })
}

/// Euler angles of quaternions in radians, `(n, 4)` → `(n, 3)`: the second in `[−π/2, π/2]`, the others in `[−π, π]`.
///
/// The result does not depend on the sign and length of a quaternion; NaN for missing samples. In gimbal lock the
/// third angle is 0.
///
/// # Errors
/// [`Error::Length`] if the lengths of slices do not agree.
pub fn to_euler(q: &[f64], axes: Axes, out: &mut [f64]) -> Result<(), Error> {
    check_length("out", q.len() / 4 * 3, out.len())?;
    let split = match axes.0 {
        0 => split_rows::<f64, 0>,
        1 => split_rows::<f64, 1>,
        2 => split_rows::<f64, 2>,
        3 => split_rows::<f64, 3>,
        4 => split_rows::<f64, 4>,
        _ => split_rows::<f64, 5>,
    };
    rows(q.len() / 4, 12, out, 3, |r, out| split(&q[r.start * 4..r.end * 4], out))
}

/// The angle that differs from `angle` by a multiple of 2π and is nearest to `target`.
fn near(angle: f64, target: f64) -> f64 {
    const TURN: f64 = 2.0 * std::f64::consts::PI;
    angle + TURN * ((target - angle) / TURN).round_ties_even()
}

/// The triple of the same rotation nearest to the triple `before`.
fn nearest(angles: [f64; 3], before: [f64; 3], parity: f64) -> [f64; 3] {
    use std::f64::consts::{FRAC_PI_2, PI};
    let [mut first, second, mut third] = angles;
    let over = second.abs() - FRAC_PI_2;
    if over.abs() < NEARLY_LOCKED {
        // The third angle is free: it keeps its previous value, and the first compensates for it.
        first += parity.copysign(parity * second) * (third - before[2]);
        third = before[2];
    }
    let one = [near(first, before[0]), near(second, before[1]), near(third, before[2])];
    let other = [near(first + PI, before[0]), near(PI - second, before[1]), near(third + PI, before[2])];
    let way = |to: [f64; 3]| (0..3).map(|c| (to[c] - before[c]) * (to[c] - before[c])).sum::<f64>();
    if way(other) < way(one) { other } else { one }
}

/// Euler angles made continuous along time, in radians, `(frames, joints, 3)`.
///
/// Each triple is replaced by the one of the same rotation nearest to the previous triple; the first one by that
/// nearest to `start`, `(joints, 3)`. Triples with NaN are unchanged, and continuity extends across them; a joint
/// whose start has NaN begins with its first triple.
///
/// # Errors
/// [`Error::Length`] if the lengths of slices do not agree.
pub fn continuous_euler(angles: &[f64], start: &[f64], axes: Axes, out: &mut [f64]) -> Result<(), Error> {
    check_length("out", angles.len(), out.len())?;
    let mut before: Vec<[f64; 3]> = start.chunks_exact(3).map(|row| [row[0], row[1], row[2]]).collect();
    if before.is_empty() {
        return check_length("angles", 0, angles.len());
    }
    check_length("angles", angles.len() / start.len() * start.len(), angles.len())?;
    for (frame, out) in angles.chunks_exact(start.len()).zip(out.chunks_exact_mut(start.len())) {
        for ((row, out), before) in frame.chunks_exact(3).zip(out.chunks_exact_mut(3)).zip(&mut before) {
            let mut here = [row[0], row[1], row[2]];
            if here.iter().all(|angle| angle.is_finite()) {
                if before.iter().all(|angle| angle.is_finite()) {
                    here = nearest(here, *before, axes.parity());
                }
                *before = here;
            }
            out.copy_from_slice(&here);
        }
    }
    Ok(())
}
