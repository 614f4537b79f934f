//! The last poses, and how far examples are from them.

use super::poses::Poses;
use crate::Real;
use crate::search::poses::Probe;
use crate::simd::multiversion;

/// Sums that run side by side.
const LANES: usize = 8;

/// Relative rounding of a number in single precision.
const ROUNDING: f64 = 0.5 * f32::EPSILON as f64;

multiversion! {
    /// The squared distance of a row of single precision from one of double.
    fn square(row: &[f32], query: &[f64]) -> f64 {
        let mut sums = [0.0; LANES];
        let ((wide, rest), (row_wide, row_rest)) = (query.as_chunks::<LANES>(), row.as_chunks::<LANES>());
        for (a, b) in row_wide.iter().zip(wide) {
            for i in 0..LANES {
                let difference = f64::from(a[i]) - b[i];
                sums[i] += difference * difference;
            }
        }
        for (i, (a, b)) in row_rest.iter().zip(rest).enumerate() {
            let difference = f64::from(*a) - b;
            sums[i] += difference * difference;
        }
        ((sums[0] + sums[1]) + (sums[2] + sums[3])) + ((sums[4] + sums[5]) + (sums[6] + sums[7]))
    }
}

/// The last poses, as examples are compared with them.
#[derive(Debug)]
pub(super) struct Recent {
    /// In sequence, the oldest first.
    exact: Vec<f64>,
    pub(super) probe: Probe<f32>,
    order: usize,
    /// The same.
    pub(super) before: u32,
    /// How far rounding may have moved the probe.
    moved: f64,
    /// Relative error of squares in single precision.
    error: f64,
}

impl Recent {
    /// Poses as vectors, the oldest first.
    pub(super) fn new(features: Vec<f64>, order: usize) -> Self {
        let rounded: Vec<f32> = features.iter().map(|&x| Real::from_f64(x)).collect();
        let length = features.iter().map(|x| x * x).sum::<f64>().sqrt();
        // As many roundings as there are terms in a lane, some to add the lanes, and those of the square; and to be safe some more.
        let error = (features.len() / 16 + 16) as f64 * ROUNDING;
        Self {
            probe: Probe::new(&rounded),
            order,
            before: u32::try_from(order).unwrap_or(u32::MAX),
            moved: length * ROUNDING + f64::from(f32::MIN_POSITIVE),
            error,
            exact: features,
        }
    }

    /// How many numbers the poses have together.
    pub(super) fn numbers(&self) -> usize {
        self.exact.len()
    }

    /// The least and the greatest that a mean square can be which single precision says is `square`, summed over the poses.
    pub(super) fn bounds(&self, square: f32) -> [f64; 2] {
        let square = f64::from(square);
        let least = ((square / (1.0 + self.error)).sqrt() - self.moved).max(0.0);
        let greatest = (square / (1.0 - self.error)).sqrt() + self.moved;
        [least * least, greatest * greatest].map(|bound| bound / self.order as f64)
    }

    /// The mean square in double precision.
    pub(super) fn exact(&self, poses: &Poses<'_>, candidate: usize) -> f64 {
        let width = self.exact.len() / self.order.max(1);
        let row = &poses.features[(candidate - self.order) * width..candidate * width];
        square(row, &self.exact) / self.order as f64
    }
}
