//! Queries among their examples.

use crate::rotations::quaternion::{between, dot, exp_one, log_short, of_row, product, unit};
use crate::simd::multiversion;

/// Examples side by side.
const LANES: usize = 8;

/// How far beside the mean of its examples a query may lie, in their root mean square distances: people differ from each other by
/// more than examples do, and what is peculiar to one says nothing about the others.
const BESIDE: f64 = 0.5;

/// Brings the last poses `(order, joints, 4)` back among those of the examples `(count, order + 1, joints, 4)`.
///
/// A pose that lies farther from the mean of the examples' poses of that frame than [`BESIDE`] times as these do, root mean square and
/// weighted by joint, is moved towards it until it does not. What a regression makes of a query beyond its examples is passed on to the next
/// query, and a wrong pose would be kept.
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
    /// Sum of the squared angles between rotations and one.
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
