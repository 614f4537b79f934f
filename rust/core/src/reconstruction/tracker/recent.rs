//! The last poses, and the distances of examples from them.

use super::poses::Poses;
use crate::Real;
use crate::search::poses::Probe;
use crate::simd::multiversion;

/// Number of running sums.
const LANES: usize = 8;

/// Relative rounding error in single precision.
const ROUNDING: f64 = 0.5 * f32::EPSILON as f64;

multiversion! {
    /// The squared distance between a float32 row and a float64 row.
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

/// Feature vectors of the last poses.
#[derive(Debug)]
pub(super) struct Recent {
    /// In double precision, the oldest first.
    exact: Vec<f64>,
    pub(super) probe: Probe<f32>,
    order: usize,
    /// The order as `u32`.
    pub(super) before: u32,
    /// Largest distance between the rounded and the exact features.
    moved: f64,
    /// Relative error of squared distances in single precision.
    error: f64,
}

impl Recent {
    /// Feature vectors of the last poses, the oldest first.
    pub(super) fn new(features: Vec<f64>, order: usize) -> Self {
        let rounded: Vec<f32> = features.iter().map(|&x| Real::from_f64(x)).collect();
        let length = features.iter().map(|x| x * x).sum::<f64>().sqrt();
        // Roundings: one per term of a lane, some for adding the lanes, those of the square, and a margin.
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

    /// Number of values of all poses together.
    pub(super) fn numbers(&self) -> usize {
        self.exact.len()
    }

    /// Lower and upper bound of the exact mean square of the poses, given the sum `square` in single precision.
    pub(super) fn bounds(&self, square: f32) -> [f64; 2] {
        let square = f64::from(square);
        let least = ((square / (1.0 + self.error)).sqrt() - self.moved).max(0.0);
        let greatest = (square / (1.0 - self.error)).sqrt() + self.moved;
        [least * least, greatest * greatest].map(|bound| bound / self.order as f64)
    }

    /// The mean square over the poses in double precision.
    pub(super) fn exact(&self, poses: &Poses<'_>, candidate: usize) -> f64 {
        let width = self.exact.len() / self.order.max(1);
        let row = &poses.features[(candidate - self.order) * width..candidate * width];
        square(row, &self.exact) / self.order as f64
    }
}
