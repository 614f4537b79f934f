//! Filters.

pub(crate) mod nonlocal_pose_means;
