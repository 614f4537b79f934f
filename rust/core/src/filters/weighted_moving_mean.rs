//! Blender's "Smooth Keys": a weighted moving mean over five frames.
//!
//! For the values `p₂ p₁ c n₁ n₂` around a frame, the mean of `(3p₂ + 5p₁ + 2c + n₁ + n₂)/12` and `(p₂ + p₁ + 2c +
//! 5n₁ + 3n₂)/12`. The end frames are unchanged. At frames 1 and 2, `p₁` replaces `p₂`, and at the last but one `n₁`
//! replaces `n₂`: as in Blender, whose test for a second-previous key is `i − 2 > 0`.

use super::development::{Columns, Smooth};
use crate::clip::Planes;
use crate::parallel::Interrupt;
use crate::simd::multiversion;
use crate::{Error, Real};

/// The parameters of the filter.
#[derive(Debug, Clone, Copy)]
pub struct WeightedMovingMean {
    /// Number of times that the filter is applied.
    pub iterations: usize,
}

impl Smooth for WeightedMovingMean {
    fn nanoseconds(&self) -> usize {
        self.iterations.saturating_mul(5)
    }

    fn smooth(
        &self,
        _joint: usize,
        mut columns: Columns<'_>,
        spare: &mut Planes<f64>,
        interrupt: &Interrupt,
    ) -> Result<(), Error> {
        columns.pull();
        let Columns { frames, vectors, .. } = columns;
        spare.reshape(1, frames);
        let before = spare.row_mut(0);
        for vector in vectors {
            let vector = &mut vector[..frames];
            for _ in 0..self.iterations {
                interrupt.check()?;
                before.copy_from_slice(vector);
                pass(before, vector);
            }
        }
        Ok(())
    }
}

/// One pass.
fn pass(before: &[f64], out: &mut [f64]) {
    let last = before.len() - 1;
    for i in [1, 2, last.saturating_sub(1)] {
        if 0 < i && i < last {
            let p1 = before[i - 1];
            let p2 = if i > 2 { before[i - 2] } else { p1 };
            let n1 = before[i + 1];
            let n2 = if i + 2 <= last { before[i + 2] } else { n1 };
            out[i] = (2.0 * (p2 + before[i] + n2) + 3.0 * (p1 + n1)) / 12.0;
        }
    }
    if last > 4 {
        inner(before, &mut out[3..last - 1]);
    }
}

multiversion! {
    /// The frames from 3 on with two neighbours on either side.
    fn inner<T: Real>(before: &[T], out: &mut [T]) {
        let n = out.len();
        let around: [&[T]; 5] = std::array::from_fn(|j| &before[1 + j..1 + j + n]);
        let three = T::ONE + T::TWO;
        let twelve = three * (T::TWO + T::TWO);
        for i in 0..n {
            let [p2, p1, c, n1, n2] = std::array::from_fn(|j| around[j][i]);
            out[i] = (T::TWO * (p2 + c + n2) + three * (p1 + n1)) / twelve;
        }
    }
}
