//! Automatic process noise, in units of measurement noise, chosen from the clip itself.
//!
//! P. Craven and G. Wahba, "Smoothing noisy data with spline functions": generalised cross-validation.

use super::forward;
use super::rotations::{self, Later, Record, Variances, displacement_between, square};
use super::vectors;
use crate::error::check_length;
use crate::filters::lanes::{LANES, Lane, of_lane, select, set_lane};
use crate::parallel::{self, Interrupt};
use crate::rotations::quaternion::unit;
use crate::simd::multiversion;
use crate::{ClipView, Error, Real};

/// Step between the candidates, in decades.
const STEP: f64 = 0.5;

/// Ratios of process variance to measurement variance, per frame³. With the smallest the smoother uses some 200
/// frames on either side; with the largest it changes almost nothing.
const CANDIDATES: [f64; 3 * LANES] = [
    1e-9,
    3.162_277_660_168_379_3e-9,
    1e-8,
    3.162_277_660_168_379_3e-8,
    1e-7,
    3.162_277_660_168_379_3e-7,
    1e-6,
    3.162_277_660_168_379_3e-6,
    1e-5,
    3.162_277_660_168_379_3e-5,
    1e-4,
    3.162_277_660_168_379_3e-4,
    1e-3,
    3.162_277_660_168_379_3e-3,
    1e-2,
    3.162_277_660_168_379_3e-2,
    1e-1,
    3.162_277_660_168_379_3e-1,
    1.0,
    3.162_277_660_168_379_3,
    1e1,
    3.162_277_660_168_379_3e1,
    1e2,
    3.162_277_660_168_379_3e2,
];

/// Least number of measurements for choosing a ratio; with fewer it is 1.
const FEWEST: usize = 8;

/// Number of measurements that determine the first velocity. Earlier forecasts carry no information.
const KNOWN: usize = 2;

/// Statistics of one joint for each candidate, summed over the measurements.
#[derive(Debug, Default)]
struct Scores {
    /// Squared innovations, each times its confidence.
    errors: [f64; CANDIDATES.len()],
    /// Sum of these confidences.
    weights: [f64; CANDIDATES.len()],
    /// Squared distances between the smoothed values and the measurements, each times its confidence.
    residuals: [f64; CANDIDATES.len()],
    /// Weights of the measurements in their own smoothed values.
    shares: [f64; CANDIDATES.len()],
}

impl Scores {
    /// The best ratio, given `measured` samples with confidence.
    fn best(&self, measured: usize, lookahead: Option<usize>) -> f64 {
        if measured < FEWEST {
            return 1.0;
        }
        let forecast: [f64; CANDIDATES.len()] = std::array::from_fn(|k| self.errors[k] / self.weights[k]);
        let mut best = 0;
        for k in 1..CANDIDATES.len() {
            if forecast[k] < forecast[best] {
                best = k;
            }
        }
        if lookahead == Some(0) {
            return refined(&forecast, best);
        }
        let validation: [f64; CANDIDATES.len()] = std::array::from_fn(|k| {
            let free = (1.0 - self.shares[k] / measured as f64).max(0.0);
            self.residuals[k] / (free * free)
        });
        loop {
            let mut better = best;
            for k in [best.saturating_sub(1), (best + 1).min(CANDIDATES.len() - 1)] {
                if validation[k] < validation[better] {
                    better = k;
                }
            }
            if better == best {
                return refined(&validation, best);
            }
            best = better;
        }
    }
}

/// The candidate `best`, refined to the vertex of the parabola through the logarithms of the minimum and its
/// neighbours.
fn refined(criterion: &[f64; CANDIDATES.len()], best: usize) -> f64 {
    let ratio = CANDIDATES[best];
    if best == 0 || best + 1 == CANDIDATES.len() {
        return ratio;
    }
    let around = [criterion[best - 1], criterion[best], criterion[best + 1]];
    if !around.iter().all(|&x| x.is_finite() && x > 0.0) {
        return ratio;
    }
    let [before, here, after] = around.map(f64::ln);
    let bend = before - 2.0 * here + after;
    let vertex = if bend > 0.0 { (before - after) / (2.0 * bend) } else { 0.0 };
    ratio * 10.0_f64.powf(STEP * vertex)
}

/// Chooses the process noise of [`super::Kalman`] from a clip, per joint: radians / frame^1.5.
///
/// The forward filter, `lookahead` 0, takes the candidate whose forecasts are nearest to the next samples. From there
/// the smoother descends to a minimum of the generalised cross-validation `Σ c |z − x|² / (1 − Σ h / n)²`. Here `z`
/// are the `n` samples with confidence `c`, `x` their smoothed values, and `h` the weight of each sample in its own
/// smoothed value.
///
/// The clip consists of independent blocks of `block` frames, at least 1.
///
/// # Errors
/// [`Error::Length`] if the lengths of slices do not agree; [`Error::Interrupted`].
pub fn process_noise<T: Real>(
    clip: ClipView<'_, T>,
    confidence: Option<&[T]>,
    measurement_noise: &[f64],
    block: usize,
    lookahead: Option<usize>,
    interrupt: &Interrupt,
) -> Result<Vec<f64>, Error> {
    let (frames, joints) = (clip.frames(), clip.joints());
    check_length("measurement_noise", joints, measurement_noise.len())?;
    check_length("confidence", frames * joints, confidence.map_or(frames * joints, <[T]>::len))?;
    let nanoseconds = frames * joints * CANDIDATES.len() * 2 * super::NANOSECONDS;
    parallel::map(measurement_noise.to_vec(), nanoseconds, |joint, noise| {
        let samples: Vec<([f64; 4], f64)> = (0..frames)
            .map(|frame| {
                let confidence =
                    confidence.map_or(1.0, |confidence| confidence[frame * joints + joint].to_f64());
                (unit(clip.at(frame, joint).map(T::to_f64)), confidence)
            })
            .collect();
        let mut scores = Scores::default();
        let mut records = Vec::new();
        for samples in samples.chunks(block.max(1)) {
            for first in (0..CANDIDATES.len()).step_by(LANES) {
                judge(samples, noise * noise, first, &mut records, &mut scores, interrupt)?;
            }
        }
        let measured = samples.iter().filter(|(_, confidence)| *confidence > 0.0).count();
        Ok(scores.best(measured, lookahead).sqrt() * noise)
    })
}

/// Adds the statistics of the candidates from `first` on for a block of samples.
fn judge(
    samples: &[([f64; 4], f64)],
    variance: f64,
    first: usize,
    records: &mut Vec<Record>,
    scores: &mut Scores,
    interrupt: &Interrupt,
) -> Result<(), Error> {
    records.clear();
    records.extend(samples.iter().map(|(sample, confidence)| Record::alike(*sample, *confidence)));
    let variances = Variances {
        process: std::array::from_fn(|i| CANDIDATES[first + i] * variance),
        measurement: [variance; LANES],
    };
    let forecasts = forward(records, &variances, interrupt)?;
    let last = records.len() - 1;
    let mut later = Later::nothing(&records[last]);
    rotations::backward(&mut records[..last], &variances, &mut later, true);
    let (mut residuals, mut shares): (Lane, Lane) = ([0.0; LANES], [0.0; LANES]);
    compare(samples, records, &variances, &mut residuals, &mut shares);
    for i in 0..LANES {
        scores.errors[first + i] += forecasts.errors[i];
        scores.weights[first + i] += forecasts.weights[i];
        scores.residuals[first + i] += residuals[i];
        scores.shares[first + i] += shares[i];
    }
    Ok(())
}

multiversion! {
    /// Adds the squared distances between smoothed rotations and samples, each times its confidence, and the weights
    /// of the samples in them.
    fn compare(
        samples: &[([f64; 4], f64)], records: &[Record], variances: &Variances,
        residuals: &mut Lane, shares: &mut Lane,
    ) {
        let (mut distances, mut own) = ([0.0; LANES], [0.0; LANES]);
        let mut smooth = [[0.0; LANES]; 3];
        for (index, ((sample, confidence), record)) in samples.iter().zip(records).rev().enumerate() {
            for i in 0..LANES {
                let known = record.covariance(i);
                let after = known.smoothed(of_lane(&smooth, i), variances.process[i]);
                let better = select(index == 0, [known.pose, known.cross, known.velocity], after);
                set_lane(&mut smooth, i, better);
                distances[i] += confidence * square(displacement_between(*sample, record.rotation(i)));
                own[i] += confidence * better[0] / variances.measurement[i];
            }
        }
        *residuals = distances;
        *shares = own;
    }
}

/// Chooses the ratios of [`super::filter_vectors`] for the `columns` of `values`, `(frames, columns)`, with the
/// criterion of [`process_noise`].
///
/// # Errors
/// [`Error::Length`] if the length of `values` is not a multiple of `columns`; [`Error::Interrupted`].
pub fn vectors_ratio<T: Real>(
    values: &[T],
    columns: usize,
    block: usize,
    lookahead: Option<usize>,
    interrupt: &Interrupt,
) -> Result<Vec<f64>, Error> {
    let frames = values.len().checked_div(columns).unwrap_or(0);
    check_length("values", frames * columns, values.len())?;
    let nanoseconds = values.len() * CANDIDATES.len() * super::NANOSECONDS;
    parallel::map((0..columns).collect(), nanoseconds, |_, column: usize| {
        let values: Vec<f64> = values.iter().skip(column).step_by(columns).map(|x| x.to_f64()).collect();
        let mut scores = Scores::default();
        for (k, ratio) in CANDIDATES.into_iter().enumerate() {
            interrupt.check()?;
            for values in values.chunks(block.max(1)) {
                judge_numbers(values, ratio, k, &mut scores);
            }
        }
        Ok(scores.best(frames, lookahead))
    })
}

/// Adds the statistics of a candidate for a block of scalars.
fn judge_numbers(values: &[f64], ratio: f64, k: usize, scores: &mut Scores) {
    let (mut errors, mut residuals, mut shares) = (0.0, 0.0, 0.0);
    let mut count = 1;
    let states = vectors::forward(values.iter().copied(), ratio, |innovation| {
        errors += if count >= KNOWN { innovation * innovation } else { 0.0 };
        count += 1;
    });
    let mut frame = values.len();
    let mut smooth = [0.0; 3];
    vectors::backward(&states, ratio, |value| {
        frame -= 1;
        let covariance = states[frame].covariance;
        smooth = if frame + 1 == values.len() {
            [covariance.pose, covariance.cross, covariance.velocity]
        } else {
            covariance.smoothed(smooth, ratio)
        };
        residuals += (values[frame] - value) * (values[frame] - value);
        shares += smooth[0];
    });
    scores.errors[k] += errors;
    scores.weights[k] += values.len().saturating_sub(KNOWN) as f64;
    scores.residuals[k] += residuals;
    scores.shares[k] += shares;
}
