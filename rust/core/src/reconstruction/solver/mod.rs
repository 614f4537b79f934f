//! The most probable pose given the control points and a Gaussian prior, by the Levenberg–Marquardt method.

mod dense;
mod prior;
mod targets;

pub use prior::Prior;
pub use targets::Targets;

use super::kinematics::{Base, Body};
use crate::Error;
use crate::error::check_length;
use targets::Errors;

/// First damping λ after a Gauss–Newton step that does not lower the energy.
const FIRST_DAMPING: f64 = 0.1;

/// Factor by which the damping grows after a failed step and shrinks after a successful one.
const DAMPING_FACTOR: f64 = 8.0;

/// Damping below which steps are undamped Gauss–Newton steps.
const WEAKEST_DAMPING: f64 = 1e-3;

/// Damping at which the solver stops: if steps a billion times shorter do not lower the energy, rounding errors
/// dominate.
const STRONGEST_DAMPING: f64 = 1e9;

/// Relative decrease of the energy at which the solver stops: the remaining decrease, a fraction of it, moves no
/// joint visibly. A smaller value would be comparable to the energy's rounding errors.
const SETTLED: f64 = 1e-9;

/// The energy of a solution, and the number of steps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solution {
    /// Half the squared errors of the observed control points, in standard deviations.
    pub likelihood: f64,
    /// Half the squared distance from the prior mean, in standard deviations.
    pub prior: f64,
    /// Number of steps that lowered the energy.
    pub steps: usize,
}

/// Computes poses of one body; keeps its scratch memory between them.
#[derive(Debug, Clone)]
pub struct Solver {
    body: Body,
    /// The coordinates that move control points.
    columns: Vec<usize>,
    here: Errors,
    there: Errors,
    /// Jacobian of the errors along the prior's axes: `(errors, axes)`.
    along: Vec<f64>,
    matrix: Vec<f64>,
    dual: Vec<f64>,
}

impl Solver {
    /// A solver for the control points of `body`.
    #[must_use]
    pub fn new(body: Body) -> Self {
        let errors = Errors::new(&body);
        Self {
            columns: body.columns(),
            here: errors.clone(),
            there: errors,
            along: Vec::new(),
            matrix: Vec::new(),
            dual: Vec::new(),
            body,
        }
    }

    /// The skeleton and its control points.
    #[must_use]
    pub fn body(&self) -> &Body {
        &self.body
    }

    /// The energy of the coordinates `x`.
    ///
    /// # Errors
    /// As [`Solver::solve`].
    pub fn energy(
        &mut self,
        base: &Base,
        prior: &Prior<'_>,
        targets: &Targets<'_>,
        x: &[f64],
    ) -> Result<f64, Error> {
        self.check(base, prior, targets, x)?;
        self.here.at(&self.body, base, targets, x);
        Ok(self.here.energy() + expected(prior, x, &prior.force(x)))
    }

    /// Moves the coordinates `x` to the least energy `‖r(x)‖²/2 + (x − μ)ᵀ C⁻¹ (x − μ)/2`.
    ///
    /// `r` are the errors of the control points in standard deviations. There are few errors and many coordinates, so
    /// each step is solved in the space of the errors. With their Jacobian `A`, the Gauss–Newton step leads to `x' =
    /// μ + C Aᵀ y` with `(A C Aᵀ + 1) y = A (x − μ) − r`. Damping by `λ` adds `λ (x' − x)ᵀ C⁻¹ (x' − x)/2`, which
    /// amounts to a prior with the mean `(μ + λx)/(1 + λ)` and the covariance `C/(1 + λ)`. A step that does not lower
    /// the energy is rejected; at most `most` steps are tried.
    ///
    /// # Errors
    /// [`Error::Length`] if the lengths of slices do not agree; [`Error::Parameter`] if a deviation of the prior is
    /// not above 0.
    pub fn solve(
        &mut self,
        base: &Base,
        prior: &Prior<'_>,
        targets: &Targets<'_>,
        x: &mut Vec<f64>,
        most: usize,
    ) -> Result<Solution, Error> {
        self.check(base, prior, targets, x)?;
        let mut force = prior.force(x);
        self.here.at(&self.body, base, targets, x);
        let mut energy = self.here.energy() + expected(prior, x, &force);
        let (mut damping, mut steps) = (0.0, 0);
        let (mut trial, mut trial_force) = (x.clone(), force.clone());
        for _ in 0..most {
            let fell = self.step(prior, damping, (x, &force), (&mut trial, &mut trial_force)) && {
                self.there.at(&self.body, base, targets, &trial);
                let reached = self.there.energy() + expected(prior, &trial, &trial_force);
                let fall = energy - reached;
                if fall > 0.0 {
                    std::mem::swap(&mut self.here, &mut self.there);
                    std::mem::swap(x, &mut trial);
                    std::mem::swap(&mut force, &mut trial_force);
                    steps += 1;
                    if fall <= SETTLED * energy {
                        break;
                    }
                    energy = reached;
                }
                fall > 0.0
            };
            if !fell {
                damping = FIRST_DAMPING.max(damping * DAMPING_FACTOR);
                if damping > STRONGEST_DAMPING {
                    break;
                }
            } else if damping > WEAKEST_DAMPING {
                damping /= DAMPING_FACTOR;
            } else {
                damping = 0.0;
            }
        }
        Ok(Solution { likelihood: self.here.energy(), prior: expected(prior, x, &force), steps })
    }

    fn check(&self, base: &Base, prior: &Prior<'_>, targets: &Targets<'_>, x: &[f64]) -> Result<(), Error> {
        check_length("centres", 4 * self.body.joints(), base.centres.len())?;
        check_length("start", self.body.coordinates(), x.len())?;
        prior.check(self.body.coordinates())?;
        targets.check(self.body.points())
    }

    /// Writes the end of a damped step; false if the system cannot be solved.
    fn step(
        &mut self,
        prior: &Prior<'_>,
        damping: f64,
        (x, force): (&[f64], &[f64]),
        (trial, trial_force): (&mut [f64], &mut [f64]),
    ) -> bool {
        let (n, columns, axes) = (self.here.values.len(), self.here.columns(), prior.count());
        // Damped prior: mean (μ + λx)/(1 + λ), covariance C/(1 + λ).
        let (share, kept) = (1.0 / (1.0 + damping), damping / (1.0 + damping));
        for d in 0..x.len() {
            trial[d] = prior.mean[d] + kept * (x[d] - prior.mean[d]);
            trial_force[d] = kept * force[d];
        }
        if n == 0 {
            return true;
        }
        // The system (A C Aᵀ + 1) y = A (x − μ) − r.
        self.along.clear();
        self.along.resize(n * axes, 0.0);
        self.dual.clear();
        self.matrix.resize(n * n, 0.0);
        let mut spread = vec![0.0; columns];
        for (i, row) in self.here.rows.chunks_exact(columns).enumerate() {
            let mut moved = 0.0;
            let along = &mut self.along[i * axes..(i + 1) * axes];
            for ((&a, &d), spread) in row.iter().zip(&self.columns).zip(&mut spread) {
                moved += a * (x[d] - trial[d]);
                *spread = a * (prior.deviation[d] * prior.deviation[d]);
                if a != 0.0 {
                    for (sum, &axis) in along.iter_mut().zip(prior.axes_of(d)) {
                        *sum += a * axis;
                    }
                }
            }
            self.dual.push(moved - self.here.values[i]);
            for (j, other) in self.here.rows.chunks_exact(columns).enumerate().take(i + 1) {
                let (a, b) = (&self.along[i * axes..(i + 1) * axes], &self.along[j * axes..(j + 1) * axes]);
                let one = if i == j { 1.0 } else { 0.0 };
                self.matrix[i * n + j] = one + share * (dense::dot(&spread, other) + dense::dot(a, b));
            }
        }
        if !dense::factor(&mut self.matrix, n) {
            return false;
        }
        dense::solve(&self.matrix, n, &mut self.dual);
        // The step x' = μ + C Aᵀ y.
        let mut pull = vec![0.0; columns];
        let mut pull_along = vec![0.0; axes];
        for (i, row) in self.here.rows.chunks_exact(columns).enumerate() {
            let weight = share * self.dual[i];
            for (sum, &a) in pull.iter_mut().zip(row) {
                *sum += weight * a;
            }
            for (sum, &a) in pull_along.iter_mut().zip(&self.along[i * axes..]) {
                *sum += weight * a;
            }
        }
        for (&d, &pull) in self.columns.iter().zip(&pull) {
            trial[d] += prior.deviation[d] * prior.deviation[d] * pull;
            trial_force[d] += pull;
        }
        if axes > 0 {
            for (d, value) in trial.iter_mut().enumerate() {
                *value += dense::dot(prior.axes_of(d), &pull_along);
            }
        }
        true
    }
}

/// The energy of the prior, `(x − μ)ᵀ f / 2` with `f = C⁻¹ (x − μ)`.
fn expected(prior: &Prior<'_>, x: &[f64], force: &[f64]) -> f64 {
    0.5 * x.iter().zip(prior.mean).zip(force).map(|((x, mean), force)| (x - mean) * force).sum::<f64>()
}
