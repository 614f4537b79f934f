//! Products of matrices of some hundred rows.

use crate::Real;
use crate::simd::multiversion;

/// Numbers of a row whose sums stay in registers; rows of the right factor and of the result are padded to a multiple.
pub(super) const LANE: usize = 16;

/// Rows whose sums stay in registers together.
const PAIR: usize = 2;

/// Rows and columns of a block of a symmetric matrix whose sums stay in registers.
const TOP: usize = 4;
const SIDE: usize = 8;

/// Length of a row that holds so many numbers.
pub(super) fn padded(numbers: usize) -> usize {
    numbers.next_multiple_of(LANE)
}

/// The product of a matrix, whose rows are `stride` apart and hold `inner` numbers, with `inner` rows of `width` numbers.
pub(super) fn product(left: &[f64], stride: usize, right: &[f64], width: usize, out: &mut [f64]) {
    let inner = right.len() / width;
    let rows = out.len() / width;
    let paired = rows - rows % PAIR;
    let (most, rest) = out.split_at_mut(paired * width);
    rows_of_product::<_, PAIR>(left, [stride, inner, width], right, most);
    rows_of_product::<_, 1>(&left[paired * stride..], [stride, inner, width], right, rest);
}

/// The first `columns` columns of `rows`, as rows of `width` numbers; what is beyond is 0.
pub(super) fn transposed(rows: &[f64], stride: usize, columns: usize, width: usize) -> Vec<f64> {
    let mut out = vec![0.0; columns * width];
    for (i, row) in rows.chunks_exact(stride).enumerate() {
        for (j, &x) in row[..columns].iter().enumerate() {
            out[j * width + i] = x;
        }
    }
    out
}

multiversion! {
    /// Adds the products `Σ_t x_t x_tᵀ` of rows to a matrix, whose rows are `stride` apart, from the blocks on its diagonal on to the
    /// right.
    pub(super) fn add_products<T: Real>(rows: &[T], width: usize, matrix: &mut [T], stride: usize) {
        for top in (0..width).step_by(TOP) {
            for left in (top / SIDE * SIDE..width).step_by(SIDE) {
                let mut sums = [[T::ZERO; SIDE]; TOP];
                for row in rows.chunks_exact(width) {
                    let down: [T; TOP] = std::array::from_fn(|i| row[top + i]);
                    let along = &row[left..left + SIDE];
                    for j in 0..SIDE {
                        for i in 0..TOP {
                            sums[i][j] += down[i] * along[j];
                        }
                    }
                }
                for i in 0..TOP {
                    let to = &mut matrix[(top + i) * stride + left..][..SIDE];
                    for j in 0..SIDE {
                        to[j] += sums[i][j];
                    }
                }
            }
        }
    }
}

multiversion! {
    fn rows_of_product<T: Real, const ROWS: usize>(
        left: &[T], sizes: [usize; 3], right: &[T], out: &mut [T],
    ) {
        let [stride, inner, width] = sizes;
        for (pair, out) in out.chunks_exact_mut(ROWS * width).enumerate() {
            let left: [&[T]; ROWS] =
                std::array::from_fn(|i| &left[(pair * ROWS + i) * stride..][..inner]);
            for lane in (0..width).step_by(LANE) {
                let mut sums = [[T::ZERO; LANE]; ROWS];
                for (t, right) in right.chunks_exact(width).enumerate() {
                    let right = &right[lane..lane + LANE];
                    for i in 0..ROWS {
                        let factor = left[i][t];
                        for j in 0..LANE {
                            sums[i][j] += factor * right[j];
                        }
                    }
                }
                for i in 0..ROWS {
                    out[i * width + lane..][..LANE].copy_from_slice(&sums[i]);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_are_sums_of_products() {
        let (rows, inner, columns) = (5, 7, 20);
        let (stride, width) = (9, padded(columns));
        let left: Vec<f64> = (0..rows * stride).map(|i| (i * i % 11) as f64).collect();
        let right: Vec<f64> =
            (0..inner * width).map(|i| if i % width < columns { (i * 7 % 13) as f64 } else { 0.0 }).collect();
        let mut out = vec![f64::NAN; rows * width];
        product(&left, stride, &right, width, &mut out);
        let turned = transposed(&right, width, columns, inner);
        for i in 0..rows {
            for j in 0..width {
                let sum: f64 = (0..inner).map(|t| left[i * stride + t] * right[t * width + j]).sum();
                assert!((out[i * width + j] - sum).abs() < 1e-9);
                if j < columns {
                    let other: f64 = (0..inner).map(|t| left[i * stride + t] * turned[j * inner + t]).sum();
                    assert!((other - sum).abs() < 1e-9);
                }
            }
        }
    }
}
