//! From patch distances of the candidates to their mean.

use super::Means;
use super::kernels::{add_own, lead_to, move_from, move_in_chart, note, turn_to, weigh};
use crate::Real;
use crate::filters::nonlocal_pose_means::Reach;
use crate::filters::stream::pose::Pose;

/// Exponent of the floor of the self-weight, as in the filter of the whole clip.
const FLOOR: f64 = -80.0;

/// Sums over the candidates, as planes over the joints.
pub(super) struct Sums {
    weights: Vec<f64>,
    most: Vec<f64>,
    total: Vec<f64>,
    turn: [Vec<f64>; 3],
}

impl Sums {
    pub(super) fn new(width: usize) -> Self {
        let zeros = || vec![0.0; width];
        Self { weights: zeros(), most: zeros(), total: zeros(), turn: [zeros(), zeros(), zeros()] }
    }
}

impl Means {
    /// Sums the weights of candidates, and their displacements from the filtered frame.
    pub(super) fn sum(&mut self) {
        let Reach { ahead, after, .. } = self.reach;
        let columns = self.columns();
        let Self { frames, earlier, later, sums, local, .. } = self;
        let now = ahead + after;
        let Sums { weights, most, total, turn } = sums;
        for plane in [&mut *most, &mut *total].into_iter().chain(&mut *turn) {
            plane.fill(0.0);
        }
        let [a, b, c, d, _] = frames.ago(now);
        for (candidates, before) in [(earlier, true), (later, false)] {
            weigh(&mut candidates.exponents);
            for (lag, likeness) in (1..).zip(candidates.exponents.chunks_exact(columns)) {
                let [p, q, r, s, confidence] = frames.ago(if before { now + lag } else { now - lag });
                if let [one] = *likeness {
                    weights.fill(one);
                } else {
                    weights.copy_from_slice(likeness);
                }
                note(weights, confidence, most, total);
                if *local {
                    turn_to([a, b, c, d], [p, q, r, s], weights, turn.each_mut().map(|turn| &mut turn[..]));
                } else {
                    lead_to([a, b, c], [p, q, r], weights, turn.each_mut().map(|turn| &mut turn[..]));
                }
            }
        }
    }

    /// Writes the mean, including the frame itself with its self-weight.
    pub(super) fn mean(&mut self, out: &mut Pose) {
        let Self { frames, sums: Sums { most, total, turn, .. }, local, .. } = self;
        let [a, b, c, d, confidence] = frames.ago(self.reach.ahead + self.reach.after);
        add_own(most, Real::exp(FLOOR), confidence, total);
        let turn = turn.each_ref().map(|turn| &turn[..]);
        if *local {
            move_from([a, b, c, d], turn, total, out.rotations_mut());
        } else {
            move_in_chart([a, b, c], turn, total, out.rotations_mut());
        }
    }
}
