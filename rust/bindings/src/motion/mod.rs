//! Skeletons in motion.

pub(crate) mod feet;
pub(crate) mod skeleton;
