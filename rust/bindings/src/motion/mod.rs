//! Skeletons in motion.

pub(crate) mod skeleton;
