//! Directions of largest variance of the poses.

use super::Segments;
use crate::Real;

/// Number of poses from which the directions are computed.
const SAMPLE: usize = 512;

/// Rounds of orthogonal iteration: the directions must be orthonormal, but need not be exact.
const ROUNDS: usize = 6;

/// Up to `width` orthonormal directions, `(width, dims)`, that hold most of the variance of the poses; zeros where
/// there are fewer.
pub(crate) fn directions<T: Real>(segments: &Segments<'_, T>, width: usize) -> Vec<f64> {
    let dims = segments.dims();
    let covariance = covariance(segments);
    let mut order: Vec<usize> = (0..dims).collect();
    order.sort_by(|&a, &b| covariance[b * dims + b].total_cmp(&covariance[a * dims + a]));
    let mut basis = vec![0.0; width * dims];
    for (vector, &axis) in basis.chunks_exact_mut(dims).zip(&order) {
        vector[axis] = 1.0;
    }
    for _ in 0..ROUNDS {
        let mut grown = vec![0.0; width * dims];
        for (grown, vector) in grown.chunks_exact_mut(dims).zip(basis.chunks_exact(dims)) {
            for (x, row) in vector.iter().zip(covariance.chunks_exact(dims)) {
                for (sum, c) in grown.iter_mut().zip(row) {
                    *sum += x * c;
                }
            }
        }
        orthonormalise(&mut grown, dims);
        basis = grown;
    }
    basis
}

/// The covariance of a sample of the poses, `(dims, dims)`.
fn covariance<T: Real>(segments: &Segments<'_, T>) -> Vec<f64> {
    let dims = segments.dims();
    let stride = segments.poses().div_ceil(SAMPLE).max(1);
    let rows = segments.features().chunks_exact(dims).step_by(stride);
    let sample: Vec<Vec<f64>> = rows
        .filter(|row| row.iter().all(|x| x.is_finite()))
        .map(|row| row.iter().map(|x| x.to_f64()).collect())
        .collect();
    let share = 1.0 / sample.len().max(1) as f64;
    let mut mean = vec![0.0; dims];
    for row in &sample {
        for (mean, x) in mean.iter_mut().zip(row) {
            *mean += x * share;
        }
    }
    let mut covariance = vec![0.0; dims * dims];
    for row in &sample {
        for (i, sums) in covariance.chunks_exact_mut(dims).enumerate() {
            let x = (row[i] - mean[i]) * share;
            for ((sum, y), mean) in sums[i..].iter_mut().zip(&row[i..]).zip(&mean[i..]) {
                *sum += x * (y - mean);
            }
        }
    }
    for i in 0..dims {
        for j in 0..i {
            covariance[i * dims + j] = covariance[j * dims + i];
        }
    }
    covariance
}

/// Gram–Schmidt: makes vectors orthonormal; linearly dependent ones become 0.
fn orthonormalise(vectors: &mut [f64], dims: usize) {
    for i in 0..vectors.len() / dims {
        let (done, rest) = vectors.split_at_mut(i * dims);
        let vector = &mut rest[..dims];
        let length = norm(vector);
        // Two passes: the second removes the rounding errors of the first.
        for _ in 0..2 {
            for other in done.chunks_exact(dims) {
                let along: f64 = vector.iter().zip(other).map(|(x, y)| x * y).sum();
                for (x, y) in vector.iter_mut().zip(other) {
                    *x -= along * y;
                }
            }
        }
        let left = norm(vector);
        let scale = if left > 1e-9 * length && left.is_finite() { 1.0 / left } else { 0.0 };
        for x in vector {
            *x *= scale;
        }
    }
}

fn norm(vector: &[f64]) -> f64 {
    vector.iter().map(|x| x * x).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_are_at_right_angles_and_hold_the_variance() {
        let dims = 20;
        let features: Vec<f64> = (0..200 * dims)
            .map(|i| {
                let (pose, dim) = ((i / dims) as f64, (i % dims) as f64);
                Real::sin_cos((pose * (1.0 + dim)) % 100.0).0 / (1.0 + dim)
            })
            .collect();
        let segments = Segments::new(&features, dims, &[0, 200], 1, 0).expect("they fit");
        let basis = directions(&segments, 4);
        for (i, a) in basis.chunks_exact(dims).enumerate() {
            for (j, b) in basis.chunks_exact(dims).enumerate() {
                let product: f64 = a.iter().zip(b).map(|(x, y)| x * y).sum();
                assert!((product - f64::from(u8::from(i == j))).abs() < 1e-12);
            }
        }
        let variance = |vector: &[f64]| -> f64 {
            let along =
                features.chunks_exact(dims).map(|row| row.iter().zip(vector).map(|(x, y)| x * y).sum());
            let along: Vec<f64> = along.collect();
            let mean = along.iter().sum::<f64>() / 200.0;
            along.iter().map(|x| (x - mean).powi(2)).sum()
        };
        let total: f64 = (0..dims)
            .map(|dim| {
                let mut axis = vec![0.0; dims];
                axis[dim] = 1.0;
                variance(&axis)
            })
            .sum();
        let held: f64 = basis.chunks_exact(dims).map(variance).sum();
        assert!(held > 0.85 * total && held <= total * (1.0 + 1e-12), "{held} of {total}");
    }
}
