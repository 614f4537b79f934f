//! Rotations.

pub(crate) mod mean;
pub(crate) mod quaternion;
