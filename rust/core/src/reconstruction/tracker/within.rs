//! Queries among their examples.

use crate::rotations::quaternion::{between, dot, exp_one, log_short, of_row, product, unit};

/// How far beside the mean of its examples a query may lie, in their root mean square distances: people differ from each other by
/// more than examples do, and what is peculiar to one says nothing about the others.
const BESIDE: f64 = 0.5;

/// Brings the last poses `(order, joints, 4)` back among those of the examples `(count, order + 1, joints, 4)`.
///
/// A pose that lies farther from the mean of the examples' poses of that frame than [`BESIDE`] times as these do, root mean square and
/// weighted by joint, is moved towards it until it does not. What a regression makes of a query beyond its examples is passed on to the next
/// query, and a wrong pose would be kept.
pub(super) fn within(segments: &[f64], recent: &[f64], weights: &[f64]) -> Vec<f64> {
    let width = 4 * weights.len();
    let length = recent.len() + width;
    let mut result = Vec::with_capacity(recent.len());
    let mut means = vec![[0.0; 4]; weights.len()];
    let mut away = vec![[0.0; 3]; weights.len()];
    for (lag, pose) in recent.chunks_exact(width).enumerate() {
        let here = lag * width..(lag + 1) * width;
        let nearest = &segments[here.clone()];
        means.fill([0.0; 4]);
        for example in segments.chunks_exact(length) {
            let joints = example[here.clone()].chunks_exact(4).zip(nearest.chunks_exact(4));
            for (mean, (q, first)) in means.iter_mut().zip(joints) {
                let sign = if dot(of_row(q), of_row(first)) < 0.0 { -1.0 } else { 1.0 };
                for (sum, &x) in mean.iter_mut().zip(q) {
                    *sum += sign * x;
                }
            }
        }
        let (mut spread, mut count, mut square) = (0.0, 0.0, 0.0);
        for (mean, (away, (q, &weight))) in
            means.iter_mut().zip(away.iter_mut().zip(pose.chunks_exact(4).zip(weights)))
        {
            *mean = unit(*mean);
            *away = log_short(between(*mean, of_row(q))).map(|v| 2.0 * v);
            square += weight * length_square(*away);
        }
        for example in segments.chunks_exact(length) {
            for ((q, &mean), &weight) in example[here.clone()].chunks_exact(4).zip(&means).zip(weights) {
                spread += weight * length_square(log_short(between(mean, of_row(q))).map(|v| 2.0 * v));
            }
            count += 1.0;
        }
        spread *= BESIDE * BESIDE / count;
        let part = if square > spread { (spread / square).sqrt() } else { 1.0 };
        for (&mean, away) in means.iter().zip(&away) {
            result.extend(product(mean, exp_one(away.map(|v| 0.5 * (part * v)))));
        }
    }
    result
}

fn length_square(v: [f64; 3]) -> f64 {
    v[0] * v[0] + v[1] * v[1] + v[2] * v[2]
}
