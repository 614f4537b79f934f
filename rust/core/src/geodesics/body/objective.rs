//! The objective of a geodesic's direction, and its gradient.

use super::poses::{Lane, Part, Poses, TILE, Tile, parts};
use super::projection::{Nearest, furthest, nearest_points};
use crate::Error;
use crate::geodesics::pga::Objective;
use crate::parallel::{self, Interrupt};
use crate::simd::multiversion;

/// Distance on S³ below which a pose lies on the geodesic: its direction from the geodesic is lost in rounding
/// errors.
const ON_GEODESIC: f64 = 1e-14;

/// Number of running sums: one vector of float64 at the widest level.
const LANES: usize = 8;

/// Estimated nanoseconds per sample for the nearest point.
pub(super) const SAMPLE_NANOSECONDS: usize = 20;

/// An objective at a direction.
#[derive(Debug, Clone)]
pub(super) struct Slope {
    pub(super) value: f64,
    /// Gradient, orthogonal to the direction.
    pub(super) gradient: Vec<f64>,
    /// The pose whose direction is nearest to that of the geodesic.
    pub(super) nearest: Option<usize>,
}

/// Contribution of a tile to the objective.
struct Share {
    value: f64,
    /// For each joint `Σ f b` and `Σ f sinc θ (u − p e)`, with `f = (weight) s φ sign a`.
    sums: Vec<[f64; 4]>,
    limit: f64,
    /// The angle to the nearest pose's direction, and the index of that pose in the tile.
    nearest: (f64, usize),
}

/// Objective at the unit vector `v`, with three components for each joint in `which`, and its gradient on the sphere.
///
/// Each `s` is optimal, so its own change does not contribute and the gradient is the one at fixed `s`. Poses whose
/// `s` is at its limit `π / (2 max n_j)` move with that limit. `s` has one lane per tile: the start values on entry,
/// the nearest points on return.
pub(super) fn slope(
    poses: &Poses,
    v: &[f64],
    which: &[usize],
    objective: Objective,
    s: &mut [Lane],
    interrupt: &Interrupt,
) -> Result<Slope, Error> {
    let part = parts(v, which);
    let end = furthest(&part);
    let count = poses.count as f64;
    let tasks: Vec<(&Tile, &mut Lane)> = poses.tiles.iter().zip(s).collect();
    let nanoseconds = poses.count * which.len() * SAMPLE_NANOSECONDS;
    let shares = parallel::map(tasks, nanoseconds, |_, (tile, s)| {
        interrupt.check()?;
        Ok(share(tile, &part, objective, end, s))
    })?;
    let mut value = 0.0;
    let mut limit = 0.0;
    let mut sums = vec![[0.0; 4]; part.len()];
    let mut nearest = (f64::INFINITY, None);
    for (tile, share) in shares.iter().enumerate() {
        value += share.value;
        limit += share.limit;
        for (sum, more) in sums.iter_mut().zip(&share.sums) {
            for (sum, more) in sum.iter_mut().zip(more) {
                *sum += more;
            }
        }
        if share.nearest.0 < nearest.0 {
            nearest = (share.nearest.0, Some(tile * TILE + share.nearest.1));
        }
    }
    let mut gradient = Vec::with_capacity(v.len());
    for (sum, part) in sums.iter().zip(&part) {
        gradient.extend((0..3).map(|c| -2.0 / count * (sum[0] * part.axis[c] + sum[c + 1])));
    }
    let fastest =
        (0..part.len()).fold(0, |best, i| if part[i].length > part[best].length { i } else { best });
    for c in 0..3 {
        gradient[fastest * 3 + c] -= limit / count / part[fastest].length * part[fastest].axis[c];
    }
    remove_along(&mut gradient, v);
    Ok(Slope { value: value / count, gradient, nearest: nearest.1 })
}

/// Removes from a vector its component along the unit vector `v`.
pub(super) fn remove_along(vector: &mut [f64], v: &[f64]) {
    let along: f64 = vector.iter().zip(v).map(|(a, b)| a * b).sum();
    for (x, v) in vector.iter_mut().zip(v) {
        *x -= along * v;
    }
}

fn share(tile: &Tile, v: &[Part], objective: Objective, end: f64, s: &mut Lane) -> Share {
    let Nearest { sums, kept } = nearest_points(tile, v, objective == Objective::Chordal, s);
    let mut share =
        Share { value: 0.0, sums: vec![[0.0; 4]; v.len()], limit: 0.0, nearest: (f64::INFINITY, 0) };
    let mut weights = Lane::ZERO;
    for i in 0..TILE {
        let square = sums.square.0[i];
        let distance = square.sqrt();
        let (value, weight) = match objective {
            Objective::Geodesic if distance > ON_GEODESIC => (distance, 0.5 / distance),
            Objective::Geodesic => (distance, 0.0),
            Objective::Squared => (square, 1.0),
            Objective::Chordal => (0.5 * square, 0.5),
        };
        share.value += value;
        weights.0[i] = weight * s.0[i];
        if s.0[i].abs() >= end {
            share.limit -= 2.0 * weights.0[i] * sums.pull.0[i];
        }
        let angle = distance / s.0[i].abs();
        if angle < share.nearest.0 {
            share.nearest = (angle, i);
        }
    }
    for ((part, kept), sums) in v.iter().zip(&kept).zip(&mut share.sums) {
        let mut lanes = [[0.0; LANES]; 4];
        add_gradient(&tile[part.joint], kept, part.axis, &weights, &mut lanes);
        *sums = lanes.map(|lanes| lanes.iter().sum());
    }
    share
}

multiversion! {
    fn add_gradient(
        samples: &[Lane; 4],
        kept: &[Lane; 3],
        axis: [f64; 3],
        weights: &Lane,
        sums: &mut [[f64; LANES]; 4],
    ) {
        let total = sums;
        let mut sums = *total;
        let [_, x, y, z] = samples;
        let [factor, along, sinc] = kept;
        for first in (0..TILE).step_by(LANES) {
            for i in first..first + LANES {
                let c = i - first;
                let u = [x.0[i], y.0[i], z.0[i]];
                let p = u[0] * axis[0] + u[1] * axis[1] + u[2] * axis[2];
                let f = weights.0[i] * factor.0[i];
                let g = f * sinc.0[i];
                sums[0][c] += f * along.0[i];
                sums[1][c] += g * (u[0] - p * axis[0]);
                sums[2][c] += g * (u[1] - p * axis[1]);
                sums[3][c] += g * (u[2] - p * axis[2]);
            }
        }
        *total = sums;
    }
}
