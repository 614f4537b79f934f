//! Descent to the direction of a geodesic that is nearer than all around it.
//!
//! Newton's method on the sphere of directions, each step made to descend: curvatures count by their size, and a step that
//! does not lower the objective is halved. A direction on which samples lie, a cone point, is a minimum if the other samples
//! pull less than those on it hold; the descent leaves it along the pull otherwise.

use super::objective::{Objective, Slope, basis, scaled_to_one, slope, value};
use super::samples::{Samples, cross, dot};
use crate::parallel::Interrupt;
use crate::{Error, Real};

/// Newton steps at most; a handful is enough unless samples lie very near the geodesic, but not on it.
const STEPS: usize = 100;

/// Shortenings of a step at most: what is left is below the roundings of a direction.
const HALVINGS: usize = 40;

/// Radians: a step that ends the descent.
const SHORTEST: f64 = 1e-13;

/// Radians: a longer step has left the neighbourhood that the curvature speaks of.
const LONGEST: f64 = 0.5;

/// Of the greater curvature: a smaller one says nothing.
const LEAST_CURVATURE: f64 = 1e-8;

/// Relative: a difference of objectives that roundings make.
const ROUNDINGS: f64 = 64.0 * f64::EPSILON;

/// Steps: how far the direction of a sample may lie to be tried itself.
const ONTO_SAMPLE: f64 = 4.0;

/// A direction, and the objectives on the way to it, which never rise.
#[derive(Debug, Clone)]
pub(super) struct Found {
    pub(super) direction: [f64; 3],
    pub(super) descent: Vec<f64>,
}

impl Found {
    /// The objective at the direction.
    pub(super) fn value(&self) -> f64 {
        self.descent.last().copied().unwrap_or(f64::INFINITY)
    }
}

/// Descends from a direction to a minimum near it.
pub(super) fn descent(
    samples: &Samples,
    start: [f64; 3],
    objective: Objective,
    interrupt: &Interrupt,
) -> Result<Found, Error> {
    let mut v = start;
    let mut across = basis(v);
    let mut here = slope(samples, v, across, objective, interrupt)?;
    let mut values = vec![here.value];
    for _ in 0..STEPS {
        let mut step = newton_step(&here);
        let length = size(step);
        // A length that is not a number ends it too.
        if length.is_nan() || length < SHORTEST {
            break;
        }
        let mut moved = None;
        if let (Objective::Geodesic, Some(nearest)) = (objective, here.nearest) {
            let onto = onto_sample(samples, v, nearest, here.value, ONTO_SAMPLE * length, interrupt)?;
            if let Some(direction) = onto {
                let across = basis(direction);
                moved = Some((direction, across, slope(samples, direction, across, objective, interrupt)?));
            }
        }
        for _ in 0..HALVINGS {
            if moved.is_some() {
                break;
            }
            let trial = moved(v, [0, 1, 2].map(|i| step[0] * across[0][i] + step[1] * across[1][i]));
            let trial_across = basis(trial);
            let there = slope(samples, trial, trial_across, objective, interrupt)?;
            let lower = there.value < here.value;
            let level = there.value <= here.value * (1.0 + ROUNDINGS);
            if lower || (level && size(there.gradient) < size(here.gradient) / 2.0) {
                moved = Some((trial, trial_across, there));
            }
            step = step.map(|x| x / 2.0);
        }
        let Some(next) = moved else { break };
        let before = values.last().copied().unwrap_or(f64::INFINITY);
        (v, across, here) = next;
        values.push(here.value.min(before));
    }
    Ok(Found { direction: v, descent: values })
}

fn size(step: [f64; 2]) -> f64 {
    (step[0] * step[0] + step[1] * step[1]).sqrt()
}

/// Step that descends; 0 at a minimum, which a cone point is if the gradient of the others is no steeper.
fn newton_step(here: &Slope) -> [f64; 2] {
    let [a, b, c] = here.hessian;
    let steepness = size(here.gradient);
    if steepness <= here.cone {
        return [0.0; 2];
    }
    // Away from a cone point only the steepest way is sure to lead downhill.
    let along = if here.cone > 0.0 {
        let direction = here.gradient.map(|x| x / steepness);
        [direction, [0.0; 2]]
    } else {
        let spread = ((a - c) * (a - c) + 4.0 * b * b).sqrt();
        // The eigenvector for the greater eigenvalue, from the column with the greater entries.
        let main = if a >= c { [a - c + spread, 2.0 * b] } else { [2.0 * b, c - a + spread] };
        let length = size(main);
        let main = if length > 0.0 { main.map(|x| x / length) } else { [1.0, 0.0] };
        [main, [-main[1], main[0]]]
    };
    let curvature = |e: [f64; 2]| (a * e[0] * e[0] + 2.0 * b * e[0] * e[1] + c * e[1] * e[1]).abs();
    let curvatures = along.map(curvature);
    let least = LEAST_CURVATURE * curvatures[0].max(curvatures[1]) + f64::MIN_POSITIVE;
    let mut step = [0.0; 2];
    for (e, curvature) in along.iter().zip(curvatures) {
        let pull = (e[0] * here.gradient[0] + e[1] * here.gradient[1]) / curvature.max(least);
        step[0] -= e[0] * pull;
        step[1] -= e[1] * pull;
    }
    let step = step.map(|x| x * (1.0 - here.cone / steepness));
    let shortened = (LONGEST / size(step)).min(1.0);
    step.map(|x| x * shortened)
}

/// Direction of the nearest sample, if it lies within `reach` radians and is better.
fn onto_sample(
    samples: &Samples,
    v: [f64; 3],
    nearest: usize,
    before: f64,
    reach: f64,
    interrupt: &Interrupt,
) -> Result<Option<[f64; 3]>, Error> {
    let [_, x, y, z] = samples.at(nearest);
    let direction = scaled_to_one([x, y, z]);
    let across = cross(direction, v);
    let away = dot(across, across).sqrt();
    let better =
        away > 0.0 && away < reach && value(samples, direction, Objective::Geodesic, interrupt)? < before;
    Ok(better.then_some(direction))
}

/// Unit vector `v` moved along the sphere by a vector across it.
fn moved(v: [f64; 3], step: [f64; 3]) -> [f64; 3] {
    let angle = dot(step, step).sqrt();
    let (sine, cosine) = Real::sin_cos(angle);
    let factor = if angle > 0.0 { sine / angle } else { 1.0 };
    scaled_to_one(std::array::from_fn(|i| cosine * v[i] + factor * step[i]))
}
