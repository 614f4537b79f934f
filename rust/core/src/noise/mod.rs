//! The noise level of clips of rotations.

pub mod coherence;
mod median;
#[allow(clippy::module_inception, reason = "one word for a thing in every layer")]
pub mod noise;
