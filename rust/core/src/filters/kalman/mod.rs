//! The Kalman filter of constant angular velocity, and its smoother, on the manifold of rotations.
//!
//! R. E. Kalman, "A new approach to linear filtering and prediction problems"; H. E. Rauch, F. Tung and C. T.
//! Striebel, "Maximum likelihood estimates of linear dynamic systems". Sums become steps along geodesics, differences
//! become logarithms, and velocities are moved by parallel transport:
//!
//! ```text
//! predict   q⁻ = q exp(ω/2)                        ω⁻ = ω
//! correct   ν = 2 log(q⁻⁻¹ z)                      q = q⁻ exp(K₁ν/2)     ω = transport(ω⁻ + K₂ν)
//! smooth    δ = 2 log(q⁻(t+1)⁻¹ qₛ(t+1)) …         qₛ = q exp((C₁₁δ + C₁₂δω)/2)
//! ```
//!
//! Transport along a geodesic compensates for half of its rotation.

mod covariance;
mod ratio;
pub(super) mod rotations;
mod vectors;

pub use ratio::{process_noise, vectors_ratio};
pub use vectors::filter_vectors;

use super::lanes::{self, Group};
use crate::error::check_length;
use crate::parallel::Interrupt;
use crate::rotations::quaternion;
use crate::{ClipMut, ClipView, Error, Real};
use rotations::{Forecasts, Later, Record, Variances};

/// Frames between two checks of the interrupt flag.
const STRETCH: usize = 4096;

/// Estimated nanoseconds per frame and joint, for each direction.
const NANOSECONDS: usize = 30;

/// The parameters of the filter.
#[derive(Debug, Clone)]
pub struct Kalman {
    /// Square root of the spectral density of the angular acceleration per joint: radians / frame^1.5.
    pub process_noise: Vec<f64>,
    /// Standard deviation of a measurement per joint and component of the rotation vector: radians, above 0.
    pub measurement_noise: Vec<f64>,
    /// Number of later frames that the smoother uses; `None` for all.
    pub lookahead: Option<usize>,
}

impl Kalman {
    /// Filters `clip` along time into `out`, `(frames, joints, 4)`, sign-continuous from the hemisphere of the first frame.
    ///
    /// The variance of a measurement is divided by its `confidence`, `(frames, joints)`; samples with confidence 0
    /// are ignored. Before a joint's first sample with confidence its pose is constant. No other sample may be
    /// missing. Quaternions need not have length 1 exactly.
    ///
    /// # Errors
    /// [`Error::Length`] if the lengths of slices do not agree; [`Error::Interrupted`].
    pub fn filter<T: Real>(
        &self,
        clip: ClipView<'_, T>,
        confidence: Option<&[T]>,
        out: ClipMut<'_, T>,
        interrupt: &Interrupt,
    ) -> Result<(), Error> {
        let (frames, joints) = (clip.frames(), clip.joints());
        let out = out.into_data();
        check_length("out", clip.data().len(), out.len())?;
        check_length("process_noise", joints, self.process_noise.len())?;
        check_length("measurement_noise", joints, self.measurement_noise.len())?;
        check_length("confidence", frames * joints, confidence.map_or(frames * joints, <[T]>::len))?;
        if frames < 2 || joints == 0 {
            return quaternion::normalize(clip.data(), out);
        }
        let reach = self.reach(frames);
        let steps = 2 + reach.min(frames - reach);
        let nanoseconds = (frames * joints * NANOSECONDS).saturating_mul(steps);
        let filter = |group: &Group<'_, T>, records: &mut Vec<Record>| {
            records.clear();
            records.resize(frames, Record::STILL);
            for (frame, record) in records.iter_mut().enumerate() {
                group.load(frame, &mut record.rotation, &mut record.confidence);
            }
            let variances = Variances {
                process: group.lane(&self.process_noise).map(|noise| noise * noise),
                measurement: group.lane(&self.measurement_noise).map(|noise| noise * noise),
            };
            self.run(records, &variances, interrupt)?;
            Ok((group.rows(|frame| &records[frame].rotation), ()))
        };
        lanes::run(clip, confidence, out, nanoseconds, filter).map(|_| ())
    }

    /// Number of later frames that the smoother uses in a clip of `frames` frames.
    fn reach(&self, frames: usize) -> usize {
        self.lookahead.unwrap_or(frames).min(frames - 1)
    }

    /// Replaces the samples in `records` by the smoothed rotations.
    fn run(&self, records: &mut [Record], variances: &Variances, interrupt: &Interrupt) -> Result<(), Error> {
        let (frames, reach) = (records.len(), self.reach(records.len()));
        forward(records, variances, interrupt)?;
        for last in reach..frames - 1 {
            interrupt.check()?;
            let mut later = Later::nothing(&records[last]);
            rotations::backward(&mut records[last - reach..last], variances, &mut later, false);
            records[last - reach].rotation = later.rotation;
        }
        let mut later = Later::nothing(&records[frames - 1]);
        for stretch in records[frames - 1 - reach..frames - 1].rchunks_mut(STRETCH) {
            interrupt.check()?;
            rotations::backward(stretch, variances, &mut later, true);
        }
        Ok(())
    }
}

/// Replaces the samples in `records` by the filter's states, and returns the statistics of the forecasts.
fn forward(records: &mut [Record], variances: &Variances, interrupt: &Interrupt) -> Result<Forecasts, Error> {
    let mut forecasts = Forecasts::default();
    rotations::begin(&mut records[0], variances, &mut forecasts);
    for start in (0..records.len() - 1).step_by(STRETCH) {
        interrupt.check()?;
        let end = (start + STRETCH + 1).min(records.len());
        rotations::forward(&mut records[start..end], variances, &mut forecasts);
    }
    Ok(forecasts)
}
