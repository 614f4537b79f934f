//! Rotations.

pub(crate) mod quaternion;
