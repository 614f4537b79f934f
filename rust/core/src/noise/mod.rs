//! The noise of clips: its level, and what is known of it besides.

pub mod coherence;
mod median;
#[allow(clippy::module_inception, reason = "one word for a thing in every layer")]
pub mod noise;
pub mod repeats;
