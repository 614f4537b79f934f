//! Rotations.

pub(crate) mod continuity;
pub(crate) mod euler;
pub(crate) mod mean;
pub(crate) mod quaternion;
pub(crate) mod resample;
