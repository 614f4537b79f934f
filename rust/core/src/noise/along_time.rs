//! Noise that comes and goes: its variance along time.

use super::motion::{LEAST_LEVEL, mean_of_known, median, square_speeds, windowed_mean};
use super::noise::{GROUP, increments};
use crate::clip::Planes;
use crate::error::check_length;
use crate::{ClipView, Error, Real, parallel};

/// Signs and sizes of the increments in a difference of order 6 of the motion.
const STEPS: [f64; 6] = [-1.0, 5.0, -10.0, 10.0, -5.0, 1.0];

/// Sum of squares of the coefficients of that difference, `C(12, 6)`.
const SQUARES: f64 = 924.0;

/// Frames from the first one of a difference to its middle.
const MIDDLE: usize = 3;

/// Frames on either side over which squares are averaged.
const REACH: usize = 10;

/// Frames: four windows. Shorter clips have no quiet part to compare with.
const SHORTEST: usize = 84;

/// One over the quantile over time of a joint's local variance that stands for its quiet part.
const QUARTERS: usize = 4;

/// Share of the local speed, in frames, that motion may leave in the differences: so much is no noise.
const OF_MOTION: f64 = 0.5;

/// Share of the mean speed below which a quiet part is not told apart from a quieter one.
const LEAST_QUIET: f64 = 0.3;

/// Weight of a steady level, in squares of differences.
const PRIOR: f64 = 10.0;

/// Weight of what one joint shows in a window.
const PER_JOINT: f64 = 42.0;

/// Deviation of the logarithm of the variance below which the noise of many joints is steady.
const VARY: f64 = 0.2;

/// What one joint has besides by chance; `1/√joints` of it for several.
const VARY_OF_ONE: f64 = 0.36;

/// How far above that unsteadiness counts in full.
const VARY_RANGE: f64 = 0.2;

/// The variance of the noise of all joints at each frame, in units of its quiet part: `(frames)`.
///
/// The local variance of each joint, from differences of order 6, less what its local speed may leave in them, over that of its
/// quiet part; the median over the joints, at least 1. Steady noise has 1 at all frames.
///
/// # Errors
/// [`Error::Length`] if the slices do not fit.
pub fn noise_along_time<T: Real>(q: ClipView<'_, T>, level: &[T], out: &mut [f64]) -> Result<(), Error> {
    let frames = q.frames();
    check_length("level", q.joints(), level.len())?;
    check_length("out", frames, out.len())?;
    out.fill(1.0);
    if frames < SHORTEST {
        return Ok(());
    }
    let groups: Vec<&[T]> = level.chunks(GROUP).collect();
    let columns = parallel::map(groups, q.data().len() * 20, |group, level| {
        let mut planes = Planes::new(level.len() * 3, frames - 1);
        increments(q, group * GROUP, level.len(), &mut planes);
        let noisy = level.iter().enumerate().filter(|(_, sigma)| sigma.to_f64() >= LEAST_LEVEL);
        Ok(noisy.map(|(joint, _)| excess(planes.rows_from::<3>(joint * 3))).collect::<Vec<_>>())
    })?;
    let columns: Vec<Vec<f64>> = columns.into_iter().flatten().collect();
    if columns.is_empty() {
        return Ok(());
    }
    let joints = columns.len() as f64;
    let weight = PER_JOINT * joints;
    let mut known = Vec::new();
    for (frame, out) in out.iter_mut().enumerate() {
        known.clear();
        known.extend(columns.iter().map(|column| column[frame]).filter(|x| x.is_finite()));
        let variance = median(&mut known).unwrap_or(1.0).max(1.0);
        *out = ((weight * variance + PRIOR) / (weight + PRIOR)).ln();
    }
    let mean = out.iter().sum::<f64>() / frames as f64;
    let spread = (out.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / frames as f64).sqrt();
    let share = ((spread - VARY - VARY_OF_ONE / joints.sqrt()) / VARY_RANGE).clamp(0.0, 1.0);
    for log in out {
        *log = Real::exp(*log * share);
    }
    Ok(())
}

/// The local variance of a joint that its motion does not explain, over that of its quiet part; NaN where nothing is known.
fn excess<T: Real>(steps: [&[T]; 3]) -> Vec<f64> {
    let frames = steps[0].len() + 1;
    let mut squares = vec![f64::NAN; frames];
    for first in 0..frames.saturating_sub(2 * MIDDLE) {
        let mut sum = 0.0;
        for plane in steps {
            let values = &plane[first..first + STEPS.len()];
            let difference: f64 = STEPS.iter().zip(values).map(|(c, x)| c * x.to_f64()).sum();
            sum += difference * difference;
        }
        // The increments are half the rotation vectors.
        squares[first + MIDDLE] = 4.0 * sum / 3.0 / SQUARES;
    }
    let local: Vec<f64> = (0..frames).map(|t| windowed_mean(&squares, t, REACH)).collect();
    let mut speeds = Vec::new();
    square_speeds(steps, &mut speeds);
    speeds.insert(0, f64::NAN);
    let quiet = lower_quartile(&local).max(LEAST_QUIET * LEAST_QUIET * mean_of_known(&speeds));
    local
        .iter()
        .enumerate()
        .map(|(t, here)| {
            let less = here - OF_MOTION * OF_MOTION * windowed_mean(&speeds, t, REACH);
            // Not `max`, which takes NaN for the smaller one.
            (if less < 0.0 { 0.0 } else { less }) / quiet
        })
        .collect()
}

/// The quantile of the quiet part of what is finite, by linear interpolation between ranks; NaN of nothing.
fn lower_quartile(values: &[f64]) -> f64 {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|x| x.is_finite()).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    let rank = sorted.len().saturating_sub(1);
    let (below, part) = (rank / QUARTERS, (rank % QUARTERS) as f64 / QUARTERS as f64);
    let low = sorted.get(below).copied().unwrap_or(f64::NAN);
    let high = sorted.get(below + 1).copied().unwrap_or(low);
    low + part * (high - low)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quartiles_are_interpolated() {
        assert!((lower_quartile(&[3.0, f64::NAN, 1.0, 2.0]) - 1.5).abs() < 1e-12);
        assert!(lower_quartile(&[f64::NAN]).is_nan());
    }
}
