//! Inputs of the local model from control points: residuals of the fitted examples and positions of their roots after
//! the fit.

use super::State;
use super::observations::Observations;
use super::poses::Poses;
use super::search::Example;
use crate::Real;
use crate::reconstruction::frame::HORIZONTAL;
use crate::reconstruction::kinematics::ROOT;
use std::f64::consts::TAU;

/// Inputs and root outputs of the local model.
#[derive(Debug, Default)]
pub(super) struct Signals {
    /// `(examples, count)`: residuals between the control points and the fitted examples, in the frame of the last
    /// heading and in units of the scale. Their sum of squares is `order` times the control points' term of the
    /// squared distance.
    pub(super) differences: Vec<f64>,
    /// Three per observed control point and frame; 0 if the scale is infinite.
    pub(super) count: usize,
    /// `(examples, ROOT)`: root displacements after the fit; as in the database if the control points do not
    /// determine a heading.
    pub(super) root_steps: Vec<f64>,
}

impl Signals {
    /// The inputs of some examples; `points` is the number of control points.
    pub(super) fn new(
        poses: &Poses<'_>,
        (points, up): (usize, usize),
        found: &[Example],
        observations: &Observations,
        (state, order): (&State, usize),
        scale: f64,
    ) -> Self {
        let mut signals = Self::default();
        if scale.is_finite() {
            signals.count = 3 * observations.count();
        }
        let aligned = signals.count > 0 && observations.determines_heading(scale);
        let factor = (order as f64).sqrt() / scale;
        let [first, second] = HORIZONTAL[up];
        let (sine, cosine) = Real::sin_cos(state.heading % TAU);
        for example in found.iter().map(|found| found.pose) {
            if signals.count > 0 {
                let fit = observations.fit(poses, points, example, up);
                for ([x, y, above], share) in observations.residuals(poses, points, (example, &fit), up) {
                    let factor = factor * share.sqrt();
                    let left = [cosine * x + sine * y, cosine * y - sine * x, above];
                    signals.differences.extend(left.map(|left| factor * left));
                }
                if aligned {
                    let root = poses.place(example);
                    let [x, y] = observations.moved(&fit, [root[first], root[second]]);
                    let (x, y) = (x - state.place[first], y - state.place[second]);
                    let turn =
                        f64::from(poses.heading[example]) + observations.transform(&fit).0 - state.heading;
                    let turn = turn - TAU * (turn / TAU).round_ties_even();
                    let way = [cosine * x + sine * y, cosine * y - sine * x, root[up], turn];
                    signals.root_steps.extend(way);
                }
            }
            if !aligned {
                signals.root_steps.extend(poses.root_step(example, up));
            }
        }
        debug_assert_eq!(signals.root_steps.len(), found.len() * ROOT);
        signals
    }
}
