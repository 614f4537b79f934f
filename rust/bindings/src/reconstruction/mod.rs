//! Motion from a few trajectories: the database of poses.

pub(crate) mod features;
pub(crate) mod heading;
