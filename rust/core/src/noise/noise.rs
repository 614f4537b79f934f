//! The noise level of a clip, estimated from the clip.

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

/// Joints per task, which share buffers.
const GROUP: usize = 2;

/// Frames per tile. Clips are read tile by tile, in the order of memory, and their increments are kept joint by joint.
const TILE: usize = 1024;

/// Frames per chunk.
const CHUNK: usize = 64;

multiversion! {
    /// Half the rotation vectors from each of the `steps` frames from `first` to the next, NaN beside missing samples:
    /// `out` is `(joints, 3, TILE)`.
    fn increments<T: Real>(q: ClipView<'_, T>, first: usize, steps: usize, out: &mut [T]) {
        let row = q.joints() * 4;
        for start in (0..steps).step_by(CHUNK) {
            let length = CHUNK.min(steps - start);
            let rows = &q.data()[(first + start) * row..(first + start + length + 1) * row];
            for (joint, planes) in out.chunks_exact_mut(3 * TILE).enumerate() {
                let mut samples = [[T::ONE; CHUNK + 1]; 4];
                for (i, row) in rows.chunks_exact(row).enumerate() {
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
                for (plane, steps) in planes.chunks_exact_mut(TILE).zip(&steps) {
                    plane[start..start + length].copy_from_slice(&steps[..length]);
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
            // The increments are half the rotation vectors.
            let median =
                median_of_absolute(plane, complete, FEWEST, buffer).map_or(f64::INFINITY, |x| 2.0 * x);
            let deviation = median / squares.sqrt() / MEDIAN_OF_NORMAL;
            mean += deviation * deviation / 3.0;
        }
        taken = order;
        least = least.min(mean.sqrt());
    }
    if least.is_finite() { least } else { 0.0 }
}

/// Estimates the deviation of white noise per component of the rotation vector, in radians: `(joints)`.
///
/// The increments in the frame of the body, `ω_t = 2 log(q_t⁻¹ q_{t+1})`, are first differences of the motion. Of the
/// n-th differences `Δⁿ⁻¹ω` smooth motion leaves little, and white noise of deviation `σ` has `σ √C(2n, n)`: for each
/// coordinate `σ̂ = median |Δⁿ⁻¹ω| / √C(2n, n) / 0.6745`, for each joint the root mean square over its coordinates, and
/// of the orders 4, 6 and 8 the smallest. Differences that touch a missing sample are left out; without any, 0.
///
/// # Errors
/// [`Error::Length`] if `out` has another length than there are joints.
pub fn noise_level<T: Real>(q: ClipView<'_, T>, out: &mut [T]) -> Result<(), Error> {
    check_length("out", q.joints(), out.len())?;
    let steps = q.frames().saturating_sub(1);
    let (joints, work) = (q.joints(), q.data().len() / 4);
    let mut all = vec![T::ZERO; steps.div_ceil(TILE) * TILE * joints * 3];
    let tiles: Vec<&mut [T]> = all.chunks_mut((TILE * joints * 3).max(1)).collect();
    parallel::for_each(tiles, work * 5, |tile, out| {
        increments(q, tile * TILE, TILE.min(steps - tile * TILE), out);
        Ok(())
    })?;
    let groups: Vec<&mut [T]> = out.chunks_mut(GROUP).collect();
    parallel::for_each(groups, work * 7, |group, out| {
        let mut planes = Planes::new(3, steps);
        let mut buffer = Vec::new();
        for (i, out) in out.iter_mut().enumerate() {
            let joint = group * GROUP + i;
            for (tile, all) in all.chunks_exact(TILE * joints * 3).enumerate() {
                for (c, all) in all[joint * 3 * TILE..(joint + 1) * 3 * TILE].chunks_exact(TILE).enumerate() {
                    let length = TILE.min(steps - tile * TILE);
                    planes.row_mut(c)[tile * TILE..tile * TILE + length].copy_from_slice(&all[..length]);
                }
            }
            *out = T::from_f64(level(planes.rows_mut::<3>(0), &mut buffer));
        }
        Ok(())
    })
}
