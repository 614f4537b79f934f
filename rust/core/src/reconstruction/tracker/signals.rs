//! What control points tell a local model: how far its examples are from them, and where their roots stand when laid on them.

use super::State;
use super::poses::Poses;
use super::search::Example;
use super::sight::Sight;
use crate::Real;
use crate::reconstruction::frame::HORIZONTAL;
use crate::reconstruction::kinematics::WAY;
use std::f64::consts::TAU;

/// What the control points tell.
#[derive(Debug, Default)]
pub(super) struct Signals {
    /// `(examples, count)`: what is left between the control points and the examples laid on them, as seen from the last heading, in
    /// units of the scale. Its sum of squares is `order` times what control points add to the squared distance of the example.
    pub(super) differences: Vec<f64>,
    /// Three for each control point of each frame that is seen; none with an infinite scale.
    pub(super) count: usize,
    /// `(examples, WAY)`: how the roots come there; where control points do not tell a heading, as they came in the database.
    pub(super) ways: Vec<f64>,
}

impl Signals {
    /// Those of some examples; `points` is how many control points there are.
    pub(super) fn new(
        poses: &Poses<'_>,
        (points, up): (usize, usize),
        found: &[Example],
        sight: &Sight,
        (state, order): (&State, usize),
        scale: f64,
    ) -> Self {
        let mut signals = Self::default();
        if scale.is_finite() {
            signals.count = 3 * sight.marks();
        }
        let aligned = signals.count > 0 && sight.tells_heading(scale);
        let factor = (order as f64).sqrt() / scale;
        let [first, second] = HORIZONTAL[up];
        let (sine, cosine) = Real::sin_cos(state.heading % TAU);
        for example in found.iter().map(|found| found.pose) {
            if signals.count > 0 {
                let fit = sight.fit(poses, points, example, up);
                for ([x, y, above], share) in sight.left(poses, points, (example, &fit), up) {
                    let factor = factor * share.sqrt();
                    let left = [cosine * x + sine * y, cosine * y - sine * x, above];
                    signals.differences.extend(left.map(|left| factor * left));
                }
                if aligned {
                    let root = poses.place(example);
                    let [x, y] = sight.moved(&fit, [root[first], root[second]]);
                    let (x, y) = (x - state.place[first], y - state.place[second]);
                    let turn = f64::from(poses.heading[example]) + sight.laid(&fit).0 - state.heading;
                    let turn = turn - TAU * (turn / TAU).round_ties_even();
                    let way = [cosine * x + sine * y, cosine * y - sine * x, root[up], turn];
                    signals.ways.extend(way);
                }
            }
            if !aligned {
                signals.ways.extend(poses.way(example, up));
            }
        }
        debug_assert_eq!(signals.ways.len(), found.len() * WAY);
        signals
    }
}
