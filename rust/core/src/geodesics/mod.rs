//! Analysis of rotations by geodesics.

pub mod body;
pub mod compress;
mod eigen;
pub mod pga;
pub mod segment;
