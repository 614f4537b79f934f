//! Skeletons in motion.

pub mod feet;
pub mod skeleton;
