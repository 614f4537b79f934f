//! Smoothing of one joint, or of a translation, along its principal axes.

use super::axes;
use super::penalised::{HIGHEST, LANES, Row, penalised};
use super::strength::{Candidates, Memory};
use crate::Error;
use crate::Real;
use crate::clip::Planes;
use crate::filters::columns::BLOCK;
use crate::filters::development::Columns;
use crate::parallel::Interrupt;
use crate::simd::multiversion;

/// Weight of a sample without confidence. The line between its neighbours that stands for it keeps the smoother from swinging far
/// out in a long gap, and beyond the end of the clip.
pub(super) const LEAST_WEIGHT: f64 = 0.01;

/// Numbers per frame that columns need beside themselves: their softness and the rows of their equations.
const PER_FRAME: usize = LANES + LANES * (1 + HIGHEST);

/// Smooths vectors in place.
pub(super) fn smooth(
    columns: &mut Columns<'_>,
    noise: f64,
    candidates: &Candidates,
    spare: &mut Planes<f64>,
    interrupt: &Interrupt,
) -> Result<(), Error> {
    let frames = columns.frames;
    let padded = columns.vectors[0].len();
    let axes = axes::of_steps(columns.mean.map(|mean| &mean[..frames]), interrupt)?;
    spare.reshape(1, (LANES + 1 + PER_FRAME) * padded);
    let (z, rest) = spare.row_mut(0).split_at_mut(LANES * padded);
    let (variances, memory) = rest.split_at_mut(padded);
    let variances = columns.trust.map(|trust| {
        inverses(trust, LEAST_WEIGHT, variances);
        &variances[..frames]
    });
    for (z, direction) in z.chunks_exact_mut(padded).zip(&axes) {
        let vectors = columns.vectors.each_ref().map(|plane| &**plane);
        project(vectors, direction.map(|x| x / noise), z);
    }
    smooth_columns(z, (axes.len(), frames), variances, candidates, memory, interrupt)?;
    for vector in &mut columns.vectors {
        vector[..frames].fill(0.0);
    }
    for (z, direction) in z.chunks_exact(padded).zip(axes) {
        for (vector, x) in columns.vectors.iter_mut().zip(direction) {
            add_scaled(&z[..frames], x * noise, &mut vector[..frames]);
        }
    }
    Ok(())
}

/// Smooths a few columns of unit noise in place; they lie one after the other in `z`, which has room for [`LANES`].
pub(super) fn smooth_some(
    z: &mut [f64],
    (used, frames): (usize, usize),
    candidates: &Candidates,
    spare: &mut Planes<f64>,
    interrupt: &Interrupt,
) -> Result<(), Error> {
    spare.reshape(1, PER_FRAME * frames.next_multiple_of(BLOCK));
    smooth_columns(z, (used, frames), None, candidates, spare.row_mut(0), interrupt)
}

/// Smooths the first columns of `z`, of so many frames each. `memory` has [`PER_FRAME`] numbers for each number of a column.
fn smooth_columns(
    z: &mut [f64],
    (used, frames): (usize, usize),
    variances: Option<&[f64]>,
    candidates: &Candidates,
    memory: &mut [f64],
    interrupt: &Interrupt,
) -> Result<(), Error> {
    let mut columns: [&mut [f64]; LANES] = split(z);
    let (softness, rows) = memory.split_at_mut(memory.len() / PER_FRAME * LANES);
    let softness: [&mut [f64]; LANES] = split(softness);
    let (rows, _) = rows.as_chunks_mut::<LANES>();
    let (rows, _): (&mut [Row], _) = rows.as_chunks_mut::<{ 1 + HIGHEST }>();
    let mut orders = [1; LANES];
    let mut choice: Memory = candidates.memory();
    for lane in 0..LANES {
        if lane < used {
            orders[lane] = candidates.choose(&columns[lane][..frames], softness[lane], &mut choice);
        } else {
            columns[lane].fill(0.0);
            softness[lane].fill(1.0);
        }
    }
    penalised(
        orders,
        columns.each_mut().map(|column| &mut column[..frames]),
        variances,
        softness.each_ref().map(|softness| &softness[..frames]),
        rows,
        interrupt,
    )
}

/// Equal parts of a slice.
fn split(whole: &mut [f64]) -> [&mut [f64]; LANES] {
    let mut parts = whole.chunks_exact_mut(whole.len() / LANES);
    std::array::from_fn(|_| parts.next().unwrap_or_default())
}

multiversion! {
    /// One over the weights, which are at least `least`.
    pub(super) fn inverses<T: Real>(weights: &[T], least: T, out: &mut [T]) {
        let n = out.len();
        let weights = &weights[..n];
        for i in 0..n {
            out[i] = T::ONE / weights[i].max(least);
        }
    }
}

multiversion! {
    /// Inner products with a direction.
    fn project<T: Real>(vectors: [&[T]; 3], direction: [T; 3], out: &mut [T]) {
        let n = out.len();
        let [x, y, z] = vectors.map(|plane| &plane[..n]);
        for i in 0..n {
            out[i] = x[i] * direction[0] + y[i] * direction[1] + z[i] * direction[2];
        }
    }
}

multiversion! {
    /// Adds values times a factor to sums.
    fn add_scaled<T: Real>(values: &[T], factor: T, sums: &mut [T]) {
        let n = sums.len();
        let values = &values[..n];
        for i in 0..n {
            sums[i] += factor * values[i];
        }
    }
}
