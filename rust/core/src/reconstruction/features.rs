//! Poses as feature vectors: the distance of two vectors is the distance of the poses.

use crate::error::check_length;
use crate::rotations::quaternion::{between, is_missing, log_short};
use crate::simd::multiversion;
use crate::{ClipView, Error, Real, parallel};

/// Frames of a joint that are computed together: the planes of one joint fit in the first-level cache.
const TILE: usize = 64;

/// Tiles per task.
const TILES: usize = 16;

/// Nanoseconds per sample, on one thread.
const NANOSECONDS: usize = 4;

multiversion! {
    /// Features `(frames, 3·joints)` of up to [`TILE`] frames; `means` are `(joints)`, and `scales` are `2 √weight`.
    fn tile<T: Real>(rotations: &[T], means: &[[T; 4]], scales: &[T], out: &mut [T]) {
        let joints = means.len();
        for (joint, (&mean, &scale)) in means.iter().zip(scales).enumerate() {
            let mut samples = [[T::ONE; TILE]; 4];
            let mut vectors = [[T::ZERO; TILE]; 3];
            for (i, row) in rotations.chunks_exact(joints * 4).enumerate().take(TILE) {
                for c in 0..4 {
                    samples[c][i] = row[joint * 4 + c];
                }
            }
            for i in 0..TILE {
                let q = std::array::from_fn(|c| samples[c][i]);
                let vector = log_short(between(mean, q));
                let scale = if is_missing(q) { T::nan() } else { scale };
                for c in 0..3 {
                    vectors[c][i] = vector[c] * scale;
                }
            }
            for (i, row) in out.chunks_exact_mut(joints * 3).enumerate().take(TILE) {
                for c in 0..3 {
                    row[joint * 3 + c] = vectors[c][i];
                }
            }
        }
    }
}

/// Poses as rotation vectors relative to the means `(joints, 4)` of their joints, scaled by the square roots of
/// `weights`, `(joints)`: `x_j = √w_j · 2 log(m_j⁻¹ q_j)`, `(frames, 3·joints)`. The shorter rotation is taken; NaN
/// where a sample is missing.
///
/// # Errors
/// [`Error::Length`] if the lengths of slices do not agree.
pub fn pose_features<T: Real>(
    q: ClipView<'_, T>,
    means: &[f64],
    weights: &[f64],
    out: &mut [T],
) -> Result<(), Error> {
    let (frames, joints) = (q.frames(), q.joints());
    check_length("means", joints * 4, means.len())?;
    check_length("weights", joints, weights.len())?;
    check_length("out", frames * joints * 3, out.len())?;
    if out.is_empty() {
        return Ok(());
    }
    let (means, _) = means.as_chunks::<4>();
    let means: Vec<[T; 4]> = means.iter().map(|mean| mean.map(T::from_f64)).collect();
    let scales: Vec<T> = weights.iter().map(|weight| T::from_f64(2.0 * weight.sqrt())).collect();
    let tasks: Vec<&mut [T]> = out.chunks_mut(TILES * TILE * joints * 3).collect();
    parallel::for_each(tasks, frames * joints * NANOSECONDS, |task, out| {
        for (i, out) in out.chunks_mut(TILE * joints * 3).enumerate() {
            let start = (task * TILES + i) * TILE;
            let rotations = q.slice(start, (start + TILE).min(frames)).data();
            tile(rotations, &means, &scales, out);
        }
        Ok(())
    })
}
