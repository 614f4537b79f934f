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
