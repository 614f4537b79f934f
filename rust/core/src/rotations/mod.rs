//! Unit quaternions: algebra, statistics and resampling.

pub mod quaternion;
