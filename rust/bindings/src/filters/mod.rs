//! Filters.

pub(crate) mod bilateral;
pub(crate) mod butterworth;
pub(crate) mod confidence;
pub(crate) mod despike;
pub(crate) mod development;
pub(crate) mod gaps;
pub(crate) mod gaussian;
pub(crate) mod kalman;
pub(crate) mod names;
pub(crate) mod nonlocal_pose_means;
pub(crate) mod one_euro;
pub(crate) mod orientation_filter;
pub(crate) mod savgol;
pub(crate) mod smooth;
pub(crate) mod stream;
pub(crate) mod weighted_moving_mean;
