//! Spikes: samples that leave the motion and come back at once.
//!
//! A run of samples shorter than the radius is a spike if it is farther than usual from everything that its neighbours
//! explain: the rest or the straight motion of either side, and the way from one side to the other. What is usual is the
//! median of the same deviation over the runs around it, and at least that of white noise of the joint's level.
//!
//! Two of the explanations are the nearest neighbours themselves: where the steps into a run and out of it are short,
//! nothing else has to be computed.
//!
//! Longer runs are spikes if the joint jumps away, and jumps back, beside calm motion. Two joints that jump into each other's
//! place and back are a swap.
//!
//! - `place`: rotations and positions, and what both need to be able to do;
//! - `joint`: one joint's runs, and which of them are spikes;
//! - `jumps`: where runs can start and end;
//! - `displaced`: longer runs;
//! - `swaps`: joints that change places;
//! - `neighbours`: the deviation of a run from what its neighbours explain;
//! - `line`: straight motion;
//! - `median`: what is usual.

mod displaced;
mod joint;
mod jumps;
mod line;
mod median;
mod neighbours;
mod place;
mod swaps;

use crate::error::check_length;
use crate::parallel::{self, Interrupt};
use crate::rotations::quaternion::unit;
use crate::{ClipView, Error, Real};
use joint::Joint;
use place::{Place, Position, Rotation};
pub use swaps::Swap;

/// Median deviation of samples of white noise with the deviation 1 per coordinate.
const DEVIATION_OF_NOISE: f64 = 1.5;

/// What is a spike.
#[derive(Debug, Clone)]
pub struct Despike {
    /// Deviation of the noise per coordinate and joint: radians of rotation, or the unit of the positions.
    pub noise: Vec<f64>,
    /// Deviations up to here are no spikes, per joint: radians of rotation, or the unit of the positions.
    pub smallest: Vec<f64>,
    /// The deviation judges shorter runs, in frames, by at most so many neighbours on either side.
    pub radius: usize,
    /// How many times the usual deviation a spike is away.
    pub threshold: f64,
    /// The longest displaced run and the longest swap, in frames.
    pub longest: usize,
}

impl Despike {
    /// The least jump of a joint, whatever is around it.
    fn least(&self, joint: usize) -> f64 {
        self.smallest[joint].max(self.threshold * (DEVIATION_OF_NOISE * self.noise[joint]))
    }

    /// Marks the spikes of a clip of rotations in `found`, `(frames, joints)`. No sample may be missing.
    ///
    /// # Errors
    /// [`Error::Length`] if slices do not fit together; [`Error::Interrupted`].
    pub fn rotations<T: Real>(
        &self,
        clip: ClipView<'_, T>,
        confidence: Option<&[T]>,
        found: &mut [bool],
        interrupt: &Interrupt,
    ) -> Result<(), Error> {
        let at = |frame, joint| Rotation(unit(clip.at(frame, joint).map(T::to_f64)));
        self.run((clip.frames(), clip.joints()), at, confidence, found, interrupt)
    }

    /// Marks the spikes of positions `(frames, points, 3)` in `found`, `(frames, points)`.
    ///
    /// # Errors
    /// [`Error::Length`] if slices do not fit together; [`Error::Interrupted`].
    pub fn positions<T: Real>(
        &self,
        values: &[T],
        (frames, points): (usize, usize),
        confidence: Option<&[T]>,
        found: &mut [bool],
        interrupt: &Interrupt,
    ) -> Result<(), Error> {
        check_length("positions", frames * points * 3, values.len())?;
        let at = |frame, point| {
            let i = (frame * points + point) * 3;
            Position([values[i], values[i + 1], values[i + 2]].map(T::to_f64))
        };
        self.run((frames, points), at, confidence, found, interrupt)
    }

    fn run<T: Real, P: Place>(
        &self,
        (frames, joints): (usize, usize),
        at: impl Fn(usize, usize) -> P + Sync,
        confidence: Option<&[T]>,
        found: &mut [bool],
        interrupt: &Interrupt,
    ) -> Result<(), Error> {
        check_length("found", frames * joints, found.len())?;
        check_length("noise", joints, self.noise.len())?;
        check_length("smallest", joints, self.smallest.len())?;
        if let Some(confidence) = confidence {
            check_length("confidence", frames * joints, confidence.len())?;
        }
        found.fill(false);
        let columns = parallel::map((0..joints).collect(), found.len() * 20, |_, joint: usize| {
            let trust = confidence.map(|c| c.iter().skip(joint).step_by(joints));
            let joint = Joint {
                path: (0..frames).map(|frame| at(frame, joint)).collect(),
                trust: trust.map_or_else(|| vec![1.0; frames], |c| c.map(|x| x.to_f64()).collect()),
                usual: DEVIATION_OF_NOISE * self.noise[joint],
                smallest: self.smallest[joint],
                radius: self.radius,
                threshold: self.threshold,
                longest: self.longest,
            };
            joint.spikes(interrupt)
        })?;
        for (joint, column) in columns.into_iter().enumerate() {
            for frame in column {
                found[frame * joints + joint] = true;
            }
        }
        Ok(())
    }
}
