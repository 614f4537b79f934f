//! Unit quaternions: algebra, statistics and resampling.

pub mod continuity;
pub mod euler;
pub mod mean;
pub mod quaternion;
pub mod resample;
