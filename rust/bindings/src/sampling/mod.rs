//! The clock of the source.

#[allow(clippy::module_inception, reason = "one word for a thing in every layer")]
pub(crate) mod sampling;
pub(crate) mod spline;
pub(crate) mod tracker_noise;
