//! Rotations.

pub(crate) mod continuity;
pub(crate) mod quaternion;
