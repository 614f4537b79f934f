//! The clock of the source: which frames of a clip were measured, and the way from them back to all frames.
//!
//! - this file: held, repeated and frozen frames;
//! - `interpolation`: frames on geodesics between measurements;
//! - `spline`: values at the measurements, and a cubic spline of their development;
//! - `tracker_noise`: noise that looks like motion.

mod interpolation;
pub mod spline;
pub mod tracker_noise;

use crate::noise::repeats::find_repeats;
use crate::parallel::Interrupt;
use crate::rotations::quaternion::{between, is_missing, log_short, unit};
use crate::{ClipView, Error, Real};
use std::cmp::Ordering;

/// Share of the moving joints that must equal the frame before, bit for bit, for the frame to be a repeat.
const REPEATS: f64 = 0.9;

/// Median distances between new frames from which a longer one is a freeze.
const FREEZE_GAPS: usize = 3;

/// Seconds that a freeze lasts at least.
const FREEZE_SECONDS: f64 = 0.05;

/// Kinds of sources.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Every frame is new.
    Regular,
    /// At most every second frame is new.
    Held,
    /// Single frames repeat the one before.
    Repeated,
    /// Frames lie on geodesics between the measured ones.
    Interpolated,
}

/// The frames that the source measured.
#[derive(Debug, Clone)]
pub struct Sampling {
    /// The kind of source.
    pub kind: Kind,
    /// Increasing times of the measurements in frames, without those of frozen stretches.
    pub times: Vec<f64>,
    /// Stretches without any new frame, from the last new one before them.
    pub frozen: Vec<bool>,
}

/// Finds the frames that the source measured, at `fps` frames per second.
///
/// # Errors
/// [`Error::Interrupted`].
pub fn sampling<T: Real>(q: ClipView<'_, T>, fps: f64, interrupt: &Interrupt) -> Result<Sampling, Error> {
    let frames = q.frames();
    let repeats = repeated_frames(q)?;
    let mut frozen = vec![false; frames];
    let new: Vec<usize> = (0..frames).filter(|&t| !repeats[t]).collect();
    if new.len() < 2 {
        return Ok(Sampling { kind: Kind::Regular, times: all(frames, |_| true), frozen });
    }
    let gaps: Vec<usize> =
        new.iter().zip(new[1..].iter().chain([&frames])).map(|(start, end)| end - start).collect();
    let mut sorted = gaps[..gaps.len() - 1].to_vec();
    sorted.sort_unstable();
    let usual = sorted[(sorted.len() - 1) / 2];
    for (&start, &gap) in new.iter().zip(&gaps) {
        if gap > FREEZE_GAPS * usual && gap as f64 > FREEZE_SECONDS * fps {
            frozen[start..start + gap].fill(true);
        }
    }
    let measured = all(frames, |t| !repeats[t] && !frozen[t]);
    if usual > 1 {
        return Ok(Sampling { kind: Kind::Held, times: measured, frozen });
    }
    if let Some(mut times) = interpolation::knot_times(q, interrupt)? {
        times.retain(|time| !frozen[time.to_count()]);
        return Ok(Sampling { kind: Kind::Interpolated, times, frozen });
    }
    let repeated = (0..frames).any(|t| repeats[t] && !frozen[t]);
    if repeated {
        return Ok(Sampling { kind: Kind::Repeated, times: measured, frozen });
    }
    Ok(Sampling { kind: Kind::Regular, times: all(frames, |t| !frozen[t]), frozen })
}

fn all(frames: usize, chosen: impl Fn(usize) -> bool) -> Vec<f64> {
    (0..frames).filter(|&t| chosen(t)).map(|t| t as f64).collect()
}

/// The frames that repeat the one before in [`REPEATS`] of the joints that move at all.
fn repeated_frames<T: Real>(q: ClipView<'_, T>) -> Result<Vec<bool>, Error> {
    let (frames, joints) = (q.frames(), q.joints());
    let mut repeats = vec![false; frames * joints];
    find_repeats(q, &mut repeats)?;
    let there = |frame: usize, joint: usize| !is_missing(q.at(frame, joint));
    let mut fresh = vec![0_usize; joints];
    for frame in 0..frames {
        for (joint, fresh) in fresh.iter_mut().enumerate() {
            *fresh += usize::from(!repeats[frame * joints + joint] && there(frame, joint));
        }
    }
    let repeated = |frame: usize| {
        let (mut count, mut same) = (0_usize, 0_usize);
        for (joint, &fresh) in fresh.iter().enumerate() {
            // The first sample of a joint is no repeat; who moves has another new one.
            if fresh > 1 && there(frame, joint) {
                count += 1;
                same += usize::from(repeats[frame * joints + joint]);
            }
        }
        count > 0 && same as f64 >= REPEATS * count as f64
    };
    Ok((0..frames).map(repeated).collect())
}

/// Rotation vectors of a joint from each `every`-th frame to the next such, NaN beside missing samples.
fn increments<T: Real>(q: ClipView<'_, T>, joint: usize, every: usize) -> Vec<[f64; 3]> {
    let sample = |frame: usize| {
        let sample = q.at(frame, joint);
        if is_missing(sample) { [f64::NAN; 4] } else { unit(sample.map(T::to_f64)) }
    };
    let count = q.frames().saturating_sub(1) / every;
    let mut before = if q.frames() > 0 { sample(0) } else { [f64::NAN; 4] };
    (1..=count)
        .map(|step| {
            let after = sample(step * every);
            let half = log_short(between(before, after));
            before = after;
            half.map(|x| 2.0 * x)
        })
        .collect()
}

fn length(v: [f64; 3]) -> f64 {
    (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt()
}

fn difference(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|c| a[c] - b[c])
}

fn order(a: &f64, b: &f64) -> Ordering {
    a.total_cmp(b)
}

/// The value below which a part of the values lies, one of them; 0 without any.
fn quantile(values: &mut [f64], part: f64) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let index = (part * (values.len() - 1) as f64).to_count();
    *values.select_nth_unstable_by(index, order).1
}

/// The lower median; 0 without any.
fn middle(values: &mut [f64]) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let index = (values.len() - 1) / 2;
    *values.select_nth_unstable_by(index, order).1
}
