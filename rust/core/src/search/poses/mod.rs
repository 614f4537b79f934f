//! Pose search: the segments of poses in a database that are nearest to a query.
//!
//! A pose is a row of `dims` values; the distance of two poses is the Euclidean distance of their rows. A segment is
//! `length` consecutive poses of one clip and is identified by the index of its last pose. Rows are contiguous, so a
//! segment is a vector too, and the squared distance of two segments is the sum over their poses.
//!
//! - [`Segments`]: the candidate segments of a matrix;
//! - [`Index`]: lower bounds of segment distances for exact search;
//! - [`nearest`]: exact search;
//! - [`graph`]: the nearest segments of every segment of the database;
//! - [`walk`]: approximate search from frame to frame, along the graph;
//! - [`along`]: exact search from frame to frame;
//! - `best`: the nearest segments found so far; `kernels`: distances.

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
