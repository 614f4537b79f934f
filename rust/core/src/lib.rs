//! Filters, statistics and reconstruction for rotation time series.
//!
//! This crate is the mathematics of quatfilt; it does not depend on Python. Rotations are unit quaternions, Hamilton,
//! scalar first; a clip is `(frames, joints, 4)` in C order, and time is its first axis.
//!
//! The modules:
//!
//! - foundation: [`error`], [`real`] (float32 and float64), [`clip`] (borrowed views and aligned planes),
//!   [`elementary`] (vectorisable functions), [`simd`] (run-time dispatch), [`parallel`] (the thread pool);
//! - [`rotations`]: algebra, continuity, resampling;
//! - [`search`]: nearest-neighbour search for patches and poses;
//! - [`sampling`]: the sampling times of the source, and tracker noise;
//! - [`filters`]: filters for rotations, on clips and on streams; gaps and spikes;
//! - [`noise`]: the noise level, axes, colour and time course;
//! - [`geodesics`]: principal geodesic analysis, compression and segmentation;
//! - [`motion`]: forward kinematics, and feet on the ground;
//! - [`reconstruction`]: motion from the trajectories of a few control points.
//!
//! Hot kernels are maps over frames on aligned planes: no libm, no fused multiply-add and no horizontal sums, so
//! that the bits are the same at every SIMD level and for every number of threads.

#![cfg_attr(test, allow(clippy::float_cmp, reason = "tests say exactly what they expect"))]

pub mod clip;
mod eigen;
pub mod elementary;
pub mod error;
pub mod filters;
pub mod geodesics;
pub mod motion;
pub mod noise;
pub mod parallel;
pub mod real;
pub mod reconstruction;
pub mod rotations;
pub mod sampling;
pub mod search;
pub mod simd;
pub mod window;

pub use clip::{ClipMut, ClipView};
pub use error::Error;
pub use real::Real;
