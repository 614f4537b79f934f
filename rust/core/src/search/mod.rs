//! Nearest-neighbour search for the patches of motions and for the poses of a database.
//!
//! A patch is a frame with its neighbourhood in time. Along a diagonal, the pairs `(t, t + lag)`, the squared patch
//! distance is a sliding sum over squared frame distances, so the cost does not grow with the patch length.
//!
//! - [`patch_neighbors`]: the nearest patches of every frame, in the clip or in a library of clips;
//! - `features`: the features that frames are compared by, as planes;
//! - `diagonal`: distances between the patches along one diagonal;
//! - `nearest`: the nearest candidates found so far;
//! - `join`: distances between a block of frames and a block of candidates;
//! - `bounds`: lower bounds of patch distances, by which most pairs are skipped;
//! - `kernels`: the vectorised loops;
//! - [`poses`]: the nearest segments of poses in a database, and the graph of neighbours.

pub(crate) mod bounds;
pub(crate) mod diagonal;
pub(crate) mod features;
pub(crate) mod join;
pub(crate) mod kernels;
pub(crate) mod nearest;
pub mod patch_neighbors;
pub mod poses;
