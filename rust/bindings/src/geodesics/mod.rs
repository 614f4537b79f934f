//! Analysis of rotations by geodesics.

pub(crate) mod body;
pub(crate) mod compress;
pub(crate) mod pga;
pub(crate) mod segment;
mod shared;
