//! Motion reconstruction from the trajectories of a few control points.

pub mod features;
pub mod frame;
pub mod heading;
pub mod kinematics;
pub mod local_models;
pub mod solver;
pub mod tracker;
