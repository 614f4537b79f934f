//! Analysis of rotations by geodesics.

pub mod pga;
