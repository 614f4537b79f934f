//! Unit quaternions: algebra, statistics and resampling.

pub mod mean;
pub mod quaternion;
