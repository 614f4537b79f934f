//! Search: the patches of motions, and the poses of a database, that are most like others.
//!
//! A patch is a frame with its surroundings in time. Along a diagonal, the pairs `(t, t + lag)`, the distance of two
//! patches is a sliding sum over the distances of single frames, so the cost does not grow with the patch.
//!
//! - [`patch_neighbors`]: the most similar patches of every frame, in the clip or in a library of others;
//! - `features`: what frames are compared by, as planes;
//! - `diagonal`: distances of the patches of one diagonal;
//! - `nearest`: the most similar so far;
//! - `join`: all pairs between a block of frames and a block of candidates, or those that matter;
//! - `bounds`: what patches are never nearer than, which tells the pairs that do not matter;
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
