//! Parameters of poses along geodesics, and poses from parameters.

use super::objective::SAMPLE_NANOSECONDS;
use super::poses::{Lane, Part, Poses, TILE, go_on, parts, take_away};
use super::projection::nearest_points;
use super::{TASK, frames_with_samples, wide_means};
use crate::error::check_length;
use crate::parallel::{self, Interrupt};
use crate::{ClipView, Error, Real};

/// Directions `(k, joints, 3)` as parts.
fn directions<T: Real>(directions: &[T], joints: usize) -> Result<Vec<Vec<Part>>, Error> {
    let row = joints * 3;
    check_length("directions", directions.len() / row.max(1) * row, directions.len())?;
    let which: Vec<usize> = (0..joints).collect();
    let wide: Vec<f64> = directions.iter().map(|x| x.to_f64()).collect();
    Ok(wide.chunks_exact(row.max(1)).map(|v| parts(v, &which)).collect())
}

/// Parameters `2 s` of each pose's projections, one geodesic after the other, `(frames, k)`, in radians of rotation;
/// NaN for poses without a valid sample.
///
/// # Errors
/// [`Error::Length`] if the lengths of slices do not agree; [`Error::Interrupted`].
pub fn body_scores<T: Real>(
    clip: ClipView<'_, T>,
    means: &[T],
    axes: &[T],
    out: &mut [T],
    interrupt: &Interrupt,
) -> Result<(), Error> {
    let joints = clip.joints();
    let means = wide_means(means, joints)?;
    let axes = directions(axes, joints)?;
    let k = axes.len();
    out.fill(T::nan());
    if k == 0 {
        return Ok(());
    }
    check_length("out", clip.frames() * k, out.len())?;
    let frames = frames_with_samples(clip);
    let Poses { tiles, .. } = Poses::of_frames(clip, &frames, &means, interrupt)?;
    let nanoseconds = frames.len() * joints * k * SAMPLE_NANOSECONDS * 4;
    let scores = parallel::map(tiles, nanoseconds, |_, mut tile| {
        let mut scores = Vec::with_capacity(k);
        for v in &axes {
            interrupt.check()?;
            let mut s = Lane::ZERO;
            nearest_points(&tile, v, false, &mut s);
            take_away(&mut tile, v, &s);
            scores.push(s);
        }
        Ok(scores)
    })?;
    for (i, &frame) in frames.iter().enumerate() {
        for (out, s) in out[frame * k..(frame + 1) * k].iter_mut().zip(&scores[i / TILE]) {
            *out = T::from_f64(2.0 * s.0[i % TILE]);
        }
    }
    Ok(())
}

/// Poses `mean · c_{v_1}(s_1) · c_{v_2}(s_2) · …`, `(frames, k)` → `(frames, joints, 4)`, with `w ≥ 0`.
///
/// # Errors
/// [`Error::Length`] if the lengths of slices do not agree; [`Error::Interrupted`].
pub fn body_product<T: Real>(
    scores: &[T],
    means: &[T],
    axes: &[T],
    out: &mut [T],
    interrupt: &Interrupt,
) -> Result<(), Error> {
    let joints = means.len() / 4;
    let means = wide_means(means, joints)?;
    let axes = directions(axes, joints)?;
    let k = axes.len();
    let row = joints * 4;
    if row == 0 {
        return Ok(());
    }
    let frames = out.len() / row;
    check_length("out", frames * row, out.len())?;
    check_length("scores", frames * k, scores.len())?;
    let tasks: Vec<&mut [T]> = out.chunks_mut(TASK * row).collect();
    parallel::for_each(tasks, frames * joints * (k + 1) * 10, |task, out| {
        for (tile, out) in out.chunks_mut(TILE * row).enumerate() {
            interrupt.check()?;
            let first = task * TASK + tile * TILE;
            let count = out.len() / row;
            let mut s = vec![Lane::ZERO; k];
            for i in 0..count {
                for (s, score) in s.iter_mut().zip(&scores[(first + i) * k..]) {
                    s.0[i] = score.to_f64() / 2.0;
                }
            }
            for (joint, mean) in means.iter().enumerate() {
                let mut q = mean.map(|x| Lane([x; TILE]));
                for (v, s) in axes.iter().zip(&s) {
                    go_on(&mut q, v[joint], s);
                }
                for i in 0..count {
                    let sign = 1.0_f64.copysign(q[0].0[i]);
                    for c in 0..4 {
                        out[i * row + joint * 4 + c] = T::from_f64(q[c].0[i] * sign);
                    }
                }
            }
        }
        Ok(())
    })
}
