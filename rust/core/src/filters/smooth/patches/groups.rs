//! Which joints move alike.

use super::COMPANIONS;
use super::wiener::{LANE, add_products};
use crate::Error;
use crate::clip::Planes;
use crate::parallel::{self, Interrupt};

/// Differences of similarity below which two joints are equally alike.
const SAME: f64 = 1e-9;

/// Steps whose products are added together: a whole body of them stays in the first-level cache.
const CHUNK: usize = 48;

/// Tasks at most: each has sums of its own, for every pair of joints.
const TASKS: usize = 16;

/// For each joint itself and the others that move most like it; `mean` holds the joints' developments.
///
/// With the steps `v` from frame to frame and `M_ij = Σ_t v_i v_jᵀ`, the similarity of two joints is
/// `‖M_ij‖ / √(‖M_ii‖ ‖M_jj‖)`, Frobenius norms. Among equals the first joint is taken.
pub(super) fn groups(
    mean: &[Planes<f64>],
    frames: usize,
    interrupt: &Interrupt,
) -> Result<Vec<Vec<usize>>, Error> {
    let joints = mean.len();
    let shared = norms(mean, frames, interrupt)?;
    let similarity = |i: usize, j: usize| {
        let own = (shared[i * joints + i] * shared[j * joints + j]).sqrt();
        if own > 0.0 { shared[i * joints + j] / own } else { 0.0 }
    };
    let group = |joint: usize| {
        let mut members = vec![joint];
        while members.len() < COMPANIONS.min(joints) {
            let others = || (0..joints).filter(|other| !members.contains(other));
            let best = others().map(|other| similarity(joint, other)).fold(0.0, f64::max);
            let first = others().find(|&other| similarity(joint, other) >= best - SAME);
            members.extend(first);
        }
        members
    };
    Ok((0..joints).map(group).collect())
}

/// Frobenius norms of the products of the steps of each two joints, `(joints, joints)`.
fn norms(mean: &[Planes<f64>], frames: usize, interrupt: &Interrupt) -> Result<Vec<f64>, Error> {
    let joints = mean.len();
    let steps = frames.saturating_sub(1);
    let width = (joints * 3).next_multiple_of(LANE);
    let task = steps.div_ceil(TASKS).next_multiple_of(CHUNK);
    let tasks: Vec<usize> = (0..steps).step_by(task).collect();
    let work = steps * width * width / 16;
    let sums = parallel::map(tasks, work, |_, first| {
        let mut products = Planes::new(1, width * width);
        let mut rows = Planes::new(1, CHUNK * width);
        for start in (first..steps.min(first + task)).step_by(CHUNK) {
            interrupt.check()?;
            let length = CHUNK.min(steps - start);
            let rows = &mut rows.row_mut(0)[..length * width];
            for (joint, planes) in mean.iter().enumerate() {
                for (c, column) in planes.rows_from::<3>(0).into_iter().enumerate() {
                    let ends = column[start..].windows(2);
                    for (row, ends) in rows.chunks_exact_mut(width).zip(ends) {
                        row[joint * 3 + c] = ends[1] - ends[0];
                    }
                }
            }
            add_products(rows, width, products.row_mut(0));
        }
        Ok(products)
    })?;
    let mut norms = vec![0.0; joints * joints];
    for i in 0..joints {
        for j in i..joints {
            let mut square = 0.0;
            for a in i * 3..i * 3 + 3 {
                for b in j * 3..j * 3 + 3 {
                    // Of the products, only blocks from the diagonal on are there.
                    let at = a.min(b) * width + a.max(b);
                    let sum: f64 = sums.iter().map(|products| products.row(0)[at]).sum();
                    square += sum * sum;
                }
            }
            norms[i * joints + j] = square.sqrt();
            norms[j * joints + i] = square.sqrt();
        }
    }
    Ok(norms)
}
