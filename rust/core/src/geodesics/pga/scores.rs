//! Parameters along geodesics, and rotations from parameters.

use super::samples::{left_of, upper};
use crate::error::check_length;
use crate::parallel::{self, Interrupt};
use crate::rotations::quaternion::{between, is_missing, product, unit};
use crate::simd::multiversion;
use crate::{ClipView, Error, Real};

/// Frames per task.
const TASK: usize = 512;

/// Frames per vector operation.
const LANES: usize = 16;

/// Fitted geodesics of all joints.
#[derive(Debug, Clone, Copy)]
pub struct Geodesics<'a, T> {
    /// Unit quaternions, `(joints, 4)`.
    pub means: &'a [T],
    /// Unit vectors, `(k, joints, 3)`.
    pub directions: &'a [T],
}

impl<T: Real> Geodesics<'_, T> {
    /// Number of geodesics per joint.
    fn components(self, joints: usize) -> Result<usize, Error> {
        check_length("means", joints * 4, self.means.len())?;
        let components = self.directions.len() / (joints * 3).max(1);
        check_length("directions", components * joints * 3, self.directions.len())?;
        Ok(components)
    }

    fn mean(self, joint: usize) -> [f64; 4] {
        std::array::from_fn(|i| self.means[joint * 4 + i].to_f64())
    }

    fn axis(self, component: usize, joints: usize, joint: usize) -> [f64; 3] {
        std::array::from_fn(|i| self.directions[(component * joints + joint) * 3 + i].to_f64())
    }
}

/// Parameters `2 s*` of each sample's projections, one geodesic after the other, `(frames, joints, 4)` → `(frames, joints, k)`.
///
/// Radians of rotation in `[−π, π]`; NaN for missing samples.
///
/// # Errors
/// [`Error::Length`] if the lengths of slices do not agree; [`Error::Interrupted`].
pub fn geodesic_scores<T: Real>(
    clip: ClipView<'_, T>,
    geodesics: Geodesics<'_, T>,
    out: &mut [T],
    interrupt: &Interrupt,
) -> Result<(), Error> {
    let joints = clip.joints();
    let k = geodesics.components(joints)?;
    check_length("out", clip.frames() * joints * k, out.len())?;
    if out.is_empty() {
        return Ok(());
    }
    let nanoseconds = out.len() * 20;
    let tasks: Vec<&mut [T]> = out.chunks_mut(TASK * joints * k).collect();
    parallel::for_each(tasks, nanoseconds, |task, out| {
        interrupt.check()?;
        let frames = out.len() / (joints * k);
        for joint in 0..joints {
            let centre = unit(geodesics.mean(joint));
            for first in (0..frames).step_by(LANES) {
                let count = LANES.min(frames - first);
                let mut x = [[1.0; LANES], [0.0; LANES], [0.0; LANES], [0.0; LANES]];
                let mut missing = [false; LANES];
                for c in 0..count {
                    let q = clip.at(task * TASK + first + c, joint);
                    missing[c] = is_missing(q);
                    if !missing[c] {
                        let at = upper(between(centre, unit(q.map(T::to_f64))));
                        [x[0][c], x[1][c], x[2][c], x[3][c]] = at;
                    }
                }
                for component in 0..k {
                    let mut scores = [0.0; LANES];
                    project(&mut x, geodesics.axis(component, joints, joint), &mut scores);
                    for c in 0..count {
                        let score = if missing[c] { T::nan() } else { T::from_f64(scores[c]) };
                        out[((first + c) * joints + joint) * k + component] = score;
                    }
                }
            }
        }
        Ok(())
    })
}

multiversion! {
    /// Parameters along the geodesic with the direction `v`; replaces the rotations by their residuals.
    fn project(x: &mut [[f64; LANES]; 4], v: [f64; 3], scores: &mut [f64; LANES]) {
        for c in 0..LANES {
            let at = [x[0][c], x[1][c], x[2][c], x[3][c]];
            let p = at[1] * v[0] + at[2] * v[1] + at[3] * v[2];
            scores[c] = 2.0 * p.abs().atan2_nonnegative(at[0]).copysign(p);
            let [w, a, b, c_] = left_of(at, v);
            (x[0][c], x[1][c], x[2][c], x[3][c]) = (w, a, b, c_);
        }
    }
}

/// Rotations `mean · c_{v_1}(s_1) · c_{v_2}(s_2) · …` with `w ≥ 0`, `(frames, joints, k)` → `(frames, joints, 4)`.
///
/// # Errors
/// [`Error::Length`] if the lengths of slices do not agree; [`Error::Interrupted`].
pub fn geodesic_product<T: Real>(
    scores: &[T],
    joints: usize,
    geodesics: Geodesics<'_, T>,
    out: &mut [T],
    interrupt: &Interrupt,
) -> Result<(), Error> {
    let k = geodesics.components(joints)?;
    let frames = out.len() / (joints * 4).max(1);
    check_length("out", frames * joints * 4, out.len())?;
    check_length("scores", frames * joints * k, scores.len())?;
    if out.is_empty() {
        return Ok(());
    }
    let nanoseconds = frames * joints * (5 + 20 * k);
    let tasks: Vec<&mut [T]> = out.chunks_mut(TASK * joints * 4).collect();
    parallel::for_each(tasks, nanoseconds, |task, out| {
        interrupt.check()?;
        let frames = out.len() / (joints * 4);
        for joint in 0..joints {
            let mean = geodesics.mean(joint);
            for first in (0..frames).step_by(LANES) {
                let count = LANES.min(frames - first);
                let mut q = mean.map(|x| [x; LANES]);
                for component in 0..k {
                    let mut angles = [0.0; LANES];
                    for (c, angle) in angles.iter_mut().enumerate().take(count) {
                        let row = (task * TASK + first + c) * joints + joint;
                        *angle = scores[row * k + component].to_f64() / 2.0;
                    }
                    rotate(&mut q, geodesics.axis(component, joints, joint), &angles);
                }
                let [w, x, y, z] = &q;
                for (c, (((w, x), y), z)) in w.iter().zip(x).zip(y).zip(z).enumerate().take(count) {
                    let at = ((first + c) * joints + joint) * 4;
                    out[at..at + 4].copy_from_slice(&upper([*w, *x, *y, *z]).map(T::from_f64));
                }
            }
        }
        Ok(())
    })
}

multiversion! {
    /// Multiplies rotations by `c_v(s)`.
    fn rotate(q: &mut [[f64; LANES]; 4], v: [f64; 3], angles: &[f64; LANES]) {
        for c in 0..LANES {
            let (sine, cosine) = Real::sin_cos(angles[c]);
            let factor = [cosine, sine * v[0], sine * v[1], sine * v[2]];
            let [w, x, y, z] = product([q[0][c], q[1][c], q[2][c], q[3][c]], factor);
            (q[0][c], q[1][c], q[2][c], q[3][c]) = (w, x, y, z);
        }
    }
}
