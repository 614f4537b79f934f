//! The estimate of one patch.

use super::NEIGHBORS;
use crate::Real;
use crate::clip::Planes;
use crate::simd::multiversion;

/// Numbers of a row whose sums stay in registers while other rows go by; rows are padded to a multiple.
pub(super) const LANE: usize = 16;

/// Rows of a matrix whose sums stay in registers together.
const PAIR: usize = 2;

/// Of the covariance of the pilot's patches, how much counts.
const SHARE: f64 = 0.75;

/// Of the total variance of the patches, how much the noise has at least: some hundred roundings of float64.
const LEAST_VARIANCE: f64 = 1e-13;

/// Length of a row that holds so many numbers, and one more: the right side of the equations.
pub(super) fn width(numbers: usize) -> usize {
    (numbers + 1).next_multiple_of(LANE)
}

/// The equations `(C + I) u = y − μ`, and the memory to solve them.
#[derive(Debug)]
pub(super) struct System {
    numbers: usize,
    width: usize,
    mean: Planes<f64>,
    around: Planes<f64>,
    matrix: Planes<f64>,
    inverses: Planes<f64>,
}

impl System {
    pub(super) fn new(numbers: usize) -> Self {
        let width = width(numbers);
        Self {
            numbers,
            width,
            mean: Planes::new(1, width),
            around: Planes::new(1, NEIGHBORS * width),
            matrix: Planes::new(1, width * width),
            inverses: Planes::new(1, numbers),
        }
    }

    /// Estimates a clean patch, as its difference from the pilot's: `x − (C + I)⁻¹ (p + x − μ)`.
    ///
    /// `rows` holds patches of the pilot, of which `alike` count, and `pilot` is the one whose estimate is asked for. `rest` is
    /// `x`, and becomes the difference.
    pub(super) fn estimate(&mut self, rows: &[f64], alike: &[usize], pilot: usize, rest: &mut [f64]) {
        let (numbers, width) = (self.numbers, self.width);
        let mean = self.mean.row_mut(0);
        let around = &mut self.around.row_mut(0)[..alike.len() * width];
        let matrix = self.matrix.row_mut(0);
        let inverses = self.inverses.row_mut(0);
        centre(rows, alike, (SHARE / alike.len() as f64).sqrt(), mean, around);
        matrix.fill(0.0);
        add_products(around, width, matrix);
        let trace: f64 = (0..numbers).map(|i| matrix[i * width + i]).sum();
        let variance = 1.0 + LEAST_VARIANCE * trace;
        let pilot = &rows[pilot * width..][..numbers];
        for i in 0..numbers {
            matrix[i * width + i] += variance;
            matrix[i * width + numbers] = pilot[i] + rest[i] - mean[i];
        }
        eliminate(matrix, width, numbers, inverses);
        substitute(matrix, width, numbers, inverses);
        for (i, x) in rest.iter_mut().enumerate() {
            *x -= variance * matrix[i * width + numbers];
        }
    }
}

multiversion! {
    /// Takes the mean of some rows away from them, and scales what is left.
    fn centre<T: Real>(rows: &[T], alike: &[usize], scale: T, mean: &mut [T], around: &mut [T]) {
        let width = mean.len();
        mean.fill(T::ZERO);
        for &index in alike {
            let row = &rows[index * width..][..width];
            for i in 0..width {
                mean[i] += row[i];
            }
        }
        let count = T::from_f64(alike.len() as f64);
        for x in &mut *mean {
            *x /= count;
        }
        for (around, &index) in around.chunks_exact_mut(width).zip(alike) {
            let row = &rows[index * width..][..width];
            for i in 0..width {
                around[i] = (row[i] - mean[i]) * scale;
            }
        }
    }
}

multiversion! {
    /// Adds the products `Σ_t x_t x_tᵀ` of rows to a matrix, from its diagonal on to the right.
    pub(super) fn add_products<T: Real>(rows: &[T], width: usize, matrix: &mut [T]) {
        for top in (0..width).step_by(PAIR) {
            for left in (top / LANE * LANE..width).step_by(LANE) {
                let mut sums = [[T::ZERO; LANE]; PAIR];
                for row in rows.chunks_exact(width) {
                    let down: [T; PAIR] = std::array::from_fn(|i| row[top + i]);
                    let along = &row[left..left + LANE];
                    for j in 0..LANE {
                        for i in 0..PAIR {
                            sums[i][j] += down[i] * along[j];
                        }
                    }
                }
                for i in 0..PAIR {
                    let to = &mut matrix[(top + i) * width + left..][..LANE];
                    for j in 0..LANE {
                        to[j] += sums[i][j];
                    }
                }
            }
        }
    }
}

multiversion! {
    /// Gaussian elimination of a symmetric positive matrix, from its upper triangle and with the right side in column `n`: what
    /// is left is Cholesky's factor, its rows scaled by the pivots. The inverse pivots go to `inverses`.
    fn eliminate<T: Real>(matrix: &mut [T], width: usize, n: usize, inverses: &mut [T]) {
        for i in 0..n {
            let (above, row) = matrix.split_at_mut(i * width);
            for left in (i / LANE * LANE..width).step_by(LANE) {
                let mut sums = [T::ZERO; LANE];
                for (pivot, inverse) in above.chunks_exact(width).zip(&inverses[..i]) {
                    let factor = pivot[i] * *inverse;
                    let along = &pivot[left..left + LANE];
                    for j in 0..LANE {
                        sums[j] += factor * along[j];
                    }
                }
                let row = &mut row[left..left + LANE];
                for j in 0..LANE {
                    row[j] -= sums[j];
                }
            }
            inverses[i] = T::ONE / row[i];
        }
    }
}

/// Solves the eliminated equations, from the last on; the solution takes the place of the right side.
fn substitute(matrix: &mut [f64], width: usize, n: usize, inverses: &[f64]) {
    for j in (0..n).rev() {
        let x = matrix[j * width + n] * inverses[j];
        matrix[j * width + n] = x;
        for row in matrix[..j * width].chunks_exact_mut(width) {
            row[n] -= row[j] * x;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_estimate_solves_its_equations() {
        let numbers = 30;
        let width = width(numbers);
        let count = 90;
        let number =
            |i: usize, j: usize| if j < numbers { ((i * 37 + j * j * 11) % 97) as f64 / 9.0 } else { 0.0 };
        let rows: Vec<f64> = (0..count * width).map(|at| number(at / width, at % width)).collect();
        let alike: Vec<usize> = (5..85).collect();
        let noisy: Vec<f64> = (0..numbers).map(|i| (i % 5) as f64 - 2.0).collect();
        let mut moved = noisy.clone();
        System::new(numbers).estimate(&rows, &alike, 40, &mut moved);
        let mean = |j: usize| alike.iter().map(|&i| number(i, j)).sum::<f64>() / 80.0;
        let covariance = |a: usize, b: usize| {
            let products = alike.iter().map(|&i| (number(i, a) - mean(a)) * (number(i, b) - mean(b)));
            0.75 * products.sum::<f64>() / 80.0
        };
        // (C + I)(x − (f − p)) = p + x − μ
        for a in 0..numbers {
            let left: f64 = (0..numbers)
                .map(|b| (covariance(a, b) + f64::from(u8::from(a == b))) * (noisy[b] - moved[b]))
                .sum();
            assert!((left - (number(40, a) + noisy[a] - mean(a))).abs() < 1e-8);
        }
    }

    #[test]
    fn without_digits_left_for_the_noise_estimates_stay_near() {
        let numbers = 30;
        let width = width(numbers);
        let rows: Vec<f64> = (0..80 * width)
            .map(|at| if at % width < numbers { (at / width) as f64 * 1e12 } else { 0.0 })
            .collect();
        let alike: Vec<usize> = (0..80).collect();
        let mut moved = vec![0.25; numbers];
        System::new(numbers).estimate(&rows, &alike, 40, &mut moved);
        assert!(moved.iter().all(|x| x.abs() < 2.0));
    }
}
