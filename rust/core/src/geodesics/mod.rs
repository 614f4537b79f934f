//! Analysis of rotations by geodesics.

pub mod body;
pub mod pga;
