//! Products of the steps of the pilot's development: which joints move together.

use super::about::Noisy;
use super::products::{add_products, padded, product, transposed};
use crate::parallel::{self, Interrupt};
use crate::{Error, Real};
use std::ops::Range;

/// Steps whose products are added together: a whole body of them stays in the first-level cache.
const CHUNK: usize = 64;

/// Parts of a clip at most: each has sums of its own.
const PARTS: usize = 16;

/// Steps of a part, at least.
const SHORTEST: usize = 16 * CHUNK;

/// Parts in which the steps of a clip are added up; they depend on its length alone.
pub(super) fn parts(frames: usize) -> Vec<Range<usize>> {
    let steps = frames.saturating_sub(1);
    let part = steps.div_ceil(PARTS).next_multiple_of(CHUNK).max(SHORTEST);
    (0..steps).step_by(part).map(|first| first..steps.min(first + part)).collect()
}

/// The products `Σ_t s_t s_tᵀ` of the steps of some joints: rows of `padded(3 joints)` numbers, of which those from the diagonal on
/// to the right are there.
pub(super) fn of_all<T: Real>(
    noisy: &Noisy<'_, T>,
    joints: &[usize],
    interrupt: &Interrupt,
) -> Result<Vec<f64>, Error> {
    let width = padded(3 * joints.len());
    let work = noisy.clip.frames() * (width * width / 16 + joints.len() * 20);
    let sums = parallel::map(parts(noisy.clip.frames()), work, |_, part| {
        let mut products = vec![0.0; width * width];
        add_within(noisy, joints, part, &mut products, interrupt)?;
        Ok(products)
    })?;
    Ok(total(sums))
}

/// Sums of matrices.
pub(super) fn total(sums: Vec<Vec<f64>>) -> Vec<f64> {
    let mut sums = sums.into_iter();
    let mut total = sums.next().unwrap_or_default();
    for sum in sums {
        for (total, x) in total.iter_mut().zip(sum) {
            *total += x;
        }
    }
    total
}

/// Adds the products of the steps of some joints in a part of the clip.
pub(super) fn add_within<T: Real>(
    noisy: &Noisy<'_, T>,
    joints: &[usize],
    part: Range<usize>,
    products: &mut [f64],
    interrupt: &Interrupt,
) -> Result<(), Error> {
    let width = padded(3 * joints.len());
    let mut rows = vec![0.0; CHUNK * width];
    for start in part.clone().step_by(CHUNK) {
        interrupt.check()?;
        let steps = start..part.end.min(start + CHUNK);
        let rows = &mut rows[..steps.len() * width];
        noisy.steps(joints, steps, width, rows);
        add_products(rows, width, products, width);
    }
    Ok(())
}

/// Products of the steps of some joints, in rows, with those of others in a part of the clip: rows of `padded(3 others)` numbers.
pub(super) fn between<T: Real>(
    noisy: &Noisy<'_, T>,
    joints: &[usize],
    others: &[usize],
    part: Range<usize>,
    interrupt: &Interrupt,
) -> Result<Vec<f64>, Error> {
    let [down, along] = [joints, others].map(|joints| padded(3 * joints.len()));
    let mut rows = [vec![0.0; CHUNK * down], vec![0.0; CHUNK * along]];
    let mut sums = vec![0.0; 3 * joints.len() * along];
    let mut products = sums.clone();
    for start in part.clone().step_by(CHUNK) {
        interrupt.check()?;
        let steps = start..part.end.min(start + CHUNK);
        let count = steps.len();
        let [left, right] = &mut rows;
        noisy.steps(joints, steps.clone(), down, left);
        noisy.steps(others, steps, along, right);
        let turned = transposed(&left[..count * down], down, 3 * joints.len(), count);
        product(&turned, count, &right[..count * along], along, &mut products);
        for (sum, x) in sums.iter_mut().zip(&products) {
            *sum += x;
        }
    }
    Ok(sums)
}
