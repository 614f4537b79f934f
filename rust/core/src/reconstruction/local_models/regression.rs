//! Regression along one direction for each output (Mousas, Newbury and Anagnostopoulos 2014).
//!
//! The matrix of eqs. (5) to (8) has rank one. Its eigenvector is the direction of the weighted least squares with a
//! ridge, `u ∝ Xᵀ A y`, `A = (XXᵀ + λ I)⁻¹`; that of partial least squares is `u ∝ Xᵀ y`. Along it the coefficient is
//! fitted again (eq. 9), `γ = (Xu)ᵀy / |Xu|²`.
//!
//! Leaving out example k changes three things. The means move, so the residual of the example grows by `b = Σω / (Σω
//! − ω_k)`. Its product with `x_k` is removed from `XᵀX` and `Xᵀy`. And `u` changes by `−κ` times column k of the
//! operator that maps y to u.

use super::dense::inner;
use super::deviations::{Fit, Residuals};
use super::examples::{Examples, LEAST_LEFT, Ridge};
use crate::simd::multiversion;

/// Quantities shared by all outputs, each padded.
struct Shared {
    /// `b` of each example.
    growth: Vec<f64>,
    /// `κ` is this times the output's `change` row.
    change: Vec<f64>,
    /// The diagonals of the operator and of its square.
    diagonal: Vec<f64>,
    square: Vec<f64>,
}

/// The rows of one output.
struct Rows<'a> {
    y: &'a [f64],
    /// `Xu`.
    along: &'a [f64],
    /// The row from which `κ` is computed.
    change: &'a [f64],
}

/// Means and leave-one-out residuals of all outputs, along the directions of least squares, or of partial least squares.
pub(super) fn regression(examples: &Examples, ridge: &Ridge, least_squares: bool) -> Fit {
    let y = &examples.outputs;
    let (lambda, operator, dual) = if least_squares {
        (examples.ridge, ridge.inverse.hat(examples.ridge), y.times(&ridge.inverse))
    } else {
        (0.0, examples.gram.copy(), y.copy())
    };
    // H = G A = I − λ A. Where λ A y is small, this form of H y is more accurate.
    let along = if least_squares { y.less(&dual, lambda) } else { y.times(&operator) };
    // The operator applied twice; the residuals overwrite it.
    let mut residuals = along.times(&operator);
    let shares = examples.weights.iter().map(|weight| weight / examples.total);
    let growth: Vec<f64> = shares.clone().map(|share| 1.0 / (1.0 - share).max(LEAST_LEFT)).collect();
    let change = if least_squares {
        let left = ridge.diagonal.iter().zip(shares).map(|(inverse, share)| lambda * inverse - share);
        left.map(|left| lambda / left.max(LEAST_LEFT)).collect()
    } else {
        growth.clone()
    };
    let shared = Shared { growth, change, diagonal: operator.diagonal(), square: operator.square_diagonal() };
    let mut mean = Vec::with_capacity(examples.output_mean.len());
    let rows = y.rows().zip(along.rows()).zip(dual.rows()).zip(residuals.rows_mut());
    for ((((y, along), dual), twice), before) in rows.zip(&examples.output_mean) {
        let rows = Rows { y, along, change: dual };
        let factor = leave_one_out(&rows, &shared, twice);
        mean.push(before + factor * inner(&examples.query_products, dual));
    }
    Fit { mean, residuals: Residuals(residuals) }
}

multiversion! {
    /// `γ` of one output. `out` is the operator times `Xu` on entry, and the leave-one-out residuals on return.
    fn leave_one_out(rows: &Rows<'_>, shared: &Shared, out: &mut [f64]) -> f64 {
        let (product, square) = (inner(rows.along, rows.y), inner(rows.along, rows.along));
        let Shared { growth, change, diagonal, square: squares } = shared;
        let width = out.len();
        let (ys, alongs, changes) = (&rows.y[..width], &rows.along[..width], &rows.change[..width]);
        let (growth, change) = (&growth[..width], &change[..width]);
        let (diagonal, squares) = (&diagonal[..width], &squares[..width]);
        for (k, out) in out.iter_mut().enumerate() {
            let (y, along, growth) = (ys[k], alongs[k], growth[k]);
            let change = change[k] * changes[k];
            let here = along - change * diagonal[k];
            let product = product - change * along - growth * y * here;
            let left =
                square - 2.0 * change * *out + change * change * squares[k] - growth * (here * here);
            let left = if left > LEAST_LEFT * square { left } else { 0.0 };
            *out = growth * (y - quotient(product, left) * here);
        }
        quotient(product, square)
    }
}

/// `product / square`, and 0 where the square is 0.
#[inline(always)]
fn quotient(product: f64, square: f64) -> f64 {
    let ratio = product / if square > 0.0 { square } else { 1.0 };
    if square > 0.0 { ratio } else { 0.0 }
}
