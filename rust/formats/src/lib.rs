//! Motion-capture files: text and structure only, no mathematics.
//!
//! A reader accepts real files, or rejects them with one [`Error`]: line and reason. It never guesses silently:
//! repairs and assumptions are returned as [`Note`]s with the data.
//!
//! The modules:
//!
//! - [`bvh`]: [`bvh::parse`] reads a file from bytes, [`bvh::write`] writes one;
//! - [`acclaim`]: [`acclaim::parse_asf`] reads a skeleton, [`acclaim::parse_amc`] one of its motions.
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
//! Internal modules: lines and names (`text`), decimal text to float64 (`number`) and back (`decimal`).
//!
//! Long work is distributed over the threads of the caller's rayon pool (`ThreadPool::install`). Outside of a pool
//! everything runs on the calling thread: a global pool would not survive a `fork`.

pub mod acclaim;
pub mod bvh;
pub mod error;

mod decimal;
mod number;
mod text;

pub use decimal::Precision;
pub use error::{Error, Note};
