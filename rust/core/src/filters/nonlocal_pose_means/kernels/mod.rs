//! Vectorised loops over frames on planes.

mod distances;
mod sums;

pub(super) use crate::filters::samples::{
    LANE, copy_signed, load_fixed, load_local, store_fixed, store_local, turns,
};
pub(super) use crate::search::kernels::sliding_sums;
pub(super) use distances::{
    FARTHEST, add_lengths, add_shares, add_squares, divide_by_shares, exclude_without_shares,
    multiply_planes, pair_logs, weigh,
};
pub(super) use sums::{Lags, accumulate, add_products, note_weights, settle, settle_local};

/// Weights are stored times `e⁶⁰`. So weights far below the floor of the self-weight are still normal float32
/// numbers, and sums of a million of the largest do not overflow.
pub(super) const SHIFT: f64 = 60.0;
