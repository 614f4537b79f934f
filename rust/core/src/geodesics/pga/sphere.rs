//! Global search for the direction of the nearest geodesic on the whole sphere of directions.
//!
//! Branch and bound finds every local minimum that matters. The half sphere is projected on three faces of a cube,
//! which are divided into squares. Within `δ` of the centre `c` of a square a sample's distance changes by at most
//! `δ·r`, `r = |u|`. Without a cone point in the square its downward curvature is at most `r/w`. So the mean over
//! such samples is at least `F(c) − |∇F(c)| δ − M δ²/2`, where `M` is the mean of `r/w`. Squares whose bound exceeds
//! the result of a descent are dropped; the others are divided into four.

use super::descent::{Found, descent};
use super::objective::{Objective, Shape, by_shape, project, scaled_to_one, value};
use super::samples::{LANES, Quad, Samples, dot};
use crate::eigen::eigenvectors;
use crate::parallel::{self, Interrupt};
use crate::simd::multiversion;
use crate::{Error, Real};

/// Largest number of samples for the search; its results descend over all samples.
const SUBSET: usize = 512;

/// Squares along the edge of a face at the start.
const SQUARES: usize = 4;

/// Largest number of divisions: squares are then a hundredth of a degree wide, narrower than a minimum.
const LEVELS: usize = 12;

/// Largest number of squares at once: with more of them the minimum is flat along a line, and any of its points will
/// do.
const MOST_SQUARES: usize = 4096;

/// Relative tolerance: a region is pruned unless it can improve the best value by more than this.
const ENOUGH: f64 = 1e-7;

/// Slope that a sample's curvature may add within a square. Above it the distance is bounded by its slope alone.
const BENT: f64 = 1.0;

/// Cosine of two degrees: nearer directions descend to the same minimum.
const APART: f64 = 0.999_390_827_019_095_8;

/// Number of directions that descend over all samples.
const DESCENTS: usize = 3;

/// Number of squares of the first division whose centres descend on the subset.
const ENTRIES: usize = 4;

/// Directions per task.
const TASK: usize = 16;

/// Direction with the lowest objective; not all samples may be 1.
pub(super) fn nearest_geodesic(
    samples: &Samples,
    objective: Objective,
    interrupt: &Interrupt,
) -> Result<Found, Error> {
    let suggested = suggested_directions(samples, interrupt)?;
    let subset = samples.subset(SUBSET);
    let mut starts = suggested.to_vec();
    starts.extend(valleys(&subset, objective, interrupt)?);
    let mut tried = Vec::with_capacity(starts.len());
    for v in starts {
        tried.push((value(samples, v, objective, interrupt)?, v));
    }
    let mut best: Option<Found> = None;
    for v in lowest(tried, DESCENTS) {
        let found = descent(samples, v, objective, interrupt)?;
        if best.as_ref().is_none_or(|best| found.value() < best.value()) {
            best = Some(found);
        }
    }
    Ok(best.unwrap_or(Found { direction: [1.0, 0.0, 0.0], descent: Vec::new() }))
}

/// At most `most` directions with the lowest values, with a minimum distance from each other.
fn lowest(mut tried: Vec<(f64, [f64; 3])>, most: usize) -> Vec<[f64; 3]> {
    tried.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut chosen: Vec<[f64; 3]> = Vec::new();
    for (_, v) in tried {
        if chosen.len() < most && chosen.iter().all(|&other| dot(v, other).abs() < APART) {
            chosen.push(v);
        }
    }
    chosen
}

/// Closed-form candidates: principal axes of the vector parts and of the logarithms, and the paper's eq. (14).
fn suggested_directions(samples: &Samples, interrupt: &Interrupt) -> Result<[[f64; 3]; 7], Error> {
    let [a, b, c] = principal_axes(samples, false, interrupt)?;
    let [d, e, f] = principal_axes(samples, true, interrupt)?;
    let total = samples.sums(3, interrupt, |part, sums| add_folded(part, a, sums))?;
    let length = dot(total, total).sqrt();
    Ok([a, b, c, d, e, f, if length > 0.0 { scaled_to_one(total) } else { a }])
}

/// Eigenvectors of `Σ y yᵀ` in descending order, of the vector parts or the logarithms `y`.
pub(super) fn principal_axes(
    samples: &Samples,
    logarithms: bool,
    interrupt: &Interrupt,
) -> Result<[[f64; 3]; 3], Error> {
    let [xx, xy, xz, yy, yz, zz] =
        samples.sums(5, interrupt, |part, sums| add_products(part, logarithms, sums))?;
    let mut matrix = [xx, xy, xz, xy, yy, yz, xz, yz, zz];
    let vectors = eigenvectors(&mut matrix, 3, interrupt)?;
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| matrix[j * 4].total_cmp(&matrix[i * 4]));
    Ok(order.map(|column| std::array::from_fn(|i| vectors[i * 3 + column])))
}

/// A square on a face of the cube: the face, and the centre on it.
#[derive(Debug, Clone, Copy)]
struct Square {
    face: usize,
    middle: [f64; 2],
}

impl Square {
    /// The direction of the centre, for a cube along `axes`.
    fn direction(self, axes: &[[f64; 3]; 3]) -> [f64; 3] {
        let mut point = [1.0; 3];
        point[(self.face + 1) % 3] = self.middle[0];
        point[(self.face + 2) % 3] = self.middle[1];
        let point = scaled_to_one(point);
        std::array::from_fn(|i| point[0] * axes[0][i] + point[1] * axes[1][i] + point[2] * axes[2][i])
    }
}

/// Directions of local minima, the lowest of all among them.
fn valleys(samples: &Samples, objective: Objective, interrupt: &Interrupt) -> Result<Vec<[f64; 3]>, Error> {
    let axes = principal_axes(samples, false, interrupt)?;
    let mut suggested = Vec::new();
    for v in suggested_directions(samples, interrupt)? {
        suggested.push((value(samples, v, objective, interrupt)?, v));
    }
    let mut found = Vec::new();
    for v in lowest(suggested, 1) {
        found.push(descent(samples, v, objective, interrupt)?);
    }
    let middle = |i: usize| (2 * i + 1) as f64 / SQUARES as f64 - 1.0;
    let mut squares: Vec<Square> = (0..3 * SQUARES * SQUARES)
        .map(|i| Square {
            face: i / (SQUARES * SQUARES),
            middle: [middle(i / SQUARES % SQUARES), middle(i % SQUARES)],
        })
        .collect();
    let mut half = 1.0 / SQUARES as f64;
    for level in 0..LEVELS {
        let directions: Vec<[f64; 3]> = squares.iter().map(|square| square.direction(&axes)).collect();
        let reach = std::f64::consts::SQRT_2 * half;
        let bounds = lower_bounds(samples, &directions, reach, objective, interrupt)?;
        let low = found.iter().map(Found::value).fold(f64::INFINITY, f64::min);
        let tried = bounds.iter().zip(&directions).map(|(bound, v)| (bound.0, *v));
        let starts = if level == 0 {
            lowest(tried.collect(), ENTRIES)
        } else {
            lowest(tried.filter(|(value, _)| *value < low).collect(), 1)
        };
        for v in starts {
            found.push(descent(samples, v, objective, interrupt)?);
        }
        let low = found.iter().map(Found::value).fold(low, f64::min);
        half /= 2.0;
        squares = squares
            .iter()
            .zip(&bounds)
            .filter(|(_, (_, bound))| *bound < low * (1.0 - ENOUGH))
            .flat_map(|(square, _)| quarters(*square, half))
            .collect();
        if squares.is_empty() || squares.len() > MOST_SQUARES {
            break;
        }
    }
    Ok(found.into_iter().map(|found| found.direction).collect())
}

fn quarters(square: Square, half: f64) -> [Square; 4] {
    [[-half, -half], [-half, half], [half, -half], [half, half]]
        .map(|by| Square { middle: [square.middle[0] + by[0], square.middle[1] + by[1]], ..square })
}

/// Sums of a bound: the objective, the gradient, `Σ pull·p`, the objective or its lower bound, the curvatures.
const BOUND_SUMS: usize = 7;

/// Objectives at directions, and their lower bounds within `reach` radians.
fn lower_bounds(
    samples: &Samples,
    directions: &[[f64; 3]],
    reach: f64,
    objective: Objective,
    interrupt: &Interrupt,
) -> Result<Vec<(f64, f64)>, Error> {
    let (_, cosine) = Real::sin_cos(reach);
    let tasks: Vec<&[[f64; 3]]> = directions.chunks(TASK).collect();
    let count = samples.count() as f64;
    let parts = parallel::map(tasks, directions.len() * samples.count() * 8, |_, task| {
        interrupt.check()?;
        let bound = |&v: &[f64; 3]| {
            let mut lanes = [[0.0; LANES]; BOUND_SUMS];
            by_shape!(objective, S => add_bounds::<S>(samples.all(), v, [reach, cosine], &mut lanes));
            let [value, gx, gy, gz, radial, least, bends] =
                lanes.map(|lanes| lanes.iter().sum::<f64>() / count);
            let gradient = [gx - radial * v[0], gy - radial * v[1], gz - radial * v[2]];
            (value, least - dot(gradient, gradient).sqrt() * reach - bends * reach * reach / 2.0)
        };
        Ok(task.iter().map(bound).collect::<Vec<_>>())
    })?;
    Ok(parts.concat())
}

multiversion! {
    fn add_bounds<S: Shape>(samples: Quad<'_>, v: [f64; 3], reach: [f64; 2], sums: &mut [[f64; LANES]; BOUND_SUMS]) {
        let [reach, cosine] = reach;
        let total = sums;
        let mut sums = *total;
        let [w, x, y, z] = samples.map(|plane| plane.as_chunks::<LANES>().0);
        for (((w, x), y), z) in w.iter().zip(x).zip(y).zip(z) {
            for c in 0..LANES {
                let u = [x[c], y[c], z[c]];
                let (p, sine, f) = project([w[c], x[c], y[c], z[c]], v);
                let r = dot(u, u).sqrt();
                let bend = S::bend(w[c], r);
                let near = S::CONE & (p.abs() >= r * cosine);
                let rough = (bend * reach > BENT) | near;
                let nearest = sine.atan2_nonnegative(f) - r * reach;
                let least = S::of_distance(if nearest > 0.0 { nearest } else { 0.0 });
                let value = S::value(sine, f);
                let over_sine = 1.0 / (sine + f64::MIN_POSITIVE);
                let [first, ..] = S::derivatives(sine, f, over_sine);
                let pull = if rough { 0.0 } else { -first * p * over_sine / f };
                sums[0][c] += value;
                sums[1][c] += pull * u[0];
                sums[2][c] += pull * u[1];
                sums[3][c] += pull * u[2];
                sums[4][c] += pull * p;
                sums[5][c] += if rough { least } else { value };
                sums[6][c] += if rough { 0.0 } else { bend };
            }
        }
        *total = sums;
    }
}

multiversion! {
    fn add_products(samples: Quad<'_>, logarithms: bool, sums: &mut [[f64; LANES]; 6]) {
        let total = sums;
        let mut sums = *total;
        let [w, x, y, z] = samples.map(|plane| plane.as_chunks::<LANES>().0);
        for (((w, x), y), z) in w.iter().zip(x).zip(y).zip(z) {
            for c in 0..LANES {
                let square = x[c] * x[c] + y[c] * y[c] + z[c] * z[c];
                let sine = (square + f64::TINY_SQUARE).sqrt();
                let angle = sine.atan2_nonnegative(w[c]);
                let factor = if logarithms { angle / sine } else { 1.0 };
                let weight = factor * factor;
                sums[0][c] += weight * x[c] * x[c];
                sums[1][c] += weight * x[c] * y[c];
                sums[2][c] += weight * x[c] * z[c];
                sums[3][c] += weight * y[c] * y[c];
                sums[4][c] += weight * y[c] * z[c];
                sums[5][c] += weight * z[c] * z[c];
            }
        }
        *total = sums;
    }
}

multiversion! {
    /// Sums of `|u| u` with the signs of the half-space about `axis`.
    fn add_folded(samples: Quad<'_>, axis: [f64; 3], sums: &mut [[f64; LANES]; 3]) {
        let total = sums;
        let mut sums = *total;
        let [_, x, y, z] = samples.map(|plane| plane.as_chunks::<LANES>().0);
        for ((x, y), z) in x.iter().zip(y).zip(z) {
            for c in 0..LANES {
                let u = [x[c], y[c], z[c]];
                let weight = dot(u, u).sqrt().copysign(dot(u, axis));
                sums[0][c] += weight * u[0];
                sums[1][c] += weight * u[1];
                sums[2][c] += weight * u[2];
            }
        }
        *total = sums;
    }
}
