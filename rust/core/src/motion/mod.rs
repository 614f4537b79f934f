//! Skeletons in motion.

pub mod skeleton;
