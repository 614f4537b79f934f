//! Motion from a few trajectories: the database of poses.

pub mod features;
pub mod heading;
