//! Filters: a clip in, a cleaner clip out.

pub mod bilateral;
pub mod gaps;
mod local;
pub mod nonlocal_pose_means;
pub mod orientation_filter;
mod samples;
pub mod stream;
