//! Motion from the trajectories of a few control points.

pub(crate) mod features;
pub(crate) mod heading;
pub(crate) mod local_models;
pub(crate) mod solver;
pub(crate) mod tracker;
