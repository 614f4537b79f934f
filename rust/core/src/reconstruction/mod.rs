//! Motion from a few trajectories: the database of poses, local models.

pub mod features;
pub mod heading;
pub mod local_models;
