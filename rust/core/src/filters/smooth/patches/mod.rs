//! Groups of similar patches: the non-local step of automatic smoothing.
//!
//! M. Lebrun, A. Buades and J.-M. Morel, "A Nonlocal Bayesian Image Denoising Algorithm". About a first estimate, the pilot, its
//! development and the way to the samples are vectors, `P` and `X`, divided by the joint's noise. For each joint and the one that
//! moves most like it, a patch of both is a vector of cosine coefficients, `p` of the pilot and `x` of the rest:
//!
//! ```text
//! μ, C  = mean and covariance of the pilot's patches most like p
//! f − p = x − (C + I)⁻¹ (p + x − μ)                 f = μ + C (C + I)⁻¹ (p + x − μ), the best estimate
//! r exp(σ mean(f − p) / 2)                          the mean over all patches that hold a sample
//! ```
//!
//! Patches begin every few frames; those of some hundred frames and one group are a task, which writes its own slice. The patches
//! of a pass are averaged before the next pass begins, so that memory is a few numbers for each sample.
//!
//! - `groups`: which joints move alike;
//! - `cosines`: patches as coefficients, and back;
//! - `estimates`: the patches of a task, and the averages of a pass;
//! - `nearest`: the most similar patches;
//! - `wiener`: the estimate of one patch.

mod cosines;
mod estimates;
mod groups;
mod nearest;
mod wiener;

use super::about::Noisy;
use crate::error::check_length;
use crate::parallel::Interrupt;
use crate::{ClipMut, ClipView, Error, Real};

/// Frames of a patch.
const LENGTH: usize = 24;

/// Cosine coefficients of a patch that are estimated, from the lowest on.
const COEFFICIENTS: usize = 8;

/// Joints of a group: each joint, and the one that moves most like it.
const COMPANIONS: usize = 2;

/// Frames from one model to the next.
const STEP: usize = 24;

/// Frames about the patch of a model within which those of the patches most like it are estimated with it that lie a multiple of
/// [`APART`] away.
const NEAR: usize = 21;

/// Frames from one patch that is estimated with a model to the next.
const APART: usize = 3;

/// Frames within which similar patches are looked for, before and after.
const RADIUS: usize = 256;

/// How many of the most similar patches count.
const NEIGHBORS: usize = 80;

/// Frames of a clip that holds so many patches; in shorter ones the pilot stays.
const SHORTEST: usize = LENGTH + NEIGHBORS - 1;

/// Radians per component below which a joint has no noise: little more than roundings in float32.
const LEAST_NOISE: f64 = 1e-6;

/// Estimated nanoseconds of a model and its estimates.
const NANOSECONDS: usize = 20_000;

/// Improves the pilot by groups of its similar patches.
///
/// The step is made `rounds` times, each time with the result before as pilot. Joints with hardly any noise stay as the pilot has
/// them.
///
/// # Errors
/// [`Error::Length`] if slices do not fit together; [`Error::Interrupted`].
pub fn smooth_patches<T: Real>(
    noisy: &Noisy<'_, T>,
    rounds: usize,
    out: ClipMut<'_, T>,
    interrupt: &Interrupt,
) -> Result<(), Error> {
    noisy.check()?;
    let (frames, joints) = (noisy.clip.frames(), noisy.clip.joints());
    let out = out.into_data();
    check_length("out", noisy.clip.data().len(), out.len())?;
    if out.is_empty() {
        return Ok(());
    }
    if frames < SHORTEST || rounds == 0 || noisy.joints(LEAST_NOISE).is_empty() {
        return noisy.unmoved(out);
    }
    estimates::improve(noisy, out, interrupt)?;
    for _ in 1..rounds {
        let pilot = out.to_vec();
        let round = Noisy { pilot: ClipView::new(&pilot, frames, joints)?, ..*noisy };
        estimates::improve(&round, out, interrupt)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn attempt(frames: usize, of_pilot: usize, noise: usize, interrupt: &Interrupt) -> Result<(), Error> {
        let q = [1.0, 0.0, 0.0, 0.0].repeat(frames);
        let pilot = [1.0, 0.0, 0.0, 0.0].repeat(of_pilot);
        let mut out = vec![0.0; q.len()];
        let noisy = Noisy {
            clip: ClipView::new(&q, frames, 1)?,
            pilot: ClipView::new(&pilot, of_pilot, 1)?,
            confidence: None,
            noise: &vec![0.1; noise],
        };
        smooth_patches(&noisy, 1, ClipMut::new(&mut out, frames, 1)?, interrupt)
    }

    #[test]
    fn slices_that_do_not_fit_are_refused() {
        let interrupt = Interrupt::new();
        assert_eq!(attempt(200, 200, 1, &interrupt), Ok(()));
        assert_eq!(
            attempt(200, 199, 1, &interrupt),
            Err(Error::Length { name: "pilot", expected: 800, got: 796 })
        );
        assert_eq!(
            attempt(200, 200, 2, &interrupt),
            Err(Error::Length { name: "noise", expected: 1, got: 2 })
        );
    }

    #[test]
    fn it_stops_when_asked_to() {
        let interrupt = Interrupt::new();
        interrupt.set();
        assert_eq!(attempt(200, 200, 1, &interrupt), Err(Error::Interrupted));
    }
}
