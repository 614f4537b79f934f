//! Filters.

pub(crate) mod bilateral;
pub(crate) mod gaps;
mod names;
pub(crate) mod nonlocal_pose_means;
pub(crate) mod orientation_filter;
pub(crate) mod stream;
