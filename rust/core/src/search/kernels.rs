//! Vectorised loops over the pairs of a diagonal.

use super::features::{Features, Kind};
use crate::Real;
use crate::simd::multiversion;
use std::ops::Range;

/// Squared length of the difference of two quaternions.
#[inline(always)]
fn chord<T: Real>(a: [T; 4], b: [T; 4]) -> T {
    let d = [a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3] - b[3]];
    (d[0] * d[0] + d[1] * d[1]) + (d[2] * d[2] + d[3] * d[3])
}

/// Squared angle between two rotations.
///
/// Takes the smaller of the chords to `b` and `−b`. Unlike an inner product, differences keep their digits where the
/// rotations are nearly equal.
#[inline(always)]
fn squared_angle<T: Real, const WIDE: bool>(a: [T; 4], b: [T; 4]) -> T {
    let near = chord(a, b);
    if WIDE {
        let far = chord(a, [-b[0], -b[1], -b[2], -b[3]]);
        near.min(far).square_of_angle()
    } else {
        near.square_of_angle()
    }
}

/// Columns per loop iteration: planes must hold this many columns more than are read.
///
/// One vector of float32 at the widest level. A scalar remainder loop would take longer than all the rest.
pub(crate) const LANES: usize = 16;

/// Runs a body with the squared distance of each pair of columns `at[0] + i` and `at[1] + i` of a joint.
///
/// A macro: the compiler omits the scalar remainder loop only where it sees the lengths of all slices.
macro_rules! each_square {
    ($a:expr, $b:expr, $at:expr, $joint:expr, $n:expr, |$i:ident, $square:ident| $body:expr) => {
        let (here, there, n) = ($a.joints[$joint].row, $b.joints[$joint].row, $n);
        let x = |plane: usize| &$a.planes.row(here + plane)[$at[0]..$at[0] + n];
        let y = |plane: usize| &$b.planes.row(there + plane)[$at[1]..$at[1] + n];
        let (x0, x1, x2) = (x(0), x(1), x(2));
        let (y0, y1, y2) = (y(0), y(1), y(2));
        match $a.joints[$joint].kind {
            Kind::Vector => {
                for $i in 0..n {
                    let (u, v, w) = (y0[$i] - x0[$i], y1[$i] - x1[$i], y2[$i] - x2[$i]);
                    let $square = u * u + v * v + w * w;
                    $body;
                }
            }
            Kind::Narrow => {
                let (x3, y3) = (x(3), y(3));
                for $i in 0..n {
                    let (q, r) = ([x0[$i], x1[$i], x2[$i], x3[$i]], [y0[$i], y1[$i], y2[$i], y3[$i]]);
                    let $square = squared_angle::<T, false>(q, r);
                    $body;
                }
            }
            Kind::Wide => {
                let (x3, y3) = (x(3), y(3));
                for $i in 0..n {
                    let (q, r) = ([x0[$i], x1[$i], x2[$i], x3[$i]], [y0[$i], y1[$i], y2[$i], y3[$i]]);
                    let $square = squared_angle::<T, true>(q, r);
                    $body;
                }
            }
        }
    };
}

multiversion! {
    /// `d = Σ factor·square` over joints, for the pairs of columns `at[0] + i` and `at[1] + i`, a multiple of [`LANES`].
    pub(crate) fn frame_distances<T: Real>(
        d: &mut [T], a: &Features<'_, T>, b: &Features<'_, T>, at: [usize; 2], joints: Range<usize>, factors: &[T],
    ) {
        let n = d.len() / LANES * LANES;
        let d = &mut d[..n];
        d.fill(T::ZERO);
        for joint in joints {
            let factor = factors[joint];
            each_square!(a, b, at, joint, n, |i, square| d[i] += factor * square);
        }
    }
}

multiversion! {
    /// `d = Σ c·factor·square`, `total = Σ c·unit` over joints, where `c` is the product of both samples' weights.
    /// The number of pairs is a multiple of [`LANES`].
    pub(crate) fn shared_frame_distances<T: Real>(
        sums: [&mut [T]; 2], a: &Features<'_, T>, b: &Features<'_, T>, at: [usize; 2], joints: Range<usize>,
        factors: &[T], units: &[T],
    ) {
        let [d, total] = sums;
        let n = d.len() / LANES * LANES;
        let (d, total) = (&mut d[..n], &mut total[..n]);
        d.fill(T::ZERO);
        total.fill(T::ZERO);
        let (Some(here), Some(there)) = (a.shares, b.shares) else { return };
        for joint in joints {
            let (factor, unit) = (factors[joint], units[joint]);
            let (c, e) = (&here.row(joint)[at[0]..at[0] + n], &there.row(joint)[at[1]..at[1] + n]);
            each_square!(a, b, at, joint, n, |i, square| {
                let share = c[i] * e[i];
                d[i] += factor * share * square;
                total[i] += unit * share;
            });
        }
    }
}

multiversion! {
    /// `to[i] = a[i] + a[i + shift]`.
    fn add_shifted<T: Real>(to: &mut [T], a: &[T], shift: usize) {
        let n = to.len();
        let (a, b) = (&a[..n], &a[shift..shift + n]);
        for i in 0..n {
            to[i] = a[i] + b[i];
        }
    }
}

multiversion! {
    /// `to += a`.
    fn add_plane<T: Real>(to: &mut [T], a: &[T]) {
        let n = to.len();
        let a = &a[..n];
        for i in 0..n {
            to[i] += a[i];
        }
    }
}

/// Sums over a sliding window: `out[i] = values[i] + … + values[i + window − 1]`.
///
/// Windows are composed of sums over powers of two, so the cost hardly grows with the window. Every sum has positive
/// terms only and no sum is carried along: a large value leaves no error in other windows, and a sum depends on its
/// own terms only. `values` is used as scratch.
pub(crate) fn sliding_sums<T: Real>(values: &mut Vec<T>, scratch: &mut Vec<T>, window: usize, out: &mut [T]) {
    sums_along(values, scratch, window, 1, out);
}

/// Sums of values with stride `step`: `out[i] = values[i] + … + values[i + (window − 1)·step]`, as [`sliding_sums`].
///
/// In a matrix whose rows are one element shorter than `step`, these are sums along diagonals.
pub(crate) fn sums_along<T: Real>(
    values: &mut Vec<T>,
    scratch: &mut Vec<T>,
    window: usize,
    step: usize,
    out: &mut [T],
) {
    let n = out.len();
    out.fill(T::ZERO);
    let (mut covered, mut power) = (0, 1);
    loop {
        if window & power != 0 {
            add_plane(out, &values[covered * step..covered * step + n]);
            covered += power;
        }
        if covered == window {
            return;
        }
        let length = values.len() - power * step;
        scratch.resize(length, T::ZERO);
        add_shifted(&mut scratch[..length], values, power * step);
        std::mem::swap(values, scratch);
        values.truncate(length);
        power *= 2;
    }
}

multiversion! {
    /// `d ← √(scale·d)`.
    pub(crate) fn roots<T: Real>(d: &mut [T], scale: T) {
        for d in d {
            *d = (scale * *d).sqrt();
        }
    }
}

multiversion! {
    /// `d ← √(d / total)`, or `√d` unless `averaged`; infinite where the total is 0.
    pub(crate) fn shared_roots<T: Real>(d: &mut [T], total: &[T], averaged: bool) {
        let n = d.len();
        let total = &total[..n];
        for i in 0..n {
            let some = total[i] > T::ZERO;
            let divisor = if averaged { total[i] } else { T::ONE };
            let root = (d[i] / divisor).sqrt();
            d[i] = if some { root } else { T::ONE / T::ZERO };
        }
    }
}

multiversion! {
    /// Marks with 1 where `d[i] ≤ limit[i]`; returns whether there is a mark.
    pub(crate) fn mark_nearest<T: Real>(marks: &mut [u8], d: &[T], limit: &[T]) -> bool {
        let n = marks.len();
        let (d, limit) = (&d[..n], &limit[..n]);
        let mut any = 0;
        for i in 0..n {
            let near = u8::from(d[i] <= limit[i]);
            marks[i] = near;
            any |= near;
        }
        any != 0
    }
}
