//! Analysis by geodesics.

pub(crate) mod body;
pub(crate) mod pga;
