//! Shrinkage of queries towards their examples.

use crate::rotations::quaternion::{between, dot, exp_one, log_short, of_row, product, unit};
use crate::simd::multiversion;

/// Examples side by side.
const LANES: usize = 8;

/// Largest distance of a query from the mean of its examples, relative to their root-mean-square distance. People
/// differ from each other more than examples do, and such a difference does not help to predict the next pose.
const BESIDE: f64 = 0.5;

/// Moves the last poses `(order, joints, 4)` towards those of the examples `(count, order + 1, joints, 4)`.
///
/// A pose is moved towards the mean of the examples' poses of the same frame if its distance exceeds [`BESIDE`] times
/// their distance, both root mean square and weighted by joint. It is moved until the distances agree. Without this
/// step, a regression extrapolates beyond its examples, the next query contains the result, and a wrong pose
/// persists.
pub(super) fn shrunk(segments: &[f64], recent: &[f64], weights: &[f64]) -> Vec<f64> {
    let width = 4 * weights.len();
    let length = recent.len() + width;
    let count = segments.len() / length;
    let mut result = Vec::with_capacity(recent.len());
    let mut means = vec![[0.0; 4]; weights.len()];
    let mut away = vec![[0.0; 3]; weights.len()];
    // Components of the examples' rotations side by side.
    let mut groups = vec![[[0.0; LANES]; 4]; count.div_ceil(LANES)];
    for (lag, pose) in recent.chunks_exact(width).enumerate() {
        let (mut spread, mut square) = (0.0, 0.0);
        for (joint, (q, &weight)) in pose.chunks_exact(4).zip(weights).enumerate() {
            let at = lag * width + 4 * joint;
            let first = of_row(&segments[at..at + 4]);
            let mut sum = [0.0; 4];
            for (k, example) in segments.chunks_exact(length).enumerate() {
                let q = of_row(&example[at..at + 4]);
                let sign = if dot(q, first) < 0.0 { -1.0 } else { 1.0 };
                for c in 0..4 {
                    groups[k / LANES][c][k % LANES] = q[c];
                    sum[c] += sign * q[c];
                }
            }
            let mean = unit(sum);
            for k in count..count.next_multiple_of(LANES) {
                for c in 0..4 {
                    groups[k / LANES][c][k % LANES] = mean[c];
                }
            }
            means[joint] = mean;
            away[joint] = log_short(between(mean, of_row(q))).map(|v| 2.0 * v);
            square += weight * length_square(away[joint]);
            spread += weight * squares(&groups, mean);
        }
        spread *= BESIDE * BESIDE / count as f64;
        let part = if square > spread { (spread / square).sqrt() } else { 1.0 };
        for (&mean, away) in means.iter().zip(&away) {
            result.extend(product(mean, exp_one(away.map(|v| 0.5 * (part * v)))));
        }
    }
    result
}

multiversion! {
    /// Sum of the squared angles between rotations and their mean.
    fn squares(groups: &[[[f64; LANES]; 4]], mean: [f64; 4]) -> f64 {
        let mut sums = [0.0; LANES];
        for group in groups {
            for lane in 0..LANES {
                let q = [group[0][lane], group[1][lane], group[2][lane], group[3][lane]];
                let half = log_short(between(mean, q));
                sums[lane] += 4.0 * (half[0] * half[0] + half[1] * half[1] + half[2] * half[2]);
            }
        }
        ((sums[0] + sums[1]) + (sums[2] + sums[3])) + ((sums[4] + sums[5]) + (sums[6] + sums[7]))
    }
}

fn length_square(v: [f64; 3]) -> f64 {
    v[0] * v[0] + v[1] * v[1] + v[2] * v[2]
}
