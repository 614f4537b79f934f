//! Nearest-neighbour search for patches and poses.

pub(crate) mod patch_neighbors;
pub(crate) mod poses;
