//! The bilateral orientation filter: neighbours in time have larger weights if their rotations are nearer.
//!
//! N. Courty, "Bilateral human motion filtering". The weights `W_r(i)` decrease with `|r|` and with the angle between
//! `q_i` and `q_{i+r}`; they are the mask of Lee and Shin's construction:
//!
//! ```text
//! F(q_i) = q_i exp(Σ_r W_r(i) S_r(i) / Σ_r W_r(i))
//! S_r(i) = ω_i + … + ω_{i+r−1}   (r > 0),     −(ω_{i+r} + … + ω_{i−1})   (r < 0)
//! ```
//!
//! Both factors of a pair of frames are shared by its two frames, `W_{−r}(i) = W_r(i − r)` and `S_{−r}(i) = −S_r(i −
//! r)`, and from lag to lag `S` grows by one increment.

pub use super::local::Translation;
use super::local::{self, Increments, Local};
use crate::clip::Planes;
use crate::error::check_length;
use crate::parallel::Interrupt;
use crate::rotations::quaternion::angle_between;
use crate::simd::multiversion;
use crate::window::Boundary;
use crate::{ClipMut, ClipView, Error, Real};

/// The shape of the weights.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kernel {
    /// `exp(−|r| / 2σ_t²) · exp(−θ² / 2σ_a²)`.
    Gaussian,
    /// `exp(−|r| / 2σ_t²) · exp(−θ / σ_a²)`: the paper's unsquared distance `θ/2`, with `σ_g = σ_a/2`.
    Printed,
    /// `exp(−r² / 2σ_t²) · exp(−θ² / 2σ_a²)`.
    Classic,
}

/// The parameters of the filter.
#[derive(Debug, Clone)]
pub struct Bilateral {
    /// Radius of the window in frames.
    pub radius: usize,
    /// Scale of distances in time: frames.
    pub sigma_time: f64,
    /// Scale of distances between rotations per joint: radians of rotation; may be infinite.
    pub sigma_angle: Vec<f64>,
    /// Shape of the weights.
    pub kernel: Kernel,
    /// Number of times that the filter is applied.
    pub iterations: usize,
    /// Continuation of the clip beyond its ends, recomputed for each pass.
    pub boundary: Boundary,
    /// Number of later frames with a weight, in each pass; `None` for as many as earlier ones.
    pub lookahead: Option<usize>,
}

/// Largest factor of squared angles: with it only equal rotations have weights, and float32 does not overflow.
pub(super) const LARGEST_FACTOR: f64 = 1e30;

impl Bilateral {
    /// Filters `clip` along time into `out`, `(frames, joints, 4)`, sign-continuous from the hemisphere of the first frame,
    /// and the translation with the weights of the first joint.
    ///
    /// No sample may be missing. Quaternions need not have length 1 exactly.
    ///
    /// # Errors
    /// [`Error::Length`] if the lengths of slices do not agree; [`Error::Interrupted`].
    pub fn filter<T: Real>(
        &self,
        clip: ClipView<'_, T>,
        translation: Option<Translation<'_, T>>,
        out: ClipMut<'_, T>,
        interrupt: &Interrupt,
    ) -> Result<(), Error> {
        check_length("sigma_angle", clip.joints(), self.sigma_angle.len())?;
        local::run(self, (self.iterations, self.boundary), clip, translation, out, interrupt)
    }

    /// The exponent of the weight in time.
    pub(super) fn exponent(&self, lag: usize) -> f64 {
        let lag = lag as f64;
        match self.kernel {
            Kernel::Classic => (lag / self.sigma_time).powi(2) / 2.0,
            Kernel::Gaussian | Kernel::Printed => lag / self.sigma_time / self.sigma_time / 2.0,
        }
    }
}

impl<T: Real> Local<T> for Bilateral {
    fn radius(&self) -> usize {
        self.radius
    }

    fn nanoseconds(&self) -> usize {
        5 + 3 * self.radius
    }

    fn moves(
        &self,
        joint: usize,
        frames: usize,
        q: [&[T]; 4],
        paths: &mut [Increments<'_, T>],
        spare: &mut Planes<T>,
    ) {
        let sigma = self.sigma_angle[joint];
        let squared = self.kernel != Kernel::Printed;
        let factor = T::from_f64((if squared { 0.5 } else { 1.0 } / sigma / sigma).min(LARGEST_FACTOR));
        spare.reshape(8, q[0].len());
        let [weights, total, mut reaches @ ..] = spare.rows_mut::<8>(0);
        let total = &mut total[..frames];
        total.fill(T::ONE);
        for (path, reach) in paths.iter_mut().zip(reaches.chunks_exact_mut(3)) {
            for (moves, reach) in path.moves.iter_mut().zip(reach) {
                moves.fill(T::ZERO);
                reach.fill(T::ZERO);
            }
        }
        for lag in 1..=self.radius {
            // Pairs (u, u + lag): those with the later frame in the tile, and those with the earlier one.
            let first = self.radius - lag;
            let pairs = frames + lag;
            let here = q.map(|q| &q[first..first + pairs]);
            let there = q.map(|q| &q[first + lag..first + lag + pairs]);
            let weights = &mut weights[..pairs];
            let time = T::from_f64(self.exponent(lag).min(LARGEST_FACTOR));
            pair_weights(here, there, time, factor, squared, weights);
            let ahead = self.lookahead.is_none_or(|most| lag <= most);
            if ahead {
                add_both(weights, lag, total);
            } else {
                add_weights(&weights[..frames], total);
            }
            for (path, reach) in paths.iter_mut().zip(reaches.chunks_exact_mut(3)) {
                for ((steps, moves), reach) in path.steps.iter().zip(&mut path.moves).zip(reach) {
                    lengthen(&mut reach[..2 * self.radius + frames - lag], &steps[lag - 1..]);
                    let (reach, moves) = (&reach[first..first + pairs], &mut moves[..frames]);
                    if ahead {
                        add_reaches(weights, reach, lag, moves);
                    } else {
                        take_reaches(weights, reach, moves);
                    }
                }
            }
        }
        for path in paths {
            for moves in &mut path.moves {
                divide(&mut moves[..frames], total);
            }
        }
    }
}

multiversion! {
    /// Weights of pairs of unit quaternions: `exp(−time − factor·θ)`, or with `θ²`.
    fn pair_weights<T: Real>(a: [&[T]; 4], b: [&[T]; 4], time: T, factor: T, squared: bool, weights: &mut [T]) {
        let n = weights.len();
        let (a, b) = (a.map(|a| &a[..n]), b.map(|b| &b[..n]));
        for i in 0..n {
            weights[i] = angle_between([a[0][i], a[1][i], a[2][i], a[3][i]], [b[0][i], b[1][i], b[2][i], b[3][i]]);
        }
        if squared {
            for weight in &mut *weights {
                *weight *= *weight;
            }
        }
        for weight in weights {
            *weight = (-(time + factor * *weight)).exp();
        }
    }
}

multiversion! {
    /// Adds each frame's weights of its later and its earlier neighbour.
    fn add_both<T: Real>(weights: &[T], lag: usize, total: &mut [T]) {
        let n = total.len();
        let (earlier, later) = (&weights[..n], &weights[lag..lag + n]);
        for i in 0..n {
            total[i] += later[i] + earlier[i];
        }
    }
}

multiversion! {
    /// Adds each frame's weight of its earlier neighbour.
    fn add_weights<T: Real>(weights: &[T], total: &mut [T]) {
        let n = total.len();
        let weights = &weights[..n];
        for i in 0..n {
            total[i] += weights[i];
        }
    }
}

multiversion! {
    /// Adds the next increment to each sum of increments.
    fn lengthen<T: Real>(reach: &mut [T], steps: &[T]) {
        let n = reach.len();
        let steps = &steps[..n];
        for i in 0..n {
            reach[i] += steps[i];
        }
    }
}

multiversion! {
    /// Adds the weighted displacements to each frame's later and earlier neighbour.
    fn add_reaches<T: Real>(weights: &[T], reach: &[T], lag: usize, moves: &mut [T]) {
        let n = moves.len();
        let (earlier, later) = (&weights[..n], &weights[lag..lag + n]);
        let (back, ahead) = (&reach[..n], &reach[lag..lag + n]);
        for i in 0..n {
            moves[i] += later[i] * ahead[i] - earlier[i] * back[i];
        }
    }
}

multiversion! {
    /// Adds the weighted displacement to each frame's earlier neighbour.
    fn take_reaches<T: Real>(weights: &[T], reach: &[T], moves: &mut [T]) {
        let n = moves.len();
        let (weights, reach) = (&weights[..n], &reach[..n]);
        for i in 0..n {
            moves[i] -= weights[i] * reach[i];
        }
    }
}

multiversion! {
    /// Divides sums by the sums of their weights.
    fn divide<T: Real>(sums: &mut [T], total: &[T]) {
        let n = sums.len();
        let total = &total[..n];
        for i in 0..n {
            sums[i] /= total[i];
        }
    }
}
