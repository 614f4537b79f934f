//! The poses of a database that may be examples.

use super::poses::Poses;
use crate::Error;

/// Every so many-th pose of each clip, from the first with enough poses before it on.
#[derive(Debug, Clone)]
pub(super) struct Lattice {
    poses: Vec<u32>,
    /// A bit for each pose of the database.
    members: Vec<u64>,
    stride: usize,
}

impl Lattice {
    /// Those with `before` poses of their clip before them.
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

    /// All of them; they rise.
    pub(super) fn poses(&self) -> &[u32] {
        &self.poses
    }

    /// Words of a bit for each pose.
    pub(super) fn words(&self) -> usize {
        self.members.len()
    }

    pub(super) fn stride(&self) -> usize {
        self.stride
    }

    /// Those that lie less than a stride away from a pose.
    #[inline(always)]
    pub(super) fn beside(&self, pose: usize) -> impl Iterator<Item = u32> {
        let range = (pose + 1).saturating_sub(self.stride)..(pose + self.stride).min(self.members.len() * 64);
        range
            .filter(|&at| self.members[at / 64] >> (at % 64) & 1 == 1)
            .filter_map(|at| u32::try_from(at).ok())
    }
}
