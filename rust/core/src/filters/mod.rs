//! Filters of clips of rotations.

pub mod gaps;
