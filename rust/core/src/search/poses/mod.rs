//! Pose search: segments of poses in a database that are nearest to others.
//!
//! A pose is a row of `dims` numbers whose Euclidean distance is that of the poses. A segment is `length` poses in sequence
//! within one clip, known by the number of its last pose; since the rows lie in sequence, a segment is a vector too, and its
//! squared distance to another is the sum over its poses.
//!
//! - [`Segments`]: which segments of a matrix are candidates;
//! - [`Index`]: what tells early that a segment is not among the nearest;
//! - [`nearest`]: exact search;
//! - [`graph`]: the nearest segments of every segment of the database;
//! - [`walk`]: search from frame to frame, along the graph;
//! - [`along`]: exact search from frame to frame;
//! - `best`: the nearest so far; `kernels`: distances.

pub mod along;
mod best;
pub mod graph;
mod index;
mod kernels;
mod nearest;
mod principal;
mod segments;
pub mod walk;

pub use best::Best;
pub use index::Index;
pub use kernels::Probe;
pub(crate) use kernels::squares_of;
pub use nearest::{Nearest, nearest};
pub(crate) use principal::directions;
pub use segments::{Layout, Segments};
