//! The noise of clips.

pub(crate) mod model;
#[allow(clippy::module_inception, reason = "one word for a thing in every layer")]
pub(crate) mod noise;
pub(crate) mod repeats;
pub(crate) mod whiten;
