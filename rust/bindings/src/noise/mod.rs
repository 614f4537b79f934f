//! The noise of clips.

#[allow(clippy::module_inception, reason = "one word for a thing in every layer")]
pub(crate) mod noise;
pub(crate) mod repeats;
