//! What all joints do together is of low rank: a few movements at a time, in each band of frequencies.
//!
//! Windows of the vectors of all joints about the pilot, half of the way to the samples, become cosines; in each band of them the
//! singular values are shrunk. Windows overlap by half; those of a pass are computed together, and added up in their order.
//!
//! - `window`: cosines, bands and what is taken away in them;
//! - `symmetric`: eigenvectors;
//! - `products`: products of matrices.

mod products;
mod symmetric;
mod window;

use super::about::{About, Noisy};
use crate::clip::Planes;
use crate::error::check_length;
use crate::parallel::{self, Interrupt};
use crate::{ClipMut, Error, Real};
use products::padded;
pub(super) use symmetric::eigen;
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
const NANOSECONDS: usize = 60;

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
    let enough = |&noise: &f64| if noise < LEAST_NOISE { 0.0 } else { noise };
    let noise: Vec<f64> = noisy.noise.iter().map(enough).collect();
    let joints = noise.iter().filter(|&&noise| noise > 0.0).count();
    if frames < FEWEST || joints < LEAST_JOINTS {
        return noisy.moved(&[], &[], out);
    }
    let noisy = Noisy { noise: &noise, ..*noisy };
    let about = noisy.vectors(interrupt)?;
    let moves = moves(&about, frames, interrupt)?;
    noisy.moved(&about.joints, &moves, out)
}

/// How far the result lies from the pilot.
fn moves(about: &About, frames: usize, interrupt: &Interrupt) -> Result<Vec<Planes<f64>>, Error> {
    let joints = about.joints.len();
    let length = WINDOW.min(frames);
    let last = frames - length;
    let mut starts: Vec<usize> = (0..=last).step_by(length / 2).collect();
    if starts.last() != Some(&last) {
        starts.push(last);
    }
    let cosines = Cosines::new(length);
    let mut totals: Vec<Planes<f64>> = (0..joints).map(|_| Planes::new(3, frames)).collect();
    let mut counts = vec![0.0; frames];
    let weight = |t: usize| (t + 1).min(length - t) as f64;
    for &start in &starts {
        for (t, count) in counts[start..start + length].iter_mut().enumerate() {
            *count += weight(t);
        }
    }
    for pass in starts.chunks(PASS) {
        let work = pass.len() * length * joints * joints * NANOSECONDS;
        let windows = parallel::map(pass.to_vec(), work, |_, start| {
            interrupt.check()?;
            window(about, &cosines, start, length, interrupt)
        })?;
        parallel::for_each(
            totals.iter_mut().zip(&about.beside).collect(),
            pass.len() * length * joints * 20,
            |joint, (total, beside): (&mut Planes<f64>, &Planes<f64>)| {
                for c in 0..3 {
                    let (total, beside) = (total.row_mut(c), beside.row(c));
                    for (&start, poses) in pass.iter().zip(&windows) {
                        let beside = &beside[start..start + length];
                        let mean = beside.iter().sum::<f64>() / length as f64;
                        let taken = poses[joint * 3 + c..].iter().step_by(padded(3 * joints));
                        for ((t, total), (x, taken)) in
                            total[start..start + length].iter_mut().enumerate().zip(beside.iter().zip(taken))
                        {
                            *total += weight(t) * (0.5 * (x - mean) - taken);
                        }
                    }
                }
                Ok(())
            },
        )?;
    }
    for total in &mut totals {
        for c in 0..3 {
            for (x, count) in total.row_mut(c).iter_mut().zip(&counts) {
                *x *= SHARE / count;
            }
        }
    }
    Ok(totals)
}

/// What is taken away from the poses of a window, halfway from the pilot to the samples; a row for each frame.
fn window(
    about: &About,
    cosines: &Cosines,
    start: usize,
    length: usize,
    interrupt: &Interrupt,
) -> Result<Vec<f64>, Error> {
    let columns = 3 * about.joints.len();
    let width = padded(columns);
    let mut poses = vec![0.0; length * width];
    for (joint, (mean, beside)) in about.mean.iter().zip(&about.beside).enumerate() {
        for c in 0..3 {
            let mean = &mean.row(c)[start..start + length];
            let beside = &beside.row(c)[start..start + length];
            let column = poses[joint * 3 + c..].iter_mut().step_by(width);
            for (pose, (mean, beside)) in column.zip(mean.iter().zip(beside)) {
                *pose = mean + 0.5 * beside;
            }
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
