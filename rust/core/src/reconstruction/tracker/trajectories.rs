//! Control-point trajectories of all candidates, side by side.

use super::lattice::Lattice;
use super::poses::Poses;
use crate::reconstruction::frame::HORIZONTAL;

/// Candidates per group.
pub(super) const LANES: usize = 8;

/// Control points of all candidates at each lag of the window. For each group of [`LANES`] candidates, each lag and
/// each point: the two horizontal coordinates and the height.
#[derive(Debug, Clone)]
pub(super) struct Trajectories {
    planes: Vec<f32>,
    window: Vec<usize>,
    points: usize,
    up: usize,
}

impl Trajectories {
    /// The trajectories of all candidates; `window` are the lags in frames.
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

    /// Whether they belong to these lags and points.
    pub(super) fn are_of(&self, window: &[usize], points: usize, up: usize) -> bool {
        self.window == window && self.points == points && self.up == up
    }

    pub(super) fn points(&self) -> usize {
        self.points
    }

    /// Values per candidate.
    fn numbers(&self) -> usize {
        3 * self.window.len() * self.points
    }

    /// The trajectories of a range of candidates, which starts at the first of a group.
    pub(super) fn planes(&self, slots: std::ops::Range<usize>) -> &[f32] {
        &self.planes[slots.start * self.numbers()..slots.end.next_multiple_of(LANES) * self.numbers()]
    }

    /// Writes the trajectories of other candidates; the last group is padded with its last candidate.
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
