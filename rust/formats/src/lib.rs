//! Motion-capture files in and out: text and structure only, no mathematics.
//!
//! A reader opens what real files hold, or refuses with one [`Error`]: line and reason. Nothing is guessed silently:
//! what was repaired or assumed comes back as [`Note`]s with the data.
//!
//! The rooms:
//!
//! - [`bvh`]: [`bvh::parse`] reads a file from bytes, [`bvh::write`] makes one;
//! - [`acclaim`]: [`acclaim::parse_asf`] reads a skeleton, [`acclaim::parse_amc`] a motion of it.
//!
//! ```
//! use quatfilt_formats::{Precision, bvh};
//!
//! let text = b"ROOT hips { OFFSET 0 0 0 CHANNELS 1 Xrotation }
//! MOTION
//! Frames: 2
//! Frame Time: .0083333
//! 12.5
//! 13";
//! let file = bvh::parse(text)?;
//! assert_eq!(file.values, [12.5, 13.0]);
//! assert_eq!(file.notes[0].to_string(), "line 1: HIERARCHY missing: the file starts with a root");
//!
//! let written = bvh::write(&file.joints, &file.frame_time, &file.values, Precision::Shortest)?;
//! assert_eq!(bvh::parse(&written)?.joints, file.joints);
//!
//! let refused = bvh::parse(b"solid cube").unwrap_err();
//! assert_eq!(refused.to_string(), "line 1: not BVH: expected HIERARCHY, got `solid`");
//! # Ok::<(), quatfilt_formats::Error>(())
//! ```
//!
//! Underneath lie lines and names (`text`), decimal text to float64 (`number`) and back (`decimal`).
//!
//! Long work is split over the threads of the rayon pool that the caller is in (`ThreadPool::install`). Outside of a
//! pool everything runs on the calling thread, so that no global pool comes to life that a `fork` would break.

pub mod acclaim;
pub mod bvh;
pub mod error;

mod decimal;
mod number;
mod text;

pub use decimal::Precision;
pub use error::{Error, Note};
