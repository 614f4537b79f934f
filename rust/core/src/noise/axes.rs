//! Noise that differs between directions: its axes, and how large it is along each.

use super::noise::{GROUP, increments};
use crate::clip::Planes;
use crate::eigen::eigenvectors;
use crate::error::check_length;
use crate::parallel::{self, Interrupt};
use crate::{ClipView, Error, Real};

/// Signs and sizes of the increments in a difference of order 6 of the motion.
const STEPS: [f64; 6] = [-1.0, 5.0, -10.0, 10.0, -5.0, 1.0];

/// Rounds of Tyler's iteration: after them the shape changes in the third digit at most.
const ROUNDS: usize = 12;

/// Least number of differences that show a shape.
const FEWEST: usize = 12;

/// Least share of a direction in the largest: below it a joint turns about fixed axes, and the rest is rounding.
const LEAST_RATIO: f64 = 1e-3;

/// The unit matrix.
const UNIT: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// How large the noise of each joint is along its axes, in units of the level, `(joints, 3)`, and the axes as columns, `(joints, 3, 3)`.
///
/// Tyler's shape `C ∝ Σ d dᵀ / (dᵀ C⁻¹ d)` of differences of order 6 in the frame of the body; its eigenvectors, and the roots of its
/// eigenvalues, whose squares add up to 3.
///
/// # Errors
/// [`Error::Length`] if the slices do not fit; [`Error::Interrupted`].
pub fn noise_axes<T: Real>(
    q: ClipView<'_, T>,
    spread: &mut [f64],
    axes: &mut [f64],
    interrupt: &Interrupt,
) -> Result<(), Error> {
    check_length("spread", q.joints() * 3, spread.len())?;
    check_length("axes", q.joints() * 9, axes.len())?;
    let groups: Vec<_> = spread.chunks_mut(GROUP * 3).zip(axes.chunks_mut(GROUP * 9)).collect();
    parallel::for_each(groups, q.data().len() * 100, |group, (spread, axes)| {
        let joints = spread.len() / 3;
        let mut planes = Planes::new(joints * 3, q.frames().saturating_sub(1));
        increments(q, group * GROUP, joints, &mut planes);
        for (joint, (spread, axes)) in spread.chunks_mut(3).zip(axes.chunks_mut(9)).enumerate() {
            interrupt.check()?;
            spread.fill(1.0);
            axes.copy_from_slice(UNIT.as_flattened());
            let differences = differences(planes.rows_from::<3>(joint * 3));
            if differences.len() >= FEWEST {
                of_shape(shape(&differences), spread, axes, interrupt)?;
            }
        }
        Ok(())
    })
}

/// Half the differences that touch no missing sample and are not 0.
fn differences<T: Real>(steps: [&[T]; 3]) -> Vec<[f64; 3]> {
    let last = steps[0].len().saturating_sub(STEPS.len() - 1);
    let all = (0..last).map(|first| {
        steps.map(|plane| {
            STEPS.iter().zip(&plane[first..first + STEPS.len()]).map(|(c, x)| c * x.to_f64()).sum::<f64>()
        })
    });
    all.filter(|d| d.iter().all(|x| x.is_finite()) && d.iter().any(|&x| x != 0.0)).collect()
}

/// Tyler's shape of vectors with the trace 3; directions without any keep a small share.
fn shape(vectors: &[[f64; 3]]) -> [[f64; 3]; 3] {
    let mut result = UNIT;
    for _ in 0..ROUNDS {
        let inverse = inverse(result);
        let mut sum = [[0.0; 3]; 3];
        for d in vectors {
            let mut length = 0.0;
            for i in 0..3 {
                for j in 0..3 {
                    length += d[i] * inverse[i][j] * d[j];
                }
            }
            for i in 0..3 {
                for j in 0..3 {
                    sum[i][j] += d[i] * d[j] / length;
                }
            }
        }
        let scale = 3.0 / (sum[0][0] + sum[1][1] + sum[2][2]);
        result = sum.map(|row| row.map(|x| x * scale));
        for (i, row) in result.iter_mut().enumerate() {
            // Without it the shape of a joint that turns about one axis has no inverse.
            row[i] += LEAST_RATIO * LEAST_RATIO;
        }
    }
    result
}

/// The inverse of a symmetric positive matrix, by its cofactors.
fn inverse(m: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let cofactor = |i: usize, j: usize| {
        let (a, b, c, d) = ((i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3);
        m[a][c] * m[b][d] - m[a][d] * m[b][c]
    };
    let determinant = m[0][0] * cofactor(0, 0) + m[0][1] * cofactor(0, 1) + m[0][2] * cofactor(0, 2);
    std::array::from_fn(|i| std::array::from_fn(|j| cofactor(j, i) / determinant))
}

/// Writes the axes of a shape, and the deviations along them in increasing order.
fn of_shape(
    shape: [[f64; 3]; 3],
    spread: &mut [f64],
    axes: &mut [f64],
    interrupt: &Interrupt,
) -> Result<(), Error> {
    let mut matrix = shape.concat();
    let vectors = eigenvectors(&mut matrix, 3, interrupt)?;
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| matrix[a * 4].total_cmp(&matrix[b * 4]));
    let largest = matrix[order[2] * 4];
    let squares = order.map(|i| matrix[i * 4].max(LEAST_RATIO * LEAST_RATIO * largest));
    let scale = (3.0 / (squares[0] + squares[1] + squares[2])).sqrt();
    for (to, &from) in order.iter().enumerate() {
        spread[to] = squares[to].sqrt() * scale;
        for row in 0..3 {
            axes[row * 3 + to] = vectors[row * 3 + from];
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_inverse_is_one() {
        let m = [[2.0, 0.3, -0.1], [0.3, 1.0, 0.2], [-0.1, 0.2, 0.5]];
        let inverse = inverse(m);
        for (i, row) in m.iter().enumerate() {
            for (j, unit) in UNIT[i].iter().enumerate() {
                let product: f64 = (0..3).map(|k| row[k] * inverse[k][j]).sum();
                assert!((product - unit).abs() < 1e-12);
            }
        }
    }
}
