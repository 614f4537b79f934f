//! Columns of values along time, filtered with a mask.

use crate::clip::Planes;
use crate::parallel::Interrupt;
use crate::simd::multiversion;
use crate::window::{Boundary, extended_number};
use crate::{Error, Real};

/// Frames whose sums stay in registers over all lags; padded columns are multiples of it.
pub(crate) const BLOCK: usize = 32;

/// Frames between two checks of the interrupt flag.
const PIECE: usize = 256 * BLOCK;

/// Standard deviations at which a Gaussian mask is truncated.
const REACH: f64 = 4.0;

/// A symmetric mask of `2·radius + 1` weights.
#[derive(Debug, Clone)]
pub(crate) struct Mask {
    /// Weights of the frame itself and of the later frames.
    later: Vec<f64>,
}

impl Mask {
    /// Gaussian weights of standard deviation `sigma` frames, truncated at four standard deviations, with the sum 1.
    pub(crate) fn gaussian(sigma: f64) -> Self {
        let radius = (REACH * sigma + 0.5).to_count();
        let weight = |lag: usize| {
            let scaled = lag as f64 / sigma;
            Real::exp(-0.5 * (scaled * scaled))
        };
        let mut later: Vec<f64> = (0..=radius).map(weight).collect();
        let total = 1.0 + 2.0 * later[1..].iter().sum::<f64>();
        for weight in &mut later {
            *weight /= total;
        }
        Self { later }
    }

    /// Radius in frames.
    pub(super) fn radius(&self) -> usize {
        self.later.len().saturating_sub(1)
    }

    /// Writes the sums `Σ_j m_j x_{t+j}` of a column that extends `radius` frames past both ends of `out`, whose
    /// length is a multiple of [`BLOCK`].
    pub(super) fn apply(&self, around: &[f64], out: &mut [f64], interrupt: &Interrupt) -> Result<(), Error> {
        for (piece, out) in out.chunks_mut(PIECE).enumerate() {
            interrupt.check()?;
            let around = &around[piece * PIECE..][..out.len() + 2 * self.radius()];
            sums(around, &self.later, out);
        }
        Ok(())
    }

    /// Weighted means of columns of `frames` values, padded to a multiple of [`BLOCK`], in place; the sum of the mask
    /// is 1.
    ///
    /// With the confidence `c` of the frames, `Σ_j m_j c_{t+j} x_{t+j} / Σ_j m_j c_{t+j}`. Where all confidences
    /// under the mask are 0, the value is unchanged.
    pub(crate) fn means(
        &self,
        columns: &mut [&mut [f64]],
        trust: Option<&[f64]>,
        (frames, boundary): (usize, Boundary),
        spare: &mut Planes<f64>,
        interrupt: &Interrupt,
    ) -> Result<(), Error> {
        let padded = frames.next_multiple_of(BLOCK);
        spare.reshape(4, padded + 2 * self.radius());
        let [around, weights, total, before] = spare.rows_mut::<4>(0);
        let (total, before) = (&mut total[..padded], &mut before[..padded]);
        if let Some(trust) = trust {
            extend(&trust[..frames], self.radius(), boundary, false, weights);
            self.apply(weights, total, interrupt)?;
        }
        for column in columns {
            extend(&column[..frames], self.radius(), boundary, true, around);
            if trust.is_some() {
                before.copy_from_slice(column);
                multiply(around, weights);
            }
            self.apply(around, column, interrupt)?;
            if trust.is_some() {
                divide(column, total, before);
            }
        }
        Ok(())
    }
}

/// Writes the sums `Σ_j m_j x_{t+j}` of a column that extends half the length of an odd mask past both ends of `out`,
/// whose length is a multiple of [`BLOCK`].
pub(super) fn slide(
    mask: &[f64],
    around: &[f64],
    out: &mut [f64],
    interrupt: &Interrupt,
) -> Result<(), Error> {
    for (piece, out) in out.chunks_mut(PIECE).enumerate() {
        interrupt.check()?;
        sums_of_any(&around[piece * PIECE..][..out.len() + mask.len() - 1], mask, out);
    }
    Ok(())
}

/// Writes a column with `radius` more values before and after it, followed by zeros up to the length of `out`.
pub(super) fn extend(column: &[f64], radius: usize, boundary: Boundary, slope: bool, out: &mut [f64]) {
    let end = radius + column.len();
    out[radius..end].copy_from_slice(column);
    let beyond = |index: usize| {
        extended_number(column, 1, 0, index.cast_signed() - radius.cast_signed(), boundary, slope)
    };
    for (i, value) in out[..radius].iter_mut().enumerate() {
        *value = beyond(i);
    }
    for (i, value) in out[end..end + radius].iter_mut().enumerate() {
        *value = beyond(end + i);
    }
    out[end + radius..].fill(0.0);
}

multiversion! {
    /// Sums under a symmetric mask, for blocks of frames.
    fn sums<T: Real>(around: &[T], later: &[T], out: &mut [T]) {
        let radius = later.len() - 1;
        for (block, out) in out.chunks_exact_mut(BLOCK).enumerate() {
            let at = block * BLOCK + radius;
            let mut totals = [T::ZERO; BLOCK];
            let here = &around[at..at + BLOCK];
            for i in 0..BLOCK {
                totals[i] = later[0] * here[i];
            }
            for lag in 1..=radius {
                let (before, after) = (&around[at - lag..][..BLOCK], &around[at + lag..][..BLOCK]);
                for i in 0..BLOCK {
                    totals[i] += later[lag] * (after[i] + before[i]);
                }
            }
            out.copy_from_slice(&totals);
        }
    }
}

multiversion! {
    /// Sums under a mask of any weights, for blocks of frames.
    fn sums_of_any<T: Real>(around: &[T], mask: &[T], out: &mut [T]) {
        for (block, out) in out.chunks_exact_mut(BLOCK).enumerate() {
            let mut totals = [T::ZERO; BLOCK];
            for (lag, &weight) in mask.iter().enumerate() {
                let here = &around[block * BLOCK + lag..][..BLOCK];
                for i in 0..BLOCK {
                    totals[i] += weight * here[i];
                }
            }
            out.copy_from_slice(&totals);
        }
    }
}

multiversion! {
    fn multiply<T: Real>(values: &mut [T], weights: &[T]) {
        for (value, weight) in values.iter_mut().zip(weights) {
            *value *= *weight;
        }
    }
}

multiversion! {
    /// Divides sums by the sums of their weights; where those are 0 the previous value is kept.
    fn divide<T: Real>(sums: &mut [T], total: &[T], before: &[T]) {
        let n = sums.len();
        let (total, before) = (&total[..n], &before[..n]);
        for i in 0..n {
            let quotient = sums[i] / total[i];
            sums[i] = if total[i] > T::ZERO { quotient } else { before[i] };
        }
    }
}
