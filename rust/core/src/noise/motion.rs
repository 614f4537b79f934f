//! How large noise is beside the motion: the evidence that it is noise, and not motion that high differences see.

use super::noise::{GROUP, increments};
use crate::clip::Planes;
use crate::error::check_length;
use crate::{ClipView, Error, Real, parallel};

/// Increments on either side whose mean is the local speed of a joint: averaging leaves little of the noise in it.
const SPEED_REACH: usize = 3;

/// Radians: joints with less noise are at rest up to the rounding of float32, and say nothing.
pub(super) const LEAST_LEVEL: f64 = 1e-5;

/// The noise level beside the speed of the motion, in frames: the median over the joints.
///
/// For each joint `σ / √(mean |ω̄_t|²)`, with the local speed `ω̄_t`, the mean of 7 increments; 0 without a joint that moves and has
/// noise. `level` is the noise level of each joint.
///
/// # Errors
/// [`Error::Length`] if `level` has another length than there are joints.
pub fn noise_over_motion<T: Real>(q: ClipView<'_, T>, level: &[T]) -> Result<f64, Error> {
    check_length("level", q.joints(), level.len())?;
    let groups: Vec<&[T]> = level.chunks(GROUP).collect();
    let ratios = parallel::map(groups, q.data().len() * 5, |group, level| {
        let mut planes = Planes::new(level.len() * 3, q.frames().saturating_sub(1));
        increments(q, group * GROUP, level.len(), &mut planes);
        let mut speeds = Vec::new();
        let mut ratios = Vec::new();
        for (joint, sigma) in level.iter().map(|x| x.to_f64()).enumerate() {
            if sigma >= LEAST_LEVEL {
                square_speeds(planes.rows_from::<3>(joint * 3), &mut speeds);
                let square = mean_of_known(&speeds);
                if square > 0.0 {
                    ratios.push(sigma / square.sqrt());
                }
            }
        }
        Ok(ratios)
    })?;
    Ok(median(&mut ratios.concat()).unwrap_or(0.0))
}

/// Squared lengths of the mean of the increments around each, from half of them; NaN where none is known.
pub(super) fn square_speeds<T: Real>(steps: [&[T]; 3], out: &mut Vec<f64>) {
    out.clear();
    let n = steps[0].len();
    out.extend((0..n).map(|i| {
        let around = i.saturating_sub(SPEED_REACH)..(i + SPEED_REACH + 1).min(n);
        let square = steps.map(|plane| {
            let mean = 2.0 * mean_of_known_reals(&plane[around.clone()]);
            mean * mean
        });
        square[0] + square[1] + square[2]
    }));
}

fn mean_of_known_reals<T: Real>(values: &[T]) -> f64 {
    let (mut total, mut count) = (0.0, 0.0);
    for value in values {
        if !value.is_nan() {
            total += value.to_f64();
            count += 1.0;
        }
    }
    total / count
}

/// Mean of what is not NaN; NaN where all are.
pub(super) fn mean_of_known(values: &[f64]) -> f64 {
    mean_of_known_reals(values)
}

/// Mean of the known values up to `reach` before and after the index; NaN where none is known.
pub(super) fn windowed_mean(values: &[f64], index: usize, reach: usize) -> f64 {
    mean_of_known(&values[index.saturating_sub(reach)..(index + reach + 1).min(values.len())])
}

/// The median; of an even count, the mean of the two in the middle.
pub(super) fn median(values: &mut [f64]) -> Option<f64> {
    if values.is_empty() {
        return None;
    }
    let even = values.len().is_multiple_of(2);
    let (under, &mut high, _) = values.select_nth_unstable_by(values.len() / 2, f64::total_cmp);
    let low = if even { under.iter().copied().reduce(f64::max) } else { None };
    Some(low.map_or(high, |low| f64::midpoint(low, high)))
}
