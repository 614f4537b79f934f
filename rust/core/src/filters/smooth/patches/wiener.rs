//! Patches that are alike as drawn from one normal distribution, and the estimates of noisy ones.

use super::super::products::{LANE, add_products, padded};
use super::{APART, NEAR, NEIGHBORS};
use crate::Real;
use crate::clip::Planes;
use crate::simd::multiversion;

/// Patches that are estimated together, at most: so many vectors of equations that are solved side by side.
pub(super) const LANES: usize = (2 * NEAR / APART + 1).next_multiple_of(LANE);

/// Rows that are eliminated together; a patch has an even number of numbers.
const PAIR: usize = 2;

/// Of the covariance of the pilot's patches, how much counts.
const SHARE: f64 = 0.75;

/// Of the total variance of the patches, how much the noise has at least: some hundred roundings of float64.
const LEAST_VARIANCE: f64 = 1e-13;

/// Length of a row that holds so many numbers.
pub(super) fn width(numbers: usize) -> usize {
    padded(numbers)
}

/// Mean and covariance of patches: the equations `(C + I) u = y − μ`, and the memory to solve them.
#[derive(Debug)]
pub(super) struct Model {
    numbers: usize,
    mean: Planes<f64>,
    around: Planes<f64>,
    /// `C + I` and the right sides, a row for each number.
    matrix: Planes<f64>,
    /// How much the noise has of each number.
    variance: f64,
    inverses: Vec<f64>,
    moves: Vec<[f64; LANES]>,
}

impl Model {
    pub(super) fn new(numbers: usize) -> Self {
        let width = width(numbers);
        Self {
            numbers,
            mean: Planes::new(1, width),
            around: Planes::new(1, NEIGHBORS * width),
            matrix: Planes::new(1, width * (width + LANES)),
            variance: 1.0,
            inverses: vec![0.0; numbers],
            moves: vec![[0.0; LANES]; numbers],
        }
    }

    /// Takes mean and covariance of the patches of the pilot that count, rows of numbers.
    pub(super) fn learn(&mut self, rows: &[f64], alike: &[usize]) {
        let mean = self.mean.row_mut(0);
        let stride = mean.len() + LANES;
        let around = &mut self.around.row_mut(0)[..alike.len() * mean.len()];
        let matrix = self.matrix.row_mut(0);
        centre(rows, alike, (SHARE / alike.len() as f64).sqrt(), mean, around);
        matrix.fill(0.0);
        add_products(around, mean.len(), matrix, stride);
        let trace: f64 = (0..self.numbers).map(|i| matrix[i * stride + i]).sum();
        self.variance = 1.0 + LEAST_VARIANCE * trace;
        for i in 0..self.numbers {
            matrix[i * stride + i] += self.variance;
        }
    }

    /// Estimates clean patches, as differences from the pilot's: `x − (C + I)⁻¹ (p + x − μ)`, times a number for each.
    ///
    /// They begin [`APART`] frames after each other; of the first one, the numbers are at `p` in the planes of the pilot's patches, and
    /// at `x` in those of the rest.
    pub(super) fn estimate(
        &mut self,
        (pilot, p): (&Planes<f64>, usize),
        (rest, x): (&Planes<f64>, usize),
        times: &[f64; LANES],
    ) -> &[[f64; LANES]] {
        let mean = self.mean.row(0);
        let stride = mean.len() + LANES;
        let matrix = self.matrix.row_mut(0);
        for (number, row) in matrix.chunks_exact_mut(stride).take(self.numbers).enumerate() {
            let pilot = pilot.row(number)[p..].iter().step_by(APART);
            let rest = rest.row(number)[x..].iter().step_by(APART);
            for (right, (pilot, rest)) in row[mean.len()..].iter_mut().zip(pilot.zip(rest)) {
                *right = pilot + rest - mean[number];
            }
        }
        eliminate(matrix, stride, self.numbers, &mut self.inverses);
        substitute(matrix, stride, self.numbers, &self.inverses);
        for ((number, row), moves) in matrix.chunks_exact(stride).enumerate().zip(&mut self.moves) {
            let rest = rest.row(number)[x..].iter().step_by(APART);
            let sources = rest.zip(&row[mean.len()..]).zip(times);
            for (to, ((rest, solution), times)) in moves.iter_mut().zip(sources) {
                *to = (rest - self.variance * solution) * times;
            }
        }
        &self.moves
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
    /// Gaussian elimination of a symmetric positive matrix, from its upper triangle and with right sides in the columns beyond it: what
    /// is left is Cholesky's factor, its rows scaled by the pivots. The inverse pivots go to `inverses`.
    fn eliminate<T: Real>(matrix: &mut [T], width: usize, n: usize, inverses: &mut [T]) {
        for top in (0..n).step_by(PAIR) {
            let (above, rows) = matrix.split_at_mut(top * width);
            for left in (top / LANE * LANE..width).step_by(LANE) {
                let mut sums = [[T::ZERO; LANE]; PAIR];
                for (pivot, inverse) in above.chunks_exact(width).zip(&inverses[..top]) {
                    let along = &pivot[left..left + LANE];
                    for i in 0..PAIR {
                        let factor = pivot[top + i] * *inverse;
                        for j in 0..LANE {
                            sums[i][j] += factor * along[j];
                        }
                    }
                }
                for i in 0..PAIR {
                    let row = &mut rows[i * width + left..][..LANE];
                    for j in 0..LANE {
                        row[j] -= sums[i][j];
                    }
                }
            }
            for i in 0..PAIR {
                let (pivots, row) = rows.split_at_mut(i * width);
                let row = &mut row[..width];
                for (pivot, inverse) in pivots.chunks_exact(width).zip(&inverses[top..]) {
                    let factor = pivot[top + i] * *inverse;
                    for j in top..width {
                        row[j] -= factor * pivot[j];
                    }
                }
                inverses[top + i] = T::ONE / row[top + i];
            }
        }
    }
}

multiversion! {
    /// Solves the eliminated equations, from the last on; the solutions take the place of the right sides.
    fn substitute<T: Real>(matrix: &mut [T], width: usize, n: usize, inverses: &[T]) {
        let first = width - LANES;
        for i in (0..n).rev() {
            let (above, below) = matrix.split_at_mut((i + 1) * width);
            let row = &mut above[i * width..];
            for lane in (first..width).step_by(LANE) {
                let mut sums = [T::ZERO; LANE];
                for (factor, solved) in row[i + 1..n].iter().zip(below.chunks_exact(width)) {
                    let along = &solved[lane..lane + LANE];
                    for j in 0..LANE {
                        sums[j] += *factor * along[j];
                    }
                }
                let right = &mut row[lane..lane + LANE];
                for j in 0..LANE {
                    right[j] = (right[j] - sums[j]) * inverses[i];
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Planes of numbers that are given by number and patch.
    fn planes(numbers: usize, patches: usize, number: impl Fn(usize, usize) -> f64) -> Planes<f64> {
        let mut planes = Planes::new(numbers, patches + APART * LANES);
        for i in 0..numbers {
            for (patch, x) in planes.row_mut(i)[..patches].iter_mut().enumerate() {
                *x = number(patch, i);
            }
        }
        planes
    }

    fn rows(numbers: usize, patches: usize, number: impl Fn(usize, usize) -> f64) -> Vec<f64> {
        let width = width(numbers);
        (0..patches * width)
            .map(|at| if at % width < numbers { number(at / width, at % width) } else { 0.0 })
            .collect()
    }

    #[test]
    fn estimates_solve_their_equations() {
        let numbers = 24;
        let pilot = |patch: usize, i: usize| ((patch * 37 + i * i * 11) % 97) as f64 / 9.0;
        let rest = |patch: usize, i: usize| ((patch * 5 + i) % 7) as f64 - 3.0;
        let alike: Vec<usize> = (5..85).collect();
        let mut model = Model::new(numbers);
        model.learn(&rows(numbers, 90, pilot), &alike);
        let mut times = [1.0; LANES];
        times[2] = 0.0;
        let moves =
            model.estimate((&planes(numbers, 90, pilot), 40), (&planes(numbers, 60, rest), 10), &times);
        let mean = |i: usize| alike.iter().map(|&patch| pilot(patch, i)).sum::<f64>() / 80.0;
        let covariance = |a: usize, b: usize| {
            let products =
                alike.iter().map(|&patch| (pilot(patch, a) - mean(a)) * (pilot(patch, b) - mean(b)));
            0.75 * products.sum::<f64>() / 80.0
        };
        // (C + I)(x − (f − p)) = p + x − μ
        for lane in [0, 1, 2 * NEAR / APART] {
            let (p, x) = (40 + lane * APART, 10 + lane * APART);
            for a in 0..numbers {
                let left: f64 = (0..numbers)
                    .map(|b| {
                        let noise = rest(x, b) - moves[b][lane];
                        (covariance(a, b) + f64::from(u8::from(a == b))) * noise
                    })
                    .sum();
                assert!((left - (pilot(p, a) + rest(x, a) - mean(a))).abs() < 1e-8);
            }
        }
        assert!(moves.iter().all(|moves| moves[2] == 0.0));
    }

    #[test]
    fn without_digits_left_for_the_noise_estimates_stay_near() {
        let numbers = 24;
        let pilot = |patch: usize, _: usize| patch as f64 * 1e12;
        let alike: Vec<usize> = (0..80).collect();
        let mut model = Model::new(numbers);
        model.learn(&rows(numbers, 80, pilot), &alike);
        let rest = planes(numbers, 80, |_, _| 0.25);
        let moves = model.estimate((&planes(numbers, 80, pilot), 40), (&rest, 40), &[1.0; LANES]);
        assert!(moves.iter().all(|moves| moves[0].abs() < 2.0));
    }
}
