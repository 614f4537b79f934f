//! Whitening: vectors whose noise is alike in time and direction, and back.

use crate::error::check_length;
use crate::parallel::Interrupt;
use crate::rotations::quaternion::{between, exp_one, log_short, of_row, product, unit};
use crate::{ClipView, Error, Real};

/// Frames after which the interrupt flag is looked at.
const PATIENCE: usize = 1024;

/// What is known of noise: `n_{t+1} = ρ n_t + e_t`, and `e_t` with the deviations `spread` along `axes`.
#[derive(Debug, Clone, Copy)]
pub struct Shape<'a> {
    /// `ρ`, at least 0 and below 1.
    pub colour: f64,
    /// `s`, `(joints, 3)`, above 0.
    pub spread: &'a [f64],
    /// `V`, `(joints, 3, 3)`, with the axes as columns.
    pub axes: &'a [f64],
}

/// Where [`Shape::whiten`] writes.
#[derive(Debug)]
pub struct Whitened<'a> {
    /// The path `p`, `(frames, joints, 4)`.
    pub reference: &'a mut [f64],
    /// `U`, `(frames, joints, 3)`.
    pub development: &'a mut [f64],
    /// `u`, `(frames, joints, 3)`.
    pub vectors: &'a mut [f64],
}

impl Shape<'_> {
    fn joints(&self) -> usize {
        self.spread.len() / 3
    }

    /// `V diag(f(s)) Vᵀ` for each joint.
    fn weights(&self, f: impl Fn(f64) -> f64) -> Vec<[[f64; 3]; 3]> {
        let joints = self.spread.chunks_exact(3).zip(self.axes.chunks_exact(9));
        joints
            .map(|(s, v)| {
                std::array::from_fn(|i| {
                    std::array::from_fn(|l| (0..3).map(|k| v[i * 3 + k] * f(s[k]) * v[l * 3 + k]).sum())
                })
            })
            .collect()
    }

    /// Turns a developed clip, `(reference, development, vectors)`, into one with white noise: `u_t = W (y_t − ρ y_{t−1})` and
    /// `u_0 = (1 − ρ) W y_0` with `W = V diag(1/s) Vᵀ`, the development in the same way, and a reference path that follows it.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices do not fit; [`Error::Interrupted`].
    pub fn whiten(
        &self,
        (reference, development, vectors): (&[f64], &[f64], &[f64]),
        out: Whitened<'_>,
        interrupt: &Interrupt,
    ) -> Result<(), Error> {
        let joints = self.joints();
        check_length("axes", joints * 9, self.axes.len())?;
        check_length("development", vectors.len(), development.len())?;
        check_length("reference", vectors.len() / 3 * 4, reference.len())?;
        check_length("out.reference", reference.len(), out.reference.len())?;
        check_length("out.development", vectors.len(), out.development.len())?;
        check_length("out.vectors", vectors.len(), out.vectors.len())?;
        let weights = self.weights(|s| 1.0 / s);
        self.innovations(&weights, development, out.development, interrupt)?;
        self.innovations(&weights, vectors, out.vectors, interrupt)?;
        let row = joints * 4;
        for i in 0..reference.len() / 4 {
            let here = if i < joints {
                of_row(&reference[i * 4..])
            } else {
                let (now, before) = (&out.development[i * 3..], &out.development[(i - joints) * 3..]);
                let half = std::array::from_fn(|c| (now[c] - before[c]) / 2.0);
                unit(product(of_row(&out.reference[i * 4 - row..]), exp_one(half)))
            };
            out.reference[i * 4..i * 4 + 4].copy_from_slice(&here);
        }
        Ok(())
    }

    fn innovations(
        &self,
        weights: &[[[f64; 3]; 3]],
        vectors: &[f64],
        out: &mut [f64],
        interrupt: &Interrupt,
    ) -> Result<(), Error> {
        let row = weights.len() * 3;
        for (frame, to) in out.chunks_exact_mut(row.max(1)).enumerate() {
            if frame % PATIENCE == 0 {
                interrupt.check()?;
            }
            let here = &vectors[frame * row..(frame + 1) * row];
            let before = &vectors[frame.saturating_sub(1) * row..];
            for (joint, weights) in weights.iter().enumerate() {
                let i = joint * 3;
                let rest = std::array::from_fn(|c| here[i + c] - self.colour * before[i + c]);
                to[i..i + 3].copy_from_slice(&applied(weights, rest));
            }
        }
        Ok(())
    }

    /// The vectors about the first reference path of filtered white ones, `(frames, joints, 3)`: the inverse of [`Shape::whiten`].
    ///
    /// # Errors
    /// [`Error::Length`] if the slices do not fit; [`Error::Interrupted`].
    pub fn unwhiten<T: Real>(
        &self,
        q: ClipView<'_, T>,
        (reference, development): (&[f64], &[f64]),
        out: &mut [f64],
        interrupt: &Interrupt,
    ) -> Result<(), Error> {
        let joints = self.joints();
        check_length("spread", q.joints() * 3, self.spread.len())?;
        check_length("axes", joints * 9, self.axes.len())?;
        check_length("reference", q.data().len(), reference.len())?;
        check_length("development", q.data().len() / 4 * 3, development.len())?;
        check_length("out", development.len(), out.len())?;
        let weights = self.weights(|s| s);
        for frame in 0..q.frames() {
            if frame % PATIENCE == 0 {
                interrupt.check()?;
            }
            for (joint, weights) in weights.iter().enumerate() {
                let i = frame * joints + joint;
                let here = unit(q.at(frame, joint).map(T::to_f64));
                let beside = log_short(between(of_row(&reference[i * 4..]), here));
                let white = std::array::from_fn(|c| development[i * 3 + c] + 2.0 * beside[c]);
                let vector = applied(weights, white);
                for c in 0..3 {
                    out[i * 3 + c] = if frame == 0 {
                        vector[c] / (1.0 - self.colour)
                    } else {
                        vector[c] + self.colour * out[(i - joints) * 3 + c]
                    };
                }
            }
        }
        Ok(())
    }
}

#[inline(always)]
fn applied(weights: &[[f64; 3]; 3], x: [f64; 3]) -> [f64; 3] {
    weights.map(|row| row[0] * x[0] + row[1] * x[1] + row[2] * x[2])
}
