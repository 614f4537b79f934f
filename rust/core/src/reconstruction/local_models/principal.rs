//! Models on the principal components of the examples.

use super::dense::{Matrix, inner};
use super::deviations::{Fit, LEAST_DEVIATION, Residuals};
use super::eigen::{Eigen, eigen};
use super::examples::{Examples, LEAST_LEFT, LEAST_SQUARE};
use crate::Error;
use crate::parallel::Interrupt;

/// Smallest eigenvalue, relative to the largest: smaller ones are float64 rounding errors.
const LEAST_EIGENVALUE: f64 = 1e-12;

/// Eigenvalues and eigenvectors, and the number of them that explain a share of the trace.
fn components(gram: Matrix, share: f64, interrupt: &Interrupt) -> Result<(Eigen, usize), Error> {
    let found = eigen(gram, interrupt)?;
    let wanted = share * found.values.iter().sum::<f64>();
    let mut sum = 0.0;
    let enough = found.values.iter().take_while(|&&value| {
        sum += value;
        sum < wanted
    });
    let kept = (enough.count() + 1).min(found.values.len());
    let least = LEAST_EIGENVALUE * found.values.first().map_or(0.0, |value| value.max(LEAST_SQUARE));
    let positive = found.values.iter().filter(|&&value| value > least).count();
    Ok((found, kept.min(positive)))
}

/// Regression on the principal components of the inputs (Liu et al. 2011). The leave-one-out residuals keep the
/// components fixed.
pub(super) fn regression(examples: &Examples, share: f64, interrupt: &Interrupt) -> Result<Fit, Error> {
    let (found, kept) = components(examples.gram.copy(), share, interrupt)?;
    let count = examples.count();
    let mut projection = Matrix::new(count, count);
    let mut solution = vec![0.0; projection.width()];
    for (vector, value) in found.vectors.rows().zip(&found.values).take(kept) {
        let along = inner(vector, &examples.query_products) / value;
        for (x, v) in solution.iter_mut().zip(vector) {
            *x += along * v;
        }
        for (row, &factor) in projection.rows_mut().zip(vector) {
            for (x, v) in row.iter_mut().zip(vector) {
                *x += factor * v;
            }
        }
    }
    let left: Vec<f64> = (projection.diagonal().iter().zip(&examples.weights))
        .map(|(seen, weight)| 1.0 - (seen + weight / examples.total))
        .collect();
    let y = &examples.outputs;
    let mut residuals = y.less(&y.times(&projection), 1.0);
    for (row, y) in residuals.rows_mut().zip(y.rows()) {
        for (((x, left), y), weight) in row.iter_mut().zip(&left).zip(y).zip(&examples.weights) {
            // An example that determines its own prediction falls back to the mean of the others.
            let growth = (1.0 - weight / examples.total).max(LEAST_LEFT);
            *x = if *left > LEAST_LEFT { *x / left } else { y / growth };
        }
    }
    let mean = y.rows().zip(&examples.output_mean).map(|(y, mean)| mean + inner(&solution, y)).collect();
    Ok(Fit { mean, residuals: Residuals(residuals) })
}

/// Principal subspace of the examples' next poses (Chai and Hodgins 2005): the standard deviations apart from the
/// axes, the axes, `(D, r)`, and r.
pub(super) fn analysis(
    examples: &Examples,
    share: f64,
    interrupt: &Interrupt,
) -> Result<(Vec<f64>, Vec<f64>, usize), Error> {
    let (found, kept) = components(examples.outputs.gram(), share, interrupt)?;
    let root = examples.total.sqrt();
    let mut axes = Vec::with_capacity(examples.output_mean.len() * kept);
    let mut deviation = Vec::with_capacity(examples.output_mean.len());
    for y in examples.outputs.rows() {
        let from = axes.len();
        axes.extend(found.vectors.rows().take(kept).map(|vector| inner(y, vector) / root));
        let along: f64 = axes[from..].iter().map(|x| x * x).sum();
        let rest = inner(y, y) / examples.total - along;
        deviation.push(rest.max(LEAST_DEVIATION * LEAST_DEVIATION).sqrt());
    }
    Ok((deviation, axes, kept))
}
