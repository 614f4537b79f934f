//! Search for similar patches.

pub(crate) mod patch_neighbors;
//! Search for similar poses.
pub(crate) mod poses;
