//! The examples of a local model, weighted and centred.

use super::dense::{Matrix, inner};
use super::{LANE, Options};
use crate::parallel::Interrupt;
use crate::simd::multiversion;
use crate::{Error, Real};

/// Squared radians that count as zero distance: the size of float32 rounding errors for a pose of a hundred
/// coordinates. It scales the weights if half of the examples have no distance; examples no farther from each other
/// count as equal.
pub(super) const LEAST_SQUARE: f64 = 1e-12;

/// Smallest relative remainder: thousands of float64 rounding errors for each of a thousand examples.
pub(super) const LEAST_LEFT: f64 = 1e-9;

/// Examples in the scale of their weights: column k is `√ω_k` times the difference from the mean.
#[derive(Debug)]
pub(super) struct Examples {
    /// The weights `ω_k`, the nearest example's being 1, and their square roots; padded.
    pub(super) weights: Vec<f64>,
    pub(super) roots: Vec<f64>,
    pub(super) total: f64,
    /// Index of the nearest example.
    pub(super) nearest: usize,
    /// One row per output.
    pub(super) outputs: Matrix,
    pub(super) output_mean: Vec<f64>,
    /// `G`: inner products of the inputs.
    pub(super) gram: Matrix,
    /// Inner products of the inputs with the query, padded; and the query's squared length.
    pub(super) query_products: Vec<f64>,
    square: f64,
    /// `λ`.
    pub(super) ridge: f64,
}

/// `(G + λ I)⁻¹`, and quantities derived from it.
#[derive(Debug)]
pub(super) struct Ridge {
    pub(super) inverse: Matrix,
    /// Its diagonal, padded.
    pub(super) diagonal: Vec<f64>,
    /// `λ + x²`, where x is the length of the query's component outside the span of the examples.
    pub(super) unseen: f64,
}

impl Examples {
    /// Weights the examples by their distance from the query, and subtracts their weighted means. The rows of
    /// `inputs` and `outputs` are coordinates; `scale` is the diagonal of W.
    pub(super) fn gather(
        mut inputs: Matrix,
        mut outputs: Matrix,
        mut query: Vec<f64>,
        scale: &[f64],
        options: &Options,
    ) -> Self {
        let (count, width) = (inputs.columns(), inputs.width());
        let mut squares = vec![0.0; width];
        add_squares(inputs.data(), &query, scale, &mut squares);
        let mut sorted = squares[..count].to_vec();
        sorted.sort_unstable_by(f64::total_cmp);
        let least = sorted[0];
        // The bandwidth defaults to the median distance.
        let spread =
            if options.bandwidth == 0.0 { sorted[count / 2] } else { options.bandwidth * options.bandwidth };
        let spread = spread.max(LEAST_SQUARE);
        let mut weights = vec![0.0; width];
        for (weight, square) in weights.iter_mut().zip(&squares[..count]) {
            *weight = Real::exp(-0.5 * (square - least) / spread);
        }
        let nearest = (0..count).fold(0, |best, k| if weights[k] > weights[best] { k } else { best });
        let roots: Vec<f64> = weights.iter().map(|weight| weight.sqrt()).collect();
        let total = inner(&weights, &vec![1.0; width]);
        let centre = Centre { weights: &weights, roots: &roots, total };
        let mut input_mean = vec![0.0; query.len()];
        let mut output_mean = vec![0.0; outputs.data().len() / width];
        about_means(inputs.data_mut(), centre, &mut input_mean);
        about_means(outputs.data_mut(), centre, &mut output_mean);
        for (x, mean) in query.iter_mut().zip(&input_mean) {
            *x -= mean;
        }
        let mut gram = inputs.gram();
        let mut query_products = vec![0.0; width];
        add_multiples(inputs.data(), &query, &mut query_products);
        let variance = gram.diagonal().iter().sum::<f64>() / count as f64;
        let equal = variance < LEAST_SQUARE;
        if equal {
            gram.data_mut().fill(0.0);
            query_products.fill(0.0);
        }
        // For equal examples any ridge gives the same result; 1 avoids rounding errors.
        let ridge = if equal { 1.0 } else { options.ridge * variance };
        let square = query.iter().map(|x| x * x).sum();
        Self { weights, roots, total, nearest, outputs, output_mean, gram, query_products, square, ridge }
    }

    /// Number of examples.
    pub(super) fn count(&self) -> usize {
        self.gram.columns()
    }

    /// Whether one example has all of the weight, so that no regression is possible.
    pub(super) fn alone(&self) -> bool {
        self.total - self.weights[self.nearest] < LEAST_LEFT * self.total
    }

    /// Solves the dual of the ridge regression for all outputs at once.
    pub(super) fn solve(&self, interrupt: &Interrupt) -> Result<Ridge, Error> {
        let mut inverse = self.gram.copy();
        inverse.add_to_diagonal(self.ridge);
        inverse.invert(interrupt)?;
        let diagonal = inverse.diagonal();
        let mut solution = vec![0.0; self.query_products.len()];
        add_multiples(inverse.data(), &self.query_products[..self.count()], &mut solution);
        let seen = inner(&self.query_products, &solution);
        let unseen = self.ridge + (self.square - seen).max(0.0);
        Ok(Ridge { inverse, diagonal, unseen })
    }
}

/// Weights, their square roots and their sum.
#[derive(Debug, Clone, Copy)]
struct Centre<'a> {
    weights: &'a [f64],
    roots: &'a [f64],
    total: f64,
}

multiversion! {
    /// Writes the scaled squared distances of the columns from a query.
    fn add_squares(rows: &[f64], query: &[f64], scale: &[f64], squares: &mut [f64]) {
        let width = squares.len();
        for left in (0..width).step_by(LANE) {
            let mut sums = [0.0; LANE];
            for (i, row) in rows.chunks_exact(width).enumerate() {
                let along = &row[left..left + LANE];
                for j in 0..LANE {
                    let difference = along[j] - query[i];
                    sums[j] += scale[i] * (difference * difference);
                }
            }
            squares[left..left + LANE].copy_from_slice(&sums);
        }
    }
}

multiversion! {
    /// Subtracts the weighted mean of each row, and multiplies by the square roots of the weights.
    fn about_means(rows: &mut [f64], centre: Centre<'_>, means: &mut [f64]) {
        let width = centre.weights.len();
        for (row, mean) in rows.chunks_exact_mut(width).zip(means) {
            *mean = inner(row, centre.weights) / centre.total;
            for (x, root) in row.iter_mut().zip(centre.roots) {
                *x = (*x - *mean) * root;
            }
        }
    }
}

multiversion! {
    /// Adds multiples of rows to `sums`.
    fn add_multiples(rows: &[f64], factors: &[f64], sums: &mut [f64]) {
        let width = sums.len();
        for (row, factor) in rows.chunks_exact(width).zip(factors) {
            for j in 0..width {
                sums[j] += *factor * row[j];
            }
        }
    }
}
