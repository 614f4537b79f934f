//! How far the truth may lie from a prediction.

use super::Deviation;
use super::dense::{Matrix, inner};
use super::examples::{Examples, Ridge};

/// Radians, and units of the root's numbers: no prediction is trusted further. A tenth of a degree is what optical motion capture
/// measures.
pub const LEAST_DEVIATION: f64 = 0.002;

/// Radians, and units of the root's numbers: what one example alone can tell of deviations. People differ from the most similar
/// pose of another by 10 to 12 degrees.
pub const UNKNOWN_DEVIATION: f64 = 0.2;

/// How much more a prediction far from all examples may deviate than those of the examples from each other.
const MOST_GROWTH: f64 = 100.0;

/// `√ω_k (y_k − ŷ_k)`, a row for each output.
#[derive(Debug)]
pub(super) struct Residuals(pub(super) Matrix);

/// Predictions, and the residuals of the examples where each is left out.
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

    /// Deviation at the query.
    ///
    /// A ridge regression is the mean of a Gaussian process with a linear covariance and noise of variance `s λ`. Observation from the
    /// others, example k has the variance `s / A_kk`, and the query `s (λ + x²)`, where x is what the examples do not show of
    /// it. The scale `s` of each output is what makes the first fit the residuals: `s = Σ r² A_kk / Σ ω`.
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
    /// Means and deviations.
    pub(super) fn finish(self, kind: Deviation, examples: &Examples, ridge: &Ridge) -> (Vec<f64>, Vec<f64>) {
        let deviation = match kind {
            Deviation::LeaveOneOut => self.residuals.left_out(examples),
            Deviation::Predictive => self.residuals.predictive(examples, ridge),
        };
        (self.mean, deviation)
    }
}
