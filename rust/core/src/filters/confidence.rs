//! Confidence for filters without weights: samples of low confidence are first moved towards their surroundings.

use super::gaps::{self, Method};
use crate::error::check_length;
use crate::rotations::continuity::make_continuous;
use crate::rotations::quaternion::{dot, geodesic, unit};
use crate::window::Boundary;
use crate::{ClipMut, ClipView, Error, Real, parallel};

/// Standard deviation of the Gaussian weights of the surroundings, in frames.
const SIGMA: f64 = 2.0;

/// Radius of the surroundings in frames: four standard deviations.
const RADIUS: isize = 8;

/// Samples per task.
const TILE: usize = 8 * 1024;

/// Moves samples `(frames, joints, 4)` towards their surroundings, by one minus their `confidence`, `(frames,
/// joints)`.
///
/// Samples of confidence 0 are interpolated along the geodesics between the others. Samples of a confidence `c`
/// between 0 and 1 move by the fraction `1 − c` towards the mean of their surroundings: `Σ_r exp(−r² / 2σ²) c_{t+r}
/// q_{t+r}`, normalised, along the sign-continuous path, with mirrored ends. Samples of confidence 1 are unchanged,
/// and so are joints whose confidence is 0 in all frames. The result is continuous in sign from the first sample with
/// confidence.
///
/// # Errors
/// [`Error::Length`] if the lengths of slices do not agree.
pub fn pulled_by_confidence<T: Real>(
    q: ClipView<'_, T>,
    confidence: &[T],
    out: ClipMut<'_, T>,
) -> Result<(), Error> {
    let (frames, joints) = (q.frames(), q.joints());
    let out = out.into_data();
    check_length("out", q.data().len(), out.len())?;
    check_length("confidence", frames * joints, confidence.len())?;
    if out.is_empty() {
        return Ok(());
    }
    let known = known(q, confidence);
    let mut filled = vec![false; confidence.len()];
    let view = ClipView::new(&known, frames, joints)?;
    gaps::fill_gaps(view, None, Method::Slerp, ClipMut::new(out, frames, joints)?, &mut filled)?;
    if confidence.iter().all(|&c| c == T::ZERO || c == T::ONE) {
        return Ok(());
    }
    let path = out.to_vec();
    let path = ClipView::new(&path, frames, joints)?;
    let length = (TILE / joints).max(1) * joints;
    let tiles = out.chunks_mut(length * 4).collect();
    parallel::for_each(tiles, confidence.len() * 20, |tile, out: &mut [T]| {
        for (i, sample) in out.chunks_exact_mut(4).enumerate() {
            let at = tile * length + i;
            let c = confidence[at].to_f64();
            if c > 0.0 && c < 1.0 {
                let (frame, joint) = (at / joints, at % joints);
                let own = unit(path.at(frame, joint).map(T::to_f64));
                let mean = surroundings(path, confidence, frame, joint);
                sample.copy_from_slice(&geodesic(own, mean.unwrap_or(own), 1.0 - c).map(T::from_f64));
            }
        }
        Ok(())
    })?;
    make_continuous(out, joints)
}

/// The clip with NaN where the confidence is 0, in joints with confidence in at least one frame.
fn known<T: Real>(q: ClipView<'_, T>, confidence: &[T]) -> Vec<T> {
    let joints = q.joints();
    let mut has_confidence = vec![false; joints];
    for row in confidence.chunks_exact(joints) {
        for (has_confidence, &confidence) in has_confidence.iter_mut().zip(row) {
            *has_confidence |= confidence > T::ZERO;
        }
    }
    let mut known = q.data().to_vec();
    for (at, sample) in known.chunks_exact_mut(4).enumerate() {
        if confidence[at] == T::ZERO && has_confidence[at % joints] {
            sample.fill(T::nan());
        }
    }
    known
}

/// The mean of the samples around one, weighted by confidence and by distance in time; `None` if their sum is 0.
fn surroundings<T: Real>(
    path: ClipView<'_, T>,
    confidence: &[T],
    frame: usize,
    joint: usize,
) -> Option<[f64; 4]> {
    let mut total = [0.0; 4];
    for r in -RADIUS..=RADIUS {
        let source = Boundary::Mirror.source(frame.cast_signed() + r, path.frames());
        let weight = Real::exp(-((r * r) as f64) / (2.0 * SIGMA * SIGMA))
            * confidence[source * path.joints() + joint].to_f64();
        if weight > 0.0 {
            let q = unit(path.at(source, joint).map(T::to_f64));
            for c in 0..4 {
                total[c] += weight * q[c];
            }
        }
    }
    (dot(total, total) > 0.0).then(|| unit(total))
}
