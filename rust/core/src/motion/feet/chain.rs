//! A leg as a chain of three bones, with its fixed transforms.

use super::{Point, add};
use crate::rotations::quaternion::{product, rotate};

/// Joints of a leg.
#[derive(Debug, Clone, Copy)]
pub(super) struct Joints {
    pub(super) hip: usize,
    pub(super) knee: usize,
    pub(super) ankle: usize,
    /// The ankle if the leg has no toe.
    pub(super) toe: usize,
}

/// One pose: rotations relative to the parents, and positions in the parents' frames.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pose<'a, T> {
    pub(super) parents: &'a [Option<usize>],
    pub(super) rotations: &'a [T],
    pub(super) local: &'a [T],
}

impl<T: crate::Real> Pose<'_, T> {
    pub(super) fn rotation(&self, joint: usize) -> [f64; 4] {
        std::array::from_fn(|c| self.rotations[joint * 4 + c].to_f64())
    }

    fn position(&self, joint: usize) -> Point {
        std::array::from_fn(|c| self.local[joint * 3 + c].to_f64())
    }

    /// The rotation from the frame of `above` to that of the parent of `below`, and the position of `below` in the
    /// frame of `above`.
    pub(super) fn between(&self, above: usize, below: usize) -> ([f64; 4], Point) {
        let (mut rotation, mut position) = ([1.0, 0.0, 0.0, 0.0], self.position(below));
        let mut joint = self.parents[below];
        while let Some(here) = joint.filter(|&joint| joint != above) {
            let q = self.rotation(here);
            rotation = product(q, rotation);
            position = add(self.position(here), rotate(q, position));
            joint = self.parents[here];
        }
        (rotation, position)
    }
}

/// A leg of a pose.
#[derive(Debug, Clone, Copy)]
pub(super) struct Chain {
    /// Rotation from the pelvis frame to that of the hip's parent; the next ones accordingly.
    to_hip: [f64; 4],
    to_knee: [f64; 4],
    pub(super) to_ankle: [f64; 4],
    /// Positions of the hip in the pelvis frame, the knee in the hip's, the ankle in the knee's, and the toe in the
    /// ankle's frame.
    hip_at: Point,
    knee_at: Point,
    ankle_at: Point,
    pub(super) toe_at: Point,
    /// Rotations of the joints relative to their parents.
    pub(super) hip: [f64; 4],
    pub(super) knee: [f64; 4],
    pub(super) ankle: [f64; 4],
    /// Axis of the knee in the shank frame.
    pub(super) hinge: Point,
}

/// Positions and orientations of a leg in the world.
#[derive(Debug, Clone, Copy)]
pub(super) struct Places {
    pub(super) hip: Point,
    pub(super) knee: Point,
    pub(super) ankle: Point,
    /// Orientation of the hip.
    pub(super) thigh: [f64; 4],
    /// Orientation of the knee.
    pub(super) shank: [f64; 4],
}

impl Chain {
    pub(super) fn of<T: crate::Real>(pose: Pose<'_, T>, pelvis: usize, leg: Joints, hinge: Point) -> Self {
        let (to_hip, hip_at) = pose.between(pelvis, leg.hip);
        let (to_knee, knee_at) = pose.between(leg.hip, leg.knee);
        let (to_ankle, ankle_at) = pose.between(leg.knee, leg.ankle);
        let toe_at = if leg.toe == leg.ankle { [0.0; 3] } else { pose.between(leg.ankle, leg.toe).1 };
        let [hip, knee, ankle] = [leg.hip, leg.knee, leg.ankle].map(|joint| pose.rotation(joint));
        Self { to_hip, to_knee, to_ankle, hip_at, knee_at, ankle_at, toe_at, hip, knee, ankle, hinge }
    }

    pub(super) fn is_known(&self) -> bool {
        let rotations = [self.to_hip, self.to_knee, self.to_ankle, self.hip, self.knee, self.ankle];
        let positions = [self.hip_at, self.knee_at, self.ankle_at, self.toe_at];
        rotations.as_flattened().iter().chain(positions.as_flattened()).all(|x| x.is_finite())
    }

    /// Positions and orientations of the leg, given orientation and position of the pelvis.
    pub(super) fn places(&self, turned: [f64; 4], shifted: Point) -> Places {
        let hip = add(shifted, rotate(turned, self.hip_at));
        let thigh = product(product(turned, self.to_hip), self.hip);
        let knee = add(hip, rotate(thigh, self.knee_at));
        let shank = product(product(thigh, self.to_knee), self.knee);
        let ankle = add(knee, rotate(shank, self.ankle_at));
        Places { hip, knee, ankle, thigh, shank }
    }
}
