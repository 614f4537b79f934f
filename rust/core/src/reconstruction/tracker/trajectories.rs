//! Where candidates have the control points, side by side.

use super::lattice::Lattice;
use super::poses::Poses;
use crate::reconstruction::frame::HORIZONTAL;

/// Candidates side by side.
pub(super) const LANES: usize = 8;

/// Control points of all candidates and of the frames before them: for each group of [`LANES`] candidates, for each frame and
/// each point, the two level coordinates and the height of each.
#[derive(Debug, Clone)]
pub(super) struct Trajectories {
    planes: Vec<f32>,
    window: Vec<usize>,
    points: usize,
    up: usize,
}

impl Trajectories {
    /// Those of a lattice; `window` says how many frames before.
    pub(super) fn new(
        poses: &Poses<'_>,
        lattice: &Lattice,
        window: &[usize],
        points: usize,
        up: usize,
    ) -> Self {
        let mut trajectories = Self { planes: Vec::new(), window: window.to_vec(), points, up };
        let mut planes =
            Vec::with_capacity(lattice.poses().len().next_multiple_of(LANES) * trajectories.numbers());
        trajectories.fill(poses, lattice.poses(), &mut planes);
        trajectories.planes = planes;
        trajectories
    }

    /// Whether they are of these points in these frames.
    pub(super) fn are_of(&self, window: &[usize], points: usize, up: usize) -> bool {
        self.window == window && self.points == points && self.up == up
    }

    pub(super) fn points(&self) -> usize {
        self.points
    }

    /// Numbers of a candidate.
    fn numbers(&self) -> usize {
        3 * self.window.len() * self.points
    }

    /// Those of some candidates of the lattice, from the first of a group on.
    pub(super) fn planes(&self, slots: std::ops::Range<usize>) -> &[f32] {
        &self.planes[slots.start * self.numbers()..slots.end.next_multiple_of(LANES) * self.numbers()]
    }

    /// Writes those of other candidates; the last group is filled up with its last.
    pub(super) fn fill(&self, poses: &Poses<'_>, candidates: &[u32], planes: &mut Vec<f32>) {
        let [first, second] = HORIZONTAL[self.up];
        for group in candidates.chunks(LANES) {
            let rows: [usize; LANES] = std::array::from_fn(|lane| group[lane.min(group.len() - 1)] as usize);
            for &lag in &self.window {
                for point in 0..self.points {
                    let at = rows.map(|row| {
                        let at = 3 * ((row - lag) * self.points + point);
                        &poses.trajectories[at..at + 3]
                    });
                    for axis in [first, second, self.up] {
                        planes.extend(at.map(|place| place[axis]));
                    }
                }
            }
        }
    }
}
