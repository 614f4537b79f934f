//! The noise level of a clip, estimated from the clip.

use super::coherence::noise_of;
use super::median::{all_numbers, median_of_absolute};
use crate::clip::Planes;
use crate::error::check_length;
use crate::rotations::quaternion::{between, dot, log_short, of_row};
use crate::simd::multiversion;
use crate::{ClipView, Error, Real, parallel};

/// Orders of the differences of the motion, and the sum of squares of their coefficients, `C(2n, n)`.
const ORDERS: [(usize, f64); 3] = [(4, 70.0), (6, 924.0), (8, 12870.0)];

/// Median of `|x|` for a normal `x` with deviation 1.
const MEDIAN_OF_NORMAL: f64 = 0.674_489_750_196_081_7;

/// Least number of differences whose median is taken.
const FEWEST: usize = 2;

/// Radians from which noise is heavy: increments of two samples are not the sums of their noises any more, and beyond half a turn
/// they come out as smaller ones. Their differences read 1 % too low at 0.25, 2 % at 0.5, 16 % at 0.8, and no more than 0.71 at all.
const HEAVY: f64 = 0.25;

/// Most frames between the samples of the pairs that heavy noise is read off.
const LAGS: usize = 4;

/// By how much the likeness of pairs at each lag counts in what is left of it at lag 0: a straight line over the squared lags
/// 1, 4, 9, 16, their mean 15/2, and the sum of their squared differences from it, 129.
const AT_ZERO: [f64; LAGS] =
    [0.25 + 7.5 * 6.5 / 129.0, 0.25 + 7.5 * 3.5 / 129.0, 0.25 - 7.5 * 1.5 / 129.0, 0.25 - 7.5 * 8.5 / 129.0];

/// Joints per task: of float32 they fill a cache line.
pub(super) const GROUP: usize = 4;

/// Frames per chunk.
const CHUNK: usize = 64;

multiversion! {
    /// Half the rotation vectors from each frame to the next, NaN beside missing samples, of the joints from `first`:
    /// three planes for each.
    pub(super) fn increments<T: Real>(q: ClipView<'_, T>, first: usize, joints: usize, planes: &mut Planes<T>) {
        let row = q.joints() * 4;
        let steps = planes.length();
        let mut rows = [[T::ONE; GROUP * 4]; CHUNK + 1];
        for start in (0..steps).step_by(CHUNK) {
            let length = CHUNK.min(steps - start);
            let frames = &q.data()[start * row..(start + length + 1) * row];
            // A plain copy first: its loads do not wait for each other, and memory is slow.
            for (copy, frame) in rows.iter_mut().zip(frames.chunks_exact(row)) {
                let frame = &frame[first * 4..(first + joints) * 4];
                match frame.first_chunk() {
                    Some(whole) => *copy = *whole,
                    None => copy[..frame.len()].copy_from_slice(frame),
                }
            }
            for joint in 0..joints {
                let mut samples = [[T::ONE; CHUNK + 1]; 4];
                for (i, row) in rows.iter().enumerate() {
                    let q = of_row(&row[joint * 4..]);
                    for c in 0..4 {
                        samples[c][i] = q[c];
                    }
                }
                let mut steps = [[T::ZERO; CHUNK]; 3];
                for i in 0..CHUNK {
                    let a = std::array::from_fn(|c| samples[c][i]);
                    let b = std::array::from_fn(|c| samples[c][i + 1]);
                    let lengths = dot(a, a) * dot(b, b);
                    let valid = (lengths > T::ZERO) & lengths.is_finite();
                    let step = log_short(between(a, b));
                    for c in 0..3 {
                        steps[c][i] = if valid { step[c] } else { T::nan() };
                    }
                }
                for (c, plane) in planes.rows_mut::<3>(joint * 3).into_iter().enumerate() {
                    plane[start..start + length].copy_from_slice(&steps[c][..length]);
                }
            }
        }
    }
}

multiversion! {
    /// Third differences in place: the first `n − 3` values.
    fn third_differences<T: Real>(values: &mut [T]) {
        let three = T::ONE + T::TWO;
        for i in 0..values.len().saturating_sub(3) {
            values[i] = (values[i + 3] - values[i]) - three * (values[i + 2] - values[i + 1]);
        }
    }
}

multiversion! {
    /// Second differences in place: the first `n − 2` values.
    fn second_differences<T: Real>(values: &mut [T]) {
        for i in 0..values.len().saturating_sub(2) {
            values[i] = (values[i + 2] - values[i + 1]) - (values[i + 1] - values[i]);
        }
    }
}

/// The noise level from the planes of one joint, which are used up.
fn level<T: Real>(planes: [&mut [T]; 3], buffer: &mut Vec<T>) -> f64 {
    let mut planes = planes;
    let complete = all_numbers(planes[0]);
    let mut least = f64::INFINITY;
    let mut taken = 1;
    for (order, squares) in ORDERS {
        let mut mean = 0.0;
        for plane in &mut planes {
            let values = std::mem::take(plane);
            let length = values.len().saturating_sub(order - taken);
            if taken == 1 {
                third_differences(values);
            } else {
                second_differences(values);
            }
            *plane = &mut values[..length];
            let median = median_of_absolute(plane, complete, FEWEST, buffer).unwrap_or(f64::INFINITY);
            let deviation = median / squares.sqrt() / MEDIAN_OF_NORMAL;
            mean += deviation * deviation / 3.0;
        }
        taken = order;
        least = least.min(mean.sqrt());
    }
    if least.is_finite() { least } else { 0.0 }
}

/// The noise level of a joint in heavy noise from pairs of samples, if there are enough of them.
///
/// Rotations with noise of the coherence `f` about the same rotation have `E (4 (q·q')² − 1)/3 = f²`, from which motion takes away
/// by the square of the lag between the two.
fn heavy_level<T: Real>(q: ClipView<'_, T>, joint: usize) -> Option<f64> {
    let mut before = [None; LAGS];
    let (mut totals, mut counts) = ([0.0; LAGS], [0_usize; LAGS]);
    for frame in 0..q.frames() {
        let sample = q.at(frame, joint).map(T::to_f64);
        let length = dot(sample, sample).sqrt();
        let valid = (length > 0.0) & length.is_finite();
        let here = valid.then(|| sample.map(|x| x / length));
        for lag in 1..=LAGS.min(frame) {
            if let Some((here, there)) = here.zip(before[(frame - lag) % LAGS]) {
                let alike = dot(here, there);
                totals[lag - 1] += (4.0 * alike * alike - 1.0) / 3.0;
                counts[lag - 1] += 1;
            }
        }
        before[frame % LAGS] = here;
    }
    let mut square = 0.0;
    for ((total, count), share) in totals.iter().zip(counts).zip(AT_ZERO) {
        if count < FEWEST {
            return None;
        }
        square += share * total / count as f64;
    }
    Some(noise_of(square.max(0.0).sqrt()))
}

/// Estimates the deviation of white noise per component of the rotation vector, in radians: `(joints)`.
///
/// The increments in the frame of the body, `ω_t = 2 log(q_t⁻¹ q_{t+1})`, are first differences of the motion. Of the
/// n-th differences `Δⁿ⁻¹ω` smooth motion leaves little, and white noise of deviation `σ` has `σ √C(2n, n)`: for each
/// coordinate `σ̂ = median |Δⁿ⁻¹ω| / √C(2n, n) / 0.6745`, for each joint the root mean square over its coordinates, and
/// of the orders 4, 6 and 8 the smallest. Differences that touch a missing sample are left out; without any, 0. Heavy noise is read
/// off how alike samples of the same pose are, which knows that noise wraps.
///
/// # Errors
/// [`Error::Length`] if `out` has another length than there are joints.
pub fn noise_level<T: Real>(q: ClipView<'_, T>, out: &mut [T]) -> Result<(), Error> {
    check_length("out", q.joints(), out.len())?;
    let steps = q.frames().saturating_sub(1);
    let groups: Vec<&mut [T]> = out.chunks_mut(GROUP).collect();
    parallel::for_each(groups, q.data().len() * 3, |group, out| {
        let mut planes = Planes::new(out.len() * 3, steps);
        let mut buffer = Vec::new();
        increments(q, group * GROUP, out.len(), &mut planes);
        for (joint, out) in out.iter_mut().enumerate() {
            // The increments are half the rotation vectors.
            let light = 2.0 * level(planes.rows_mut::<3>(joint * 3), &mut buffer);
            let heavy = if light >= HEAVY { heavy_level(q, group * GROUP + joint) } else { None };
            *out = T::from_f64(heavy.unwrap_or(light));
        }
        Ok(())
    })
}

/// The same of positions `(frames, points, 3)` without missing ones, in their unit: `(points)`.
///
/// # Errors
/// [`Error::Length`] if the slices do not fit.
pub fn noise_level_of_positions<T: Real>(positions: &[T], points: usize, out: &mut [T]) -> Result<(), Error> {
    check_length("out", points, out.len())?;
    let frames = positions.len() / (points * 3).max(1);
    check_length("positions", frames * points * 3, positions.len())?;
    parallel::for_each(out.iter_mut().collect(), positions.len() * 10, |point, out| {
        let mut planes = Planes::new(3, frames.saturating_sub(1));
        for c in 0..3 {
            let path = || positions.iter().skip(point * 3 + c).step_by(points * 3);
            for ((step, a), b) in planes.row_mut(c).iter_mut().zip(path()).zip(path().skip(1)) {
                *step = *b - *a;
            }
        }
        *out = T::from_f64(level(planes.rows_mut::<3>(0), &mut Vec::new()));
        Ok(())
    })
}
