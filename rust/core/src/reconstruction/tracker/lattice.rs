//! Candidate examples: the poses of a database that may be examples.

use super::poses::Poses;
use crate::Error;

/// Every `stride`-th pose of each clip, starting with the first that has enough poses before it.
#[derive(Debug, Clone)]
pub(super) struct Lattice {
    poses: Vec<u32>,
    /// One bit per pose of the database.
    members: Vec<u64>,
    stride: usize,
}

impl Lattice {
    /// The poses with at least `before` poses of their clip before them.
    pub(super) fn new(poses: &Poses<'_>, before: usize, stride: usize) -> Result<Self, Error> {
        if u32::try_from(poses.count()).is_err() {
            return Err(Error::Parameter { name: "poses", expected: "at most 2³² poses" });
        }
        let of_clip = |clip: std::ops::Range<usize>| clip.step_by(stride);
        let members = poses.with_history(before).flat_map(of_clip);
        let mut lattice = Self { poses: Vec::new(), members: vec![0; poses.count().div_ceil(64)], stride };
        for pose in members {
            lattice.members[pose / 64] |= 1 << (pose % 64);
            lattice.poses.extend(u32::try_from(pose));
        }
        Ok(lattice)
    }

    /// All of them, in ascending order.
    pub(super) fn poses(&self) -> &[u32] {
        &self.poses
    }

    /// Number of words of a bit set over all poses.
    pub(super) fn words(&self) -> usize {
        self.members.len()
    }

    pub(super) fn stride(&self) -> usize {
        self.stride
    }

    /// The candidates less than a stride away from a pose.
    #[inline(always)]
    pub(super) fn beside(&self, pose: usize) -> impl Iterator<Item = u32> {
        let range = (pose + 1).saturating_sub(self.stride)..(pose + self.stride).min(self.members.len() * 64);
        range
            .filter(|&at| self.members[at / 64] >> (at % 64) & 1 == 1)
            .filter_map(|at| u32::try_from(at).ok())
    }
}
