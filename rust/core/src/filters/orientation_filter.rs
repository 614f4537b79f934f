//! Orientation filters: a linear mask becomes a filter for rotations.
//!
//! J. Lee and S. Y. Shin, "General construction of time-domain filters for orientation data". With the increments
//! `ω_i = log(q_i⁻¹ q_{i+1})` and a mask `m_{−k} … m_k` whose sum is 1:
//!
//! ```text
//! H(q_i) = q_i exp(Σ_{r=−k}^{k−1} b_r ω_{i+r})
//! b_r    = −Σ_{j=−k}^{r} m_j   (r < 0),     Σ_{j=r+1}^{k} m_j   (r ≥ 0)
//! ```

pub use super::local::Translation;
use super::local::{self, Increments, Local};
use super::samples::LANE;
use crate::clip::Planes;
use crate::parallel::Interrupt;
use crate::simd::multiversion;
use crate::window::Boundary;
use crate::{ClipMut, ClipView, Error, Real};

/// The parameters of the filter.
#[derive(Debug, Clone)]
pub struct OrientationFilter {
    /// Weights of the frames `t − k … t + k`, in any scale.
    pub mask: Vec<f64>,
    /// Number of times that the filter is applied.
    pub iterations: usize,
    /// Continuation of the clip beyond its ends, recomputed for each pass.
    pub boundary: Boundary,
}

impl OrientationFilter {
    /// Filters `clip` along time into `out`, `(frames, joints, 4)`, sign-continuous from the hemisphere of the first frame,
    /// and the translation with the same mask.
    ///
    /// No sample may be missing. Quaternions need not have length 1 exactly.
    ///
    /// # Errors
    /// [`Error::Length`] if the lengths of slices do not agree; [`Error::Parameter`] for a mask of even length or
    /// with the sum 0; [`Error::Interrupted`].
    pub fn filter<T: Real>(
        &self,
        clip: ClipView<'_, T>,
        translation: Option<Translation<'_, T>>,
        out: ClipMut<'_, T>,
        interrupt: &Interrupt,
    ) -> Result<(), Error> {
        let coefficients = self.coefficients()?.into_iter().map(T::from_f64).collect();
        let mask = Mask { coefficients };
        local::run(&mask, (self.iterations, self.boundary), clip, translation, out, interrupt)
    }

    /// Coefficients `b_{−k} … b_{k−1}` of the increments.
    fn coefficients(&self) -> Result<Vec<f64>, Error> {
        let total: f64 = self.mask.iter().sum();
        if self.mask.len().is_multiple_of(2) || !total.is_finite() || total == 0.0 {
            return Err(Error::Parameter { name: "mask", expected: "an odd length and a sum other than 0" });
        }
        let radius = self.mask.len() / 2;
        let cumulated = |weights: &mut dyn Iterator<Item = &f64>, sign: f64| -> Vec<f64> {
            let sums = weights.scan(0.0, |sum, m| {
                *sum += m / total;
                Some(*sum * sign)
            });
            sums.collect()
        };
        let before = cumulated(&mut self.mask[..radius].iter(), -1.0);
        let after = cumulated(&mut self.mask[radius + 1..].iter().rev(), 1.0);
        Ok(before.into_iter().chain(after.into_iter().rev()).collect())
    }
}

/// The mask as coefficients of increments.
struct Mask<T> {
    coefficients: Vec<T>,
}

impl<T: Real> Local<T> for Mask<T> {
    fn radius(&self) -> usize {
        self.coefficients.len() / 2
    }

    fn nanoseconds(&self) -> usize {
        20 + self.coefficients.len()
    }

    fn moves(&self, _: usize, _: usize, _: [&[T]; 4], paths: &mut [Increments<'_, T>], _: &mut Planes<T>) {
        for path in paths {
            for (steps, moves) in path.steps.into_iter().zip(&mut path.moves) {
                weighted_sums(steps, &self.coefficients, moves);
            }
        }
    }
}

multiversion! {
    /// Weighted sums of the increments around each frame, for a multiple of [`LANE`] frames.
    fn weighted_sums<T: Real>(steps: &[T], coefficients: &[T], sums: &mut [T]) {
        let (blocks, _) = sums.as_chunks_mut::<LANE>();
        for (block, sums) in blocks.iter_mut().enumerate() {
            let mut sum = [T::ZERO; LANE];
            for (r, &b) in coefficients.iter().enumerate() {
                let start = block * LANE + r;
                let steps = &steps[start..start + LANE];
                for i in 0..LANE {
                    sum[i] += b * steps[i];
                }
            }
            *sums = sum;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coefficients_gather_the_mask_from_outside() {
        let filter = |mask: &[f64]| OrientationFilter {
            mask: mask.to_vec(),
            iterations: 1,
            boundary: Boundary::Mirror,
        };
        let b = filter(&[1.0, 2.0, 3.0, 2.0, 0.0]).coefficients().expect("its sum is 8");
        assert_eq!(b, [-0.125, -0.375, 0.25, 0.0]);
        assert_eq!(filter(&[5.0]).coefficients(), Ok(vec![]));
        for bad in [&[1.0, 1.0][..], &[], &[1.0, 0.0, -1.0]] {
            assert!(filter(bad).coefficients().is_err());
        }
    }
}
