//! Standard deviations of the predictions.

use super::Deviation;
use super::dense::{Matrix, inner};
use super::examples::{Examples, Ridge};

/// Smallest standard deviation of a prediction, in radians and in units of the root's coordinates. A tenth of a
/// degree is the accuracy of optical motion capture.
pub const LEAST_DEVIATION: f64 = 0.002;

/// Standard deviation of a prediction from a single example, in radians and in units of the root's coordinates. Poses
/// of one person differ from the most similar poses of another by 10° to 12°.
pub const UNKNOWN_DEVIATION: f64 = 0.2;

/// Largest ratio of a prediction's deviation far from all examples to the deviation of the examples from each other.
const MOST_GROWTH: f64 = 100.0;

/// `√ω_k (y_k − ŷ_k)`, one row per output.
#[derive(Debug)]
pub(super) struct Residuals(pub(super) Matrix);

/// Predictions at the query, and leave-one-out residuals of the examples.
#[derive(Debug)]
pub(super) struct Fit {
    pub(super) mean: Vec<f64>,
    pub(super) residuals: Residuals,
}

impl Residuals {
    /// `√(Σ r² / Σ ω)` of each output.
    pub(super) fn left_out(&self, examples: &Examples) -> Vec<f64> {
        self.0.rows().map(|row| (inner(row, row) / examples.total).sqrt()).collect()
    }

    /// Standard deviation of the prediction at the query.
    ///
    /// A ridge regression is the mean of a Gaussian process with a linear covariance and noise of variance `s λ`.
    /// Given the other examples, example k has the variance `s / A_kk`. The query has the variance `s (λ + x²)`,
    /// where x is the length of the query's component outside the span of the examples. The scale `s` of each output
    /// fits the first to the residuals: `s = Σ r² A_kk / Σ ω`.
    fn predictive(&self, examples: &Examples, ridge: &Ridge) -> Vec<f64> {
        let mut scaled = vec![0.0; ridge.diagonal.len()];
        let rows = self.0.rows().zip(self.left_out(examples));
        rows.map(|(row, left_out)| {
            for (scaled, (r, inverse)) in scaled.iter_mut().zip(row.iter().zip(&ridge.diagonal)) {
                *scaled = r * inverse;
            }
            let scale = inner(row, &scaled) / examples.total;
            (scale * ridge.unseen).sqrt().min(MOST_GROWTH * left_out)
        })
        .collect()
    }
}

impl Fit {
    /// Means and standard deviations.
    pub(super) fn finish(self, kind: Deviation, examples: &Examples, ridge: &Ridge) -> (Vec<f64>, Vec<f64>) {
        let deviation = match kind {
            Deviation::LeaveOneOut => self.residuals.left_out(examples),
            Deviation::Predictive => self.residuals.predictive(examples, ridge),
        };
        (self.mean, deviation)
    }
}
