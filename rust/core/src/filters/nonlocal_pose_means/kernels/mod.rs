//! The vectorised loops: maps over frames on planes.

mod distances;
mod samples;
mod sums;

pub(super) use distances::{
    FARTHEST, add_lengths, add_shares, add_squares, divide_by_shares, exclude_without_shares,
    multiply_planes, pair_logs, sliding_sums, weigh,
};
pub(super) use samples::{copy_signed, load_fixed, load_local, store_fixed, store_local, turns};
pub(super) use sums::{Lags, accumulate, add_products, note_weights, settle, settle_local};

/// Frames that a loop over lags keeps at hand: four vectors of float32 at the widest level.
pub(super) const LANE: usize = 64;

/// Weights are kept times `e⁶⁰`, so that those far below the floor of the self-weight are still normal float32 numbers
/// and sums of a million of the largest do not overflow.
pub(super) const SHIFT: f64 = 60.0;
