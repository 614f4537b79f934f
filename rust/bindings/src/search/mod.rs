//! Search for similar patches.

pub(crate) mod patch_neighbors;
