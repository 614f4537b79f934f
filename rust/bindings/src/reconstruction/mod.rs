//! Motion from a few trajectories: the database of poses, local models.

pub(crate) mod features;
pub(crate) mod heading;
pub(crate) mod local_models;
