//! Descent on the sphere of directions: limited-memory BFGS along great circles (Huang, Gallivan and Absil 2015).

use super::objective::{Slope, remove_along, slope};
use super::poses::{Lane, Poses};
use crate::Error;
use crate::geodesics::pga::Objective;
use crate::parallel::Interrupt;
use crate::rotations::quaternion::{is_missing, log_one};
use std::collections::VecDeque;

/// Largest number of steps; whole bodies take 15 to 40 from the tangent axis.
pub(super) const STEPS: usize = 200;

/// Number of pairs of steps and gradient changes that approximate the curvature.
const MEMORY: usize = 20;

/// Largest number of times that a step is shortened.
const HALVINGS: usize = 30;

/// Step length, radians on the sphere of directions, at which the descent ends.
const SHORTEST: f64 = 1e-12;

/// Longest step, radians: farther away the curvature is not valid.
const LONGEST: f64 = 0.5;

/// First step, radians, before any curvature is known.
const FIRST_STEP: f64 = 0.05;

/// Fraction of the decrease predicted by the slope that a step must reach (Armijo).
const DECREASE: f64 = 1e-4;

/// Relative difference of objectives attributed to rounding; a step within it is accepted if it halves the gradient.
const ROUNDINGS: f64 = 16.0 * f64::EPSILON;

/// A direction, and the objectives at the steps that led to it.
#[derive(Debug, Clone)]
pub(super) struct Found {
    pub(super) direction: Vec<f64>,
    pub(super) descent: Vec<f64>,
}

/// A step, and the change of the gradient.
struct Pair {
    step: Vec<f64>,
    change: Vec<f64>,
    product: f64,
}

/// The objective function of the descent.
#[derive(Clone, Copy)]
pub(super) struct Ground<'a> {
    pub(super) poses: &'a Poses,
    /// The joints that move.
    pub(super) which: &'a [usize],
    pub(super) objective: Objective,
    pub(super) interrupt: &'a Interrupt,
}

impl Ground<'_> {
    /// The objective at a direction; `s` holds the start values for the nearest points.
    pub(super) fn slope(&self, v: &[f64], s: &mut [Lane]) -> Result<Slope, Error> {
        slope(self.poses, v, self.which, self.objective, s, self.interrupt)
    }

    /// Zero parameters for all poses.
    pub(super) fn at_one(&self) -> Vec<Lane> {
        vec![Lane::ZERO; self.poses.tiles.len()]
    }

    /// Descends from a direction to a local minimum; the objective never increases.
    ///
    /// The mean distance may have its minimum at a cone point, the direction of a pose. Then the descent ends near
    /// it, and finally steps onto it if the objective is lower there.
    pub(super) fn descent(&self, start: &[f64], steps: usize) -> Result<Found, Error> {
        let (mut found, nearest) = self.descent_off_poses(start, steps)?;
        let low = found.descent.last().copied().unwrap_or(f64::INFINITY);
        if let (Objective::Geodesic, Some(pose)) = (self.objective, nearest) {
            let direction = self.pose_direction(pose);
            let there = self.slope(&direction, &mut self.at_one())?;
            if there.value < low {
                found.direction = direction;
                found.descent.push(there.value);
            }
        }
        Ok(found)
    }

    /// Descends as if the objective were smooth.
    fn descent_off_poses(&self, start: &[f64], steps: usize) -> Result<(Found, Option<usize>), Error> {
        let mut s = self.at_one();
        let mut v = start.to_vec();
        let mut here = self.slope(&v, &mut s)?;
        let mut descent = vec![here.value];
        let mut low = here.value;
        let mut pairs: VecDeque<Pair> = VecDeque::with_capacity(MEMORY);
        for _ in 0..steps {
            let mut step = newton_like(&here.gradient, &pairs, &v);
            if product(&step, &here.gradient) >= 0.0 {
                pairs.clear();
                step = newton_like(&here.gradient, &pairs, &v);
            }
            let length = norm(&step);
            scale(&mut step, if length > LONGEST { LONGEST / length } else { 1.0 });
            let Some((share, trial, there)) = self.search(&v, &here, &step, &mut s)? else { break };
            scale(&mut step, share);
            let change: Vec<f64> = there.gradient.iter().zip(&here.gradient).map(|(a, b)| a - b).collect();
            pairs.push_back(Pair { step, change, product: 0.0 });
            for pair in &mut pairs {
                remove_along(&mut pair.step, &trial);
                remove_along(&mut pair.change, &trial);
                pair.product = product(&pair.step, &pair.change);
            }
            pairs.retain(|pair| pair.product > 0.0);
            if pairs.len() > MEMORY {
                pairs.pop_front();
            }
            v = trial;
            here = there;
            low = here.value.min(low);
            descent.push(low);
        }
        Ok((Found { direction: v, descent }, here.nearest))
    }

    /// The fraction of a step that lowers the objective enough, the direction that it leads to, and the objective
    /// there.
    fn search(
        &self,
        v: &[f64],
        here: &Slope,
        step: &[f64],
        s: &mut [Lane],
    ) -> Result<Option<(f64, Vec<f64>, Slope)>, Error> {
        let promised = product(step, &here.gradient);
        let (length, steep) = (norm(step), norm(&here.gradient));
        let mut share = 1.0;
        for _ in 0..HALVINGS {
            if length.is_nan() || length * share < SHORTEST {
                break;
            }
            let trial = moved_along(v, step, share, length);
            let there = self.slope(&trial, s)?;
            let enough = there.value <= here.value + DECREASE * share * promised;
            let level = there.value <= here.value * (1.0 + ROUNDINGS);
            if enough || (level && norm(&there.gradient) < steep / 2.0) {
                return Ok(Some((share, trial, there)));
            }
            // The minimum of the parabola through both values and the slope, limited to its range of validity.
            let excess = 2.0 * (there.value - here.value - share * promised);
            let parabola = if excess > 0.0 { -promised * share * share / excess } else { share / 2.0 };
            share = parabola.max(share / 10.0).min(share / 2.0);
        }
        Ok(None)
    }

    /// Direction of a pose.
    fn pose_direction(&self, pose: usize) -> Vec<f64> {
        let mut v = Vec::with_capacity(self.which.len() * 3);
        for &joint in self.which {
            let x = self.poses.at(pose, joint);
            v.extend(if is_missing(x) { [0.0; 3] } else { log_one(x) });
        }
        let length = norm(&v);
        scale(&mut v, 1.0 / length);
        v
    }
}

/// Quasi-Newton step with the curvature of the pairs (Nocedal's two-loop recursion).
fn newton_like(gradient: &[f64], pairs: &VecDeque<Pair>, v: &[f64]) -> Vec<f64> {
    let mut step: Vec<f64> = gradient.iter().map(|x| -x).collect();
    let mut shares = Vec::with_capacity(pairs.len());
    for pair in pairs.iter().rev() {
        let share = product(&pair.step, &step) / pair.product;
        shares.push(share);
        add(&mut step, -share, &pair.change);
    }
    if let Some(pair) = pairs.back() {
        scale(&mut step, pair.product / product(&pair.change, &pair.change));
    } else {
        let length = norm(gradient);
        scale(&mut step, if length > 0.0 { FIRST_STEP / length } else { 0.0 });
    }
    for (pair, share) in pairs.iter().zip(shares.iter().rev()) {
        let back = product(&pair.change, &step) / pair.product;
        add(&mut step, share - back, &pair.step);
    }
    remove_along(&mut step, v);
    step
}

/// Moves the unit vector `v` along the sphere by a fraction of an orthogonal vector of the given length.
fn moved_along(v: &[f64], step: &[f64], share: f64, length: f64) -> Vec<f64> {
    let (sin, cos) = crate::Real::sin_cos(length * share);
    let along = if length > 0.0 { sin / length } else { 0.0 };
    let mut moved: Vec<f64> = v.iter().zip(step).map(|(v, step)| cos * v + along * step).collect();
    let length = norm(&moved);
    scale(&mut moved, 1.0 / length);
    moved
}

fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

pub(super) fn norm(a: &[f64]) -> f64 {
    product(a, a).sqrt()
}

fn scale(a: &mut [f64], by: f64) {
    for x in a {
        *x *= by;
    }
}

fn add(a: &mut [f64], share: f64, b: &[f64]) {
    for (x, y) in a.iter_mut().zip(b) {
        *x += share * y;
    }
}
