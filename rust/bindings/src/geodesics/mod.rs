//! Analysis by geodesics.

pub(crate) mod pga;
