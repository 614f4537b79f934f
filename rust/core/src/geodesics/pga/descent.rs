//! Descent to a local minimum of a geodesic's direction.
//!
//! Newton's method on the sphere of directions, modified to descend: curvatures enter by their absolute value, and a
//! step that does not lower the objective is halved. A direction on which samples lie is a cone point. It is a
//! minimum if the gradient of the other samples is smaller than the slope of those on it; otherwise the descent
//! leaves it along the gradient.

use super::objective::{Objective, Slope, basis, scaled_to_one, slope, value};
use super::samples::{Samples, cross, dot};
use crate::parallel::Interrupt;
use crate::{Error, Real};

/// Largest number of Newton steps; a few suffice unless samples lie very near the geodesic but not on it.
const STEPS: usize = 100;

/// Largest number of halvings of a step: after them it is below the rounding error of a direction.
const HALVINGS: usize = 40;

/// Step length, radians, at which the descent ends.
const SHORTEST: f64 = 1e-13;

/// Longest step, radians: farther away the curvature is not valid.
const LONGEST: f64 = 0.5;

/// Smallest curvature, relative to the larger one: smaller ones carry no information.
const LEAST_CURVATURE: f64 = 1e-8;

/// Relative difference of objectives attributed to rounding.
const ROUNDINGS: f64 = 64.0 * f64::EPSILON;

/// In steps: a sample whose direction is nearer is tried itself.
const ONTO_SAMPLE: f64 = 4.0;

/// A direction, and the objectives at the steps that led to it, which never increase.
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

/// Descends from a direction to a local minimum.
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
        // A NaN length ends it too.
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
            let trial = moved_along(v, [0, 1, 2].map(|i| step[0] * across[0][i] + step[1] * across[1][i]));
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

/// A descent step; 0 at a minimum. A cone point is a minimum if the gradient of the other samples is not steeper.
fn newton_step(here: &Slope) -> [f64; 2] {
    let [a, b, c] = here.hessian;
    let steepness = size(here.gradient);
    if steepness <= here.cone {
        return [0.0; 2];
    }
    // From a cone point only the steepest direction is sure to descend.
    let along = if here.cone > 0.0 {
        let direction = here.gradient.map(|x| x / steepness);
        [direction, [0.0; 2]]
    } else {
        let spread = ((a - c) * (a - c) + 4.0 * b * b).sqrt();
        // The eigenvector of the larger eigenvalue, from the column with the larger entries.
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

/// Direction of the nearest sample, if it is within `reach` radians and has a lower objective.
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

/// Moves the unit vector `v` along the sphere by an orthogonal vector.
fn moved_along(v: [f64; 3], step: [f64; 3]) -> [f64; 3] {
    let angle = dot(step, step).sqrt();
    let (sine, cosine) = Real::sin_cos(angle);
    let factor = if angle > 0.0 { sine / angle } else { 1.0 };
    scaled_to_one(std::array::from_fn(|i| cosine * v[i] + factor * step[i]))
}
