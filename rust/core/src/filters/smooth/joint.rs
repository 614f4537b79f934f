//! Smoothing of one joint, or of a translation, along its principal axes.

use super::axes;
use super::penalised::{HIGHEST, Memory, penalised};
use super::strength::{self, Candidates};
use crate::Error;
use crate::Real;
use crate::clip::Planes;
use crate::filters::development::Columns;
use crate::parallel::Interrupt;
use crate::simd::multiversion;

/// Weight of a sample without confidence. The line between its neighbours that stands for it keeps the smoother from swinging far
/// out in a long gap, and beyond the end of the clip.
pub(super) const LEAST_WEIGHT: f64 = 0.01;

/// Planes that a column needs beside itself: its softness, and the memory of the solver.
const PER_COLUMN: usize = 3 + HIGHEST;

/// Smooths vectors in place.
pub(super) fn smooth(
    columns: &mut Columns<'_>,
    noise: f64,
    candidates: &Candidates,
    spare: &mut Planes<f64>,
    interrupt: &Interrupt,
) -> Result<(), Error> {
    let frames = columns.frames;
    let axes = axes::of_steps(columns.mean.map(|mean| &mean[..frames]), interrupt)?;
    spare.reshape(5 + PER_COLUMN, columns.vectors[0].len());
    let [z, variances, a, b, c, solver @ ..] = spare.rows_mut::<{ 5 + PER_COLUMN }>(0);
    variances.fill(1.0);
    if let Some(trust) = columns.trust {
        inverses(trust, LEAST_WEIGHT, variances);
    }
    let mut results = [a, b, c];
    for result in &mut results {
        result.fill(0.0);
    }
    let mut solver = Solver::new(solver, candidates);
    for direction in axes {
        let vectors = columns.vectors.each_ref().map(|plane| &**plane);
        project(vectors, direction.map(|x| x / noise), z);
        solver.smooth(&mut z[..frames], &variances[..frames], candidates, interrupt)?;
        for (result, x) in results.iter_mut().zip(direction) {
            add_scaled(z, x * noise, result);
        }
    }
    for (vector, result) in columns.vectors.iter_mut().zip(&results) {
        vector[..frames].copy_from_slice(&result[..frames]);
    }
    Ok(())
}

/// Smooths a column of unit noise in place.
pub(super) fn smooth_column(
    column: &mut [f64],
    candidates: &Candidates,
    spare: &mut Planes<f64>,
    interrupt: &Interrupt,
) -> Result<(), Error> {
    spare.reshape(1 + PER_COLUMN, column.len());
    let [variances, solver @ ..] = spare.rows_mut::<{ 1 + PER_COLUMN }>(0);
    variances.fill(1.0);
    Solver::new(solver, candidates).smooth(column, variances, candidates, interrupt)
}

/// Memory for the way from a column of unit noise to a smooth one.
struct Solver<'a> {
    softness: &'a mut [f64],
    memory: Memory<'a>,
    choice: strength::Memory,
}

impl<'a> Solver<'a> {
    fn new(planes: [&'a mut [f64]; PER_COLUMN], candidates: &Candidates) -> Self {
        let [softness, solution, pivots, lower @ ..] = planes;
        Self { softness, memory: Memory { solution, pivots, lower }, choice: candidates.memory() }
    }

    fn smooth(
        &mut self,
        z: &mut [f64],
        variances: &[f64],
        candidates: &Candidates,
        interrupt: &Interrupt,
    ) -> Result<(), Error> {
        let order = candidates.choose(z, self.softness, &mut self.choice);
        if z.len() <= order {
            return Ok(());
        }
        let softness = &self.softness[..z.len() - order];
        penalised(order, z, variances, softness, &mut self.memory, interrupt)
    }
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
    pub(super) fn add_scaled<T: Real>(values: &[T], factor: T, sums: &mut [T]) {
        let n = sums.len();
        let values = &values[..n];
        for i in 0..n {
            sums[i] += factor * values[i];
        }
    }
}
