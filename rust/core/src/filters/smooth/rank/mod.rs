//! What all joints do together is of low rank: a few movements at a time, in each band of frequencies.
//!
//! Windows of the vectors of all joints about the pilot, half of the way to the samples, become cosines; in each band of them the
//! singular values are shrunk. Windows overlap by half; those of a pass are computed together, and added up in their order.
//!
//! - `window`: cosines, bands and what is taken away in them.

mod window;

use super::about::{About, Noisy};
use super::products::padded;
use super::sums::{Joint, Sums};
use crate::error::check_length;
use crate::parallel::{self, Interrupt};
use crate::{ClipMut, Error, Real};
use std::ops::Range;
use window::Cosines;

/// Frames of a window, at most.
const WINDOW: usize = 512;

/// Frames: the first band holds longer periods, each other one those down to half of the one before it.
const LONGEST_PERIOD: usize = 60;

/// Frames of a clip, at least; in shorter ones the pilot stays.
const FEWEST: usize = 128;

/// Noisy joints, at least; with fewer the pilot stays.
const LEAST_JOINTS: usize = 4;

/// Radians per component below which a joint has no noise: little more than roundings in float32.
const LEAST_NOISE: f64 = 1e-6;

/// Variance of the errors of the mean of pilot and samples, where the noise has 1.
const VARIANCE: f64 = 0.3;

/// Share of the estimate of low rank beside the pilot.
const SHARE: f64 = 0.35;

/// Windows of a pass: enough for threads, few for memory.
const PASS: usize = 16;

/// Estimated nanoseconds per frame, joint and joint: products and eigenvectors.
const NANOSECONDS: usize = 20;

/// Takes the mean of the pilot and of an estimate that has low rank in bands of frequencies.
///
/// # Errors
/// [`Error::Length`] if slices do not fit together; [`Error::Interrupted`].
pub fn smooth_rank<T: Real>(
    noisy: &Noisy<'_, T>,
    out: ClipMut<'_, T>,
    interrupt: &Interrupt,
) -> Result<(), Error> {
    noisy.check()?;
    let frames = noisy.clip.frames();
    let out = out.into_data();
    check_length("out", noisy.clip.data().len(), out.len())?;
    if out.is_empty() {
        return Ok(());
    }
    let joints = noisy.joints(LEAST_NOISE);
    if frames < FEWEST || joints.len() < LEAST_JOINTS {
        return noisy.unmoved(out);
    }
    let length = WINDOW.min(frames);
    let last = frames - length;
    let mut starts: Vec<usize> = (0..=last).step_by(length / 2).collect();
    if starts.last() != Some(&last) {
        starts.push(last);
    }
    let cosines = Cosines::new(length);
    let weights: Vec<f64> = (0..length).map(|t| (t + 1).min(length - t) as f64).collect();
    let mut about = Vec::new();
    let mut sums = Sums::new(joints.len());
    for (pass, own) in starts.chunks(PASS).enumerate() {
        let first = own[0];
        let end = own[own.len() - 1] + length;
        noisy.vectors(&joints, first..end, &mut about, interrupt)?;
        let work = own.len() * length * joints.len() * joints.len().min(length) * NANOSECONDS;
        let windows = parallel::map(own.to_vec(), work, |_, start| {
            interrupt.check()?;
            window(&about, &cosines, start - first..start - first + length, interrupt)
        })?;
        let work = own.len() * length * joints.len() * 20;
        sums.add(end, work, |joint, from, sums| {
            for (&start, taken) in own.iter().zip(&windows) {
                let beside = about[joint].beside().map(|plane| &plane[start - first..][..length]);
                add(beside, taken, joint, &weights, start - from, sums);
            }
        })?;
        // No later window holds the frames before the next one begins.
        let settled = starts.get((pass + 1) * PASS).copied().unwrap_or(frames);
        sums.settle(noisy, &joints, settled, SHARE, out)?;
    }
    noisy.sign(out)
}

/// Adds to the sums of a joint, from the frame `at` on, what a window says: half of the way to the samples, but for its mean, less
/// what is taken away from the poses halfway.
fn add(beside: [&[f64]; 3], taken: &[f64], joint: usize, weights: &[f64], at: usize, sums: &mut Joint) {
    let width = taken.len() / weights.len();
    let [x, y, z, total] = sums.each_mut().map(|plane| &mut plane[at..at + weights.len()]);
    for (c, (sums, beside)) in [x, y, z].into_iter().zip(beside).enumerate() {
        let mean = beside.iter().sum::<f64>() / weights.len() as f64;
        let taken = taken[joint * 3 + c..].iter().step_by(width);
        for ((sum, weight), (x, taken)) in sums.iter_mut().zip(weights).zip(beside.iter().zip(taken)) {
            *sum += weight * (0.5 * (x - mean) - taken);
        }
    }
    for (total, weight) in total.iter_mut().zip(weights) {
        *total += weight;
    }
}

/// What is taken away from the poses of a window, halfway from the pilot to the samples; a row for each frame.
fn window(
    about: &[About],
    cosines: &Cosines,
    frames: Range<usize>,
    interrupt: &Interrupt,
) -> Result<Vec<f64>, Error> {
    let columns = 3 * about.len();
    let width = padded(columns);
    let mut poses = vec![0.0; frames.len() * width];
    let planes = about.iter().flat_map(|about| about.mean().into_iter().zip(about.beside()));
    for (plane, (mean, beside)) in planes.enumerate() {
        let (mean, beside) = (&mean[frames.clone()], &beside[frames.clone()]);
        let column = poses[plane..].iter_mut().step_by(width);
        for (pose, (mean, beside)) in column.zip(mean.iter().zip(beside)) {
            *pose = mean + 0.5 * beside;
        }
    }
    cosines.removed(&mut poses, columns, interrupt)?;
    Ok(poses)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ClipView;

    fn attempt(frames: usize, of_pilot: usize, noise: usize, interrupt: &Interrupt) -> Result<(), Error> {
        let q = [1.0, 0.0, 0.0, 0.0].repeat(frames * 4);
        let pilot = [1.0, 0.0, 0.0, 0.0].repeat(of_pilot * 4);
        let mut out = vec![0.0; q.len()];
        let noisy = Noisy {
            clip: ClipView::new(&q, frames, 4)?,
            pilot: ClipView::new(&pilot, of_pilot, 4)?,
            confidence: None,
            noise: &vec![0.1; noise],
        };
        smooth_rank(&noisy, ClipMut::new(&mut out, frames, 4)?, interrupt)
    }

    #[test]
    fn slices_that_do_not_fit_are_refused() {
        let interrupt = Interrupt::new();
        assert_eq!(attempt(200, 200, 4, &interrupt), Ok(()));
        assert_eq!(
            attempt(200, 199, 4, &interrupt),
            Err(Error::Length { name: "pilot", expected: 3200, got: 3184 })
        );
        assert_eq!(
            attempt(200, 200, 2, &interrupt),
            Err(Error::Length { name: "noise", expected: 4, got: 2 })
        );
    }

    #[test]
    fn it_stops_when_asked_to() {
        let interrupt = Interrupt::new();
        interrupt.set();
        assert_eq!(attempt(200, 200, 4, &interrupt), Err(Error::Interrupted));
    }
}
