//! Filters: from a clip to a cleaner clip.

pub mod bilateral;
pub mod butterworth;
pub(crate) mod columns;
pub mod confidence;
pub mod despike;
pub mod development;
pub mod gaps;
pub mod gaussian;
pub mod kalman;
mod lanes;
mod local;
pub mod nonlocal_pose_means;
pub mod one_euro;
pub mod orientation_filter;
mod samples;
pub mod savgol;
pub mod smooth;
pub mod stream;
pub mod weighted_moving_mean;
