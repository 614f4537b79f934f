//! Filters: a clip in, a cleaner clip out.

pub mod gaps;
pub mod nonlocal_pose_means;
