//! Poses as planes over the joints, and rings of the latest ones.

use crate::clip::Planes;

/// Planes are padded to a multiple of this length: one vector of float64 at the widest level. Padding joints have
/// confidence 0.
const LANE: usize = 8;

/// Length of a plane with one value per joint.
pub(super) fn width(joints: usize) -> usize {
    joints.next_multiple_of(LANE)
}

/// One value per joint as a plane; 0 for padding joints.
pub(super) fn plane(values: impl ExactSizeIterator<Item = f64>) -> Vec<f64> {
    let mut plane: Vec<f64> = Vec::with_capacity(width(values.len()));
    let padding = width(values.len()) - values.len();
    plane.extend(values);
    plane.extend(std::iter::repeat_n(0.0, padding));
    plane
}

/// One pose: unit quaternions and confidences.
#[derive(Debug)]
pub(super) struct Pose {
    planes: Planes<f64>,
    joints: usize,
}

/// The plane of confidences, after the quaternions.
const CONFIDENCE: usize = 4;

impl Pose {
    /// Identities with confidence 0.
    pub(super) fn new(joints: usize) -> Self {
        let mut planes = Planes::new(5, width(joints));
        planes.row_mut(0).fill(1.0);
        Self { planes, joints }
    }

    pub(super) fn joints(&self) -> usize {
        self.joints
    }

    /// The quaternions, as planes.
    pub(super) fn rotations(&self) -> [&[f64]; 4] {
        self.planes.rows_from::<4>(0)
    }

    /// The quaternions, as planes to be written.
    pub(super) fn rotations_mut(&mut self) -> [&mut [f64]; 4] {
        self.planes.rows_mut::<4>(0)
    }

    /// The confidences.
    pub(super) fn confidence(&self) -> &[f64] {
        self.planes.row(CONFIDENCE)
    }

    /// The quaternion of a joint.
    pub(super) fn at(&self, joint: usize) -> [f64; 4] {
        self.rotations().map(|plane| plane[joint])
    }

    /// Sets the quaternion of a joint.
    pub(super) fn set(&mut self, joint: usize, q: [f64; 4]) {
        for (plane, q) in self.rotations_mut().into_iter().zip(q) {
            plane[joint] = q;
        }
    }

    /// Sets the confidence of a joint.
    pub(super) fn set_confidence(&mut self, joint: usize, confidence: f64) {
        self.planes.row_mut(CONFIDENCE)[joint] = confidence;
    }

    /// Copies another pose.
    pub(super) fn copy_from(&mut self, other: &Self) {
        for row in 0..=CONFIDENCE {
            self.planes.row_mut(row).copy_from_slice(other.planes.row(row));
        }
    }
}

/// The latest frames, `N` planes for each.
#[derive(Debug)]
pub(super) struct Ring<const N: usize> {
    planes: Planes<f64>,
    frames: usize,
    newest: usize,
}

impl<const N: usize> Ring<N> {
    /// A ring of `frames` frames of zeros.
    pub(super) fn new(frames: usize, length: usize) -> Self {
        Self { planes: Planes::new(frames * N, length), frames, newest: 0 }
    }

    /// Replaces the oldest frame, and returns the planes of the new one.
    pub(super) fn advance(&mut self) -> [&mut [f64]; N] {
        self.newest = (self.newest + 1) % self.frames;
        self.newest_mut()
    }

    /// The planes of the newest frame, to be written.
    pub(super) fn newest_mut(&mut self) -> [&mut [f64]; N] {
        self.planes.rows_mut::<N>(self.newest * N)
    }

    /// The planes of the frame `ago` frames before the newest.
    pub(super) fn ago(&self, ago: usize) -> [&[f64]; N] {
        self.planes.rows_from::<N>((self.newest + self.frames - ago) % self.frames * N)
    }

    /// Sets one element of some planes in all frames.
    pub(super) fn fill<const M: usize>(&mut self, first: usize, place: usize, values: [f64; M]) {
        for frame in 0..self.frames {
            for (plane, value) in self.planes.rows_mut::<M>(frame * N + first).into_iter().zip(values) {
                plane[place] = value;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ring_forgets_the_oldest() {
        let mut ring = Ring::<2>::new(3, 1);
        for i in 0..5 {
            let [a, b] = ring.advance();
            a[0] = f64::from(i);
            b[0] = -f64::from(i);
        }
        let seen: Vec<[f64; 2]> = (0..3).map(|ago| ring.ago(ago).map(|plane| plane[0])).collect();
        assert_eq!(seen, [[4.0, -4.0], [3.0, -3.0], [2.0, -2.0]]);
        ring.fill(1, 0, [7.0]);
        assert_eq!(ring.ago(2).map(|plane| plane[0]), [2.0, 7.0]);
    }

    #[test]
    fn spare_joints_have_no_share() {
        let pose = Pose::new(3);
        assert_eq!(pose.confidence(), [0.0; 8]);
        assert_eq!(plane([1.0, 2.0, 3.0].into_iter()), [1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    }
}
