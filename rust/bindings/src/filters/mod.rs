//! Filters.

pub(crate) mod gaps;
pub(crate) mod nonlocal_pose_means;
