//! Smoothing of one joint, or of a translation, along its principal axes.

use super::axes;
use super::penalised::{HIGHEST, Memory, penalised};
use super::strength::Candidates;
use crate::Error;
use crate::Real;
use crate::clip::Planes;
use crate::filters::development::Columns;
use crate::parallel::Interrupt;
use crate::simd::multiversion;

/// Weight of a sample without confidence. The line between its neighbours that stands for it keeps the smoother from swinging far
/// out in a long gap, and beyond the end of the clip.
const LEAST_WEIGHT: f64 = 0.01;

/// Smooths vectors in place.
pub(super) fn smooth(
    columns: &mut Columns<'_>,
    noise: f64,
    candidates: &Candidates,
    spare: &mut Planes<f64>,
    interrupt: &Interrupt,
) -> Result<(), Error> {
    let frames = columns.frames;
    let axes = axes::of_steps(columns.mean.map(|mean| &mean[..frames]));
    spare.reshape(7 + HIGHEST + 3, columns.vectors[0].len());
    let [z, variances, softness, solution, pivots, a, b, c, results @ ..] = spare.rows_mut::<11>(0);
    variances.fill(1.0);
    if let Some(trust) = columns.trust {
        inverses(trust, LEAST_WEIGHT, variances);
    }
    let mut memory = Memory { solution, pivots, lower: [a, b, c] };
    let mut choice = candidates.memory();
    let mut results = results;
    for result in &mut results {
        result.fill(0.0);
    }
    for direction in axes {
        let vectors = columns.vectors.each_ref().map(|plane| &**plane);
        project(vectors, direction.map(|x| x / noise), z);
        let order = candidates.choose(&z[..frames], softness, &mut choice);
        if frames > order {
            let softness = &softness[..frames - order];
            penalised(order, &mut z[..frames], &variances[..frames], softness, &mut memory, interrupt)?;
        }
        for (result, x) in results.iter_mut().zip(direction) {
            add_scaled(z, x * noise, result);
        }
    }
    for (vector, result) in columns.vectors.iter_mut().zip(&results) {
        vector[..frames].copy_from_slice(&result[..frames]);
    }
    Ok(())
}

multiversion! {
    /// One over the weights, which are at least `least`.
    fn inverses<T: Real>(weights: &[T], least: T, out: &mut [T]) {
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
    fn add_scaled<T: Real>(values: &[T], scale: T, sums: &mut [T]) {
        let n = sums.len();
        let values = &values[..n];
        for i in 0..n {
            sums[i] += scale * values[i];
        }
    }
}
