//! Direction of the geodesic nearest to the poses, from several starts.

use super::descent::{Found, Ground, STEPS, norm};
use super::poses::{Lane, Poses, TILE, Tile, logarithms};
use crate::Error;
use crate::eigen::eigenvectors;
use crate::parallel::{self, Interrupt};
use crate::simd::multiversion;

/// Largest number of poses on which the starts descend: enough to distinguish local minima.
const SUBSET: usize = 512;

/// Largest number of steps on the subset; the final descent runs on all poses.
const SUBSET_STEPS: usize = 60;

/// Relative improvement below which a start counts as equally good: the first one is kept, and rounding does not
/// decide.
const LOWER: f64 = 1e-12;

/// Starts of each kind: a single one missed the lowest minimum in one fit of nine on recordings.
const AXES: usize = 3;

/// Number of running sums: one vector of float64 at the widest level.
const LANES: usize = 8;

/// Direction with the lowest objective found.
///
/// The starts descend on a subset of the poses. The final descent over all poses begins at the best of their results,
/// or at the tangent principal axis itself if that is better. So the result is never worse than a tangent principal
/// axis.
pub(super) fn nearest_geodesic(ground: Ground<'_>) -> Result<Found, Error> {
    let subset = ground.poses.subset(SUBSET);
    let Ground { which, interrupt, .. } = ground;
    let mut starts = axes(ground.poses, which, false, AXES, interrupt)?;
    starts.extend(axes(&subset, which, true, AXES, interrupt)?);
    let few = Ground { poses: &subset, ..ground };
    let nanoseconds = subset.count * which.len() * super::objective::SAMPLE_NANOSECONDS;
    let valleys = parallel::map(starts.iter().collect(), nanoseconds, |_, start: &Vec<f64>| {
        Ok(few.descent(start, SUBSET_STEPS)?.direction)
    })?;
    let mut best = (&starts[0], f64::INFINITY);
    let mut s = ground.at_one();
    for v in starts.iter().take(1).chain(&valleys) {
        let value = ground.slope(v, &mut s)?.value;
        if value < best.1 * (1.0 - LOWER) {
            best = (v, value);
        }
    }
    ground.descent(best.0, STEPS)
}

/// The first eigenvectors of `Σ y yᵀ` for the logarithms `y` of the poses; with `alike`, of `Σ y yᵀ/|y|²`, which
/// gives all poses the same weight.
fn axes(
    poses: &Poses,
    which: &[usize],
    alike: bool,
    count: usize,
    interrupt: &Interrupt,
) -> Result<Vec<Vec<f64>>, Error> {
    let n = which.len() * 3;
    let parts =
        parallel::map(poses.tiles.iter().collect(), poses.tiles.len() * n * n * 16, |_, tile: &Tile| {
            interrupt.check()?;
            let mut y = vec![[Lane::ZERO; 3]; which.len()];
            for (y, &joint) in y.iter_mut().zip(which) {
                logarithms(&tile[joint], y);
            }
            let mut rows = y.concat();
            if alike {
                scale_to_one(&mut rows);
            }
            let mut products = vec![0.0; n * n];
            add_products(&rows, &mut products);
            Ok(products)
        })?;
    let mut matrix = vec![0.0; n * n];
    for part in &parts {
        for (sum, more) in matrix.iter_mut().zip(part) {
            *sum += more;
        }
    }
    let vectors = eigenvectors(&mut matrix, n, interrupt)?;
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&a, &b| matrix[b * n + b].total_cmp(&matrix[a * n + a]));
    let column = |&j: &usize| {
        let v: Vec<f64> = (0..n).map(|i| vectors[i * n + j]).collect();
        let length = norm(&v);
        v.iter().map(|x| x / length).collect()
    };
    Ok(order.iter().take(count).map(column).collect())
}

/// Normalises each pose's vector; 0 stays 0.
fn scale_to_one(rows: &mut [Lane]) {
    for i in 0..TILE {
        let square: f64 = rows.iter().map(|row| row.0[i] * row.0[i]).sum();
        let scale = if square > 0.0 { 1.0 / square.sqrt() } else { 0.0 };
        for row in rows.iter_mut() {
            row.0[i] *= scale;
        }
    }
}

multiversion! {
    /// Inner products of all pairs of rows, as a symmetric matrix.
    fn add_products(rows: &[Lane], products: &mut [f64]) {
        let n = rows.len();
        for a in 0..n {
            for b in a..n {
                let mut lanes = [0.0; LANES];
                let (left, _) = rows[a].0.as_chunks::<LANES>();
                let (right, _) = rows[b].0.as_chunks::<LANES>();
                for (left, right) in left.iter().zip(right) {
                    for c in 0..LANES {
                        lanes[c] += left[c] * right[c];
                    }
                }
                let mut sum = 0.0;
                for lane in lanes {
                    sum += lane;
                }
                products[a * n + b] = sum;
                products[b * n + a] = sum;
            }
        }
    }
}
