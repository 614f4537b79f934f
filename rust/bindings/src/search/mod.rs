//! Search for similar patches and poses.

pub(crate) mod patch_neighbors;
pub(crate) mod poses;
