//! The 1€ filter: a low pass whose cutoff grows with the speed.
//!
//! G. Casiez, N. Roussel and D. Vogel, "1€ filter: a simple speed-based low-pass filter for noisy input in
//! interactive systems". Let `y` be the previous sample, `n` frames ago, `x` its result, and `α(f) = 1 / (1 + 1 / (2π
//! f n))` the smoothing factor of a cutoff `f`. A sample `z` gives
//!
//! ```text
//! ω ← ω + α(f_d) (2 log(y⁻¹ z) / n − ω)
//! f = f_min + β |ω|
//! x ← x exp(α(f) log(x⁻¹ z))
//! ```

use super::lanes::{self, Group, LANES, Lane, of_lane, scaled, select, set_lane};
use crate::error::check_length;
use crate::parallel::Interrupt;
use crate::rotations::quaternion::{self, between, exp_one, log_short, product, unit};
use crate::simd::multiversion;
use crate::{ClipMut, ClipView, Error, Real};

pub use super::local::Translation;

/// Frames between two checks of the interrupt flag.
const STRETCH: usize = 4096;

/// Estimated nanoseconds per sample.
const NANOSECONDS: usize = 30;

/// The parameters of the filter.
#[derive(Debug, Clone)]
pub struct OneEuro {
    /// Cutoff at rest per joint: 1 / frame; may be infinite.
    pub min_cutoff: Vec<f64>,
    /// Growth of the cutoff with the speed, per joint: 1 / radian.
    pub beta: Vec<f64>,
    /// Cutoff of the velocity per joint: 1 / frame; may be infinite.
    pub derivative_cutoff: Vec<f64>,
}

impl OneEuro {
    /// Filters `clip` forward in time into `out`, `(frames, joints, 4)`, sign-continuous from the hemisphere of the
    /// first frame, and a translation with the smoothing factors of the first joint.
    ///
    /// A sample of `confidence` `c`, `(frames, joints)`, has the smoothing factor `c·α`; samples with confidence 0
    /// are ignored. Before a joint's first sample with confidence its pose is constant. No other sample may be
    /// missing. Quaternions need not have length 1 exactly.
    ///
    /// # Errors
    /// [`Error::Length`] if the lengths of slices do not agree; [`Error::Interrupted`].
    pub fn filter<T: Real>(
        &self,
        clip: ClipView<'_, T>,
        translation: Option<Translation<'_, T>>,
        confidence: Option<&[T]>,
        out: ClipMut<'_, T>,
        interrupt: &Interrupt,
    ) -> Result<(), Error> {
        let (frames, joints) = (clip.frames(), clip.joints());
        let out = out.into_data();
        check_length("out", clip.data().len(), out.len())?;
        for (name, numbers) in [
            ("min_cutoff", &self.min_cutoff),
            ("beta", &self.beta),
            ("derivative_cutoff", &self.derivative_cutoff),
        ] {
            check_length(name, joints, numbers.len())?;
        }
        check_length("confidence", frames * joints, confidence.map_or(frames * joints, <[T]>::len))?;
        if let Some(Translation { values, out }) = &translation {
            check_length("translation", frames * 3, values.len())?;
            check_length("translation out", frames * 3, out.len())?;
        }
        if frames < 2 || joints == 0 {
            if let Some(Translation { values, out }) = translation {
                out.copy_from_slice(values);
            }
            return quaternion::normalize(clip.data(), out);
        }
        let filter =
            |group: &Group<'_, T>, records: &mut Vec<Record>| self.run(group, records, frames, interrupt);
        let root = lanes::run(clip, confidence, out, frames * joints * NANOSECONDS, filter)?;
        if let (Some(Translation { values, out }), Some(root)) = (translation, root) {
            follow(&root, values, out);
        }
        Ok(())
    }

    /// The rows of a group; and for its first joint the first frame and the smoothing factors.
    fn run<T: Real>(
        &self,
        group: &Group<'_, T>,
        records: &mut Vec<Record>,
        frames: usize,
        interrupt: &Interrupt,
    ) -> Result<(Vec<T>, Shares), Error> {
        records.clear();
        records.resize(frames, Record::STILL);
        for (frame, record) in records.iter_mut().enumerate() {
            group.load(frame, &mut record.rotation, &mut record.confidence);
        }
        let cutoffs = Cutoffs {
            least: group.lane(&self.min_cutoff),
            beta: group.lane(&self.beta),
            derivative: group.lane(&self.derivative_cutoff),
        };
        let mut state = State::nothing();
        for stretch in records.chunks_mut(STRETCH) {
            interrupt.check()?;
            forward(stretch, &cutoffs, &mut state);
        }
        let rows = group.rows(|frame| &records[frame].rotation);
        let shares = records.iter().map(|record| record.share[0]).collect();
        Ok((rows, Shares { begin: group.begin(0), shares }))
    }
}

/// Smoothing factors of a joint: the fraction of the displacement to each sample.
struct Shares {
    /// The frame of its first sample.
    begin: Option<usize>,
    shares: Vec<f64>,
}

/// Moves positions with the smoothing factors of a joint.
fn follow<T: Real>(root: &Shares, values: &[T], out: &mut [T]) {
    let Some(begin) = root.begin else {
        out.copy_from_slice(values);
        return;
    };
    let mut position: [f64; 3] = std::array::from_fn(|c| values[begin * 3 + c].to_f64());
    for (frame, (share, out)) in root.shares.iter().zip(out.chunks_exact_mut(3)).enumerate() {
        for (c, out) in out.iter_mut().enumerate() {
            if frame > begin {
                position[c] += share * (values[frame * 3 + c].to_f64() - position[c]);
            }
            *out = T::from_f64(position[c]);
        }
    }
}

/// The cutoffs of [`LANES`] joints.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cutoffs {
    pub(super) least: Lane,
    pub(super) beta: Lane,
    pub(super) derivative: Lane,
}

/// One frame of [`LANES`] joints.
#[derive(Debug, Clone, Copy)]
pub(super) struct Record {
    /// The sample, of any length, and then the result.
    pub(super) rotation: [Lane; 4],
    /// Confidence of the sample.
    pub(super) confidence: Lane,
    /// The fraction of the displacement to the sample by which the result moved.
    share: Lane,
}

impl Record {
    /// A constant sample of each joint at the identity, with confidence.
    pub(super) const STILL: Self = Self {
        rotation: [[1.0; LANES], [0.0; LANES], [0.0; LANES], [0.0; LANES]],
        confidence: [1.0; LANES],
        share: [0.0; LANES],
    };
}

/// State of the filter for [`LANES`] joints.
#[derive(Debug, Clone, Copy)]
pub(super) struct State {
    /// The last sample.
    sample: [Lane; 4],
    result: [Lane; 4],
    /// Angular velocity, radians per frame.
    velocity: [Lane; 3],
    /// Frames since the last sample; 0 before the first.
    elapsed: Lane,
}

impl State {
    /// The state before the first sample.
    pub(super) fn nothing() -> Self {
        let still = Record::STILL.rotation;
        Self { sample: still, result: still, velocity: [[0.0; LANES]; 3], elapsed: [0.0; LANES] }
    }
}

multiversion! {
    /// Replaces samples by results.
    pub(super) fn forward(records: &mut [Record], cutoffs: &Cutoffs, state: &mut State) {
        let mut now = *state;
        for record in records {
            let mut after = *record;
            for i in 0..LANES {
                let (sample, confidence) = (unit(of_lane(&after.rotation, i)), after.confidence[i]);
                let (before, velocity) = (of_lane(&now.result, i), of_lane(&now.velocity, i));
                let measured = confidence > 0.0;
                let begun = now.elapsed[i] > 0.0;
                let elapsed = if begun { now.elapsed[i] } else { 1.0 };
                let last = of_lane(&now.sample, i);
                let turned = scaled(log_short(between(last, sample)), 2.0);
                let follows = if begun { confidence * low_pass(cutoffs.derivative[i], elapsed) } else { 0.0 };
                let velocity = [
                    velocity[0] + follows * (turned[0] / elapsed - velocity[0]),
                    velocity[1] + follows * (turned[1] / elapsed - velocity[1]),
                    velocity[2] + follows * (turned[2] / elapsed - velocity[2]),
                ];
                let speed = (velocity[0] * velocity[0] + velocity[1] * velocity[1] + velocity[2] * velocity[2]).sqrt();
                let share = confidence * low_pass(cutoffs.least[i] + cutoffs.beta[i] * speed, elapsed);
                let moved = product(before, exp_one(scaled(log_short(between(before, sample)), share)));
                // Before its first sample a joint is at its sample.
                let result = select(begun, select(measured, moved, before), sample);
                set_lane(&mut after.rotation, i, result);
                after.share[i] = share;
                set_lane(&mut now.sample, i, select(measured, sample, last));
                set_lane(&mut now.result, i, result);
                set_lane(&mut now.velocity, i, velocity);
                let since = if begun { now.elapsed[i] + 1.0 } else { 0.0 };
                now.elapsed[i] = if measured { 1.0 } else { since };
            }
            *record = after;
        }
        *state = now;
    }
}

/// Smoothing factor of a first-order low pass, `elapsed` frames after the previous sample.
#[inline(always)]
fn low_pass(cutoff: f64, elapsed: f64) -> f64 {
    1.0 / (1.0 + 1.0 / (2.0 * std::f64::consts::PI * cutoff * elapsed))
}
