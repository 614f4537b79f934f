//! The noise of clips: its level, and what is known of it besides.
//!
//! - `noise`: the level of each joint; `median` for it; `coherence`: what noise leaves of a mean;
//! - `repeats`: samples that were written again;
//! - `motion`: how large noise is beside the motion;
//! - `along_time`: its variance along time;
//! - `colour`: how it depends on that of the frame before;
//! - `axes`: how it differs between directions;
//! - `whiten`: rotations whose noise is white, and back;
//! - `outliers`: samples drawn towards an estimate.

pub mod along_time;
pub mod axes;
pub mod coherence;
pub mod colour;
mod median;
pub mod motion;
#[allow(clippy::module_inception, reason = "one word for a thing in every layer")]
pub mod noise;
pub mod outliers;
pub mod repeats;
pub mod whiten;
