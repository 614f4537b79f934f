//! Patch distances between frames, as exponents and as weights.

use super::kernels;
use super::path::JointChart;
use super::tile::Tile;
use super::{Distance, Reach};
use crate::Real;
use std::ops::Range;

/// Largest factor of a squared difference: sums of such products stay finite in float32 too.
const LARGEST_FACTOR: f64 = 1e30;

/// Patch distances of the joints of a group, which share weights.
pub(super) struct PatchDistances<'a, T> {
    tile: &'a Tile<'a, T>,
    group: Range<usize>,
    /// Half rotation vectors between the frames of the last pairs, per joint in the local chart; otherwise empty.
    pairs: Vec<[Vec<T>; 3]>,
    exponents: Vec<T>,
    entered: Vec<T>,
    distances: Vec<T>,
    shares: Vec<T>,
    squares: Vec<T>,
    share: Vec<T>,
    scratch: Vec<T>,
}

impl<'a, T: Real> PatchDistances<'a, T> {
    pub(super) fn new(tile: &'a Tile<'a, T>, group: Range<usize>) -> Self {
        let pairs = group.clone().map(|_| std::array::from_fn(|_| Vec::new())).collect();
        Self {
            tile,
            group,
            pairs,
            exponents: Vec::new(),
            entered: Vec::new(),
            distances: Vec::new(),
            shares: Vec::new(),
            squares: Vec::new(),
            share: Vec::new(),
            scratch: Vec::new(),
        }
    }

    /// Weights `e⁶⁰·exp(−exponent)` of the pairs `(u, u + lag)`.
    pub(super) fn weights(&mut self, lag: usize, pairs: Range<usize>) -> &[T] {
        let scale = self.measure(lag, pairs);
        kernels::weigh(&mut self.exponents, scale);
        &self.exponents
    }

    /// The weights computed last.
    pub(super) fn current(&self) -> &[T] {
        &self.exponents
    }

    /// Half rotation vectors between the frames of the pairs computed last, for a joint in the local chart.
    pub(super) fn pair_logs(&self, joint: usize, pairs: Range<usize>) -> [&[T]; 3] {
        let before = self.tile.clip.reach.before;
        let [x, y, z] = &self.pairs[joint - self.group.start];
        [x, y, z].map(|v| &v[before + pairs.start..before + pairs.end])
    }

    /// Computes the distances of pairs into `self.exponents`, up to the factor that is returned.
    fn measure(&mut self, lag: usize, pairs: Range<usize>) -> T {
        let Reach { before, after, .. } = self.tile.clip.reach;
        let span = pairs.start - before..pairs.end + after;
        let weighed = self.tile.confidence.is_some();
        for buffer in [&mut self.distances, &mut self.shares, &mut self.squares, &mut self.share] {
            buffer.clear();
            buffer.resize(span.len(), T::ZERO);
        }
        for joint in self.group.clone() {
            self.add_joint(joint, lag, span.clone());
        }
        let window = before + after + 1;
        self.exponents.resize(pairs.len(), T::ZERO);
        kernels::sliding_sums(&mut self.distances, &mut self.scratch, window, &mut self.exponents);
        if weighed {
            self.entered.resize(pairs.len(), T::ZERO);
            kernels::sliding_sums(&mut self.shares, &mut self.scratch, window, &mut self.entered);
        }
        match (self.tile.clip.filter.distance, weighed) {
            (Distance::Mean, true) => kernels::divide_by_shares(&mut self.exponents, &self.entered),
            (Distance::Sum, true) => kernels::exclude_without_shares(&mut self.exponents, &self.entered),
            (Distance::Mean, false) => {
                return T::from_f64(1.0 / (3 * self.group.len() * window) as f64);
            }
            (Distance::Sum, false) => {}
        }
        T::ONE
    }

    /// Adds the squared differences of one joint between the frames of `span` and those `lag` later.
    fn add_joint(&mut self, joint: usize, lag: usize, span: Range<usize>) {
        let tile = self.tile;
        let other = span.start + lag..span.end + lag;
        // Half rotation vectors: their squares are a quarter of the squared angles.
        let factor = T::from_f64((2.0 / tile.clip.filter.bandwidth[joint].powi(2)).min(LARGEST_FACTOR));
        let (sums, direct) = if tile.confidence.is_some() {
            (&mut self.squares, T::ONE)
        } else {
            (&mut self.distances, factor)
        };
        let row = tile.rows[joint];
        if tile.clip.paths.charts[joint] == JointChart::Local {
            let q = tile.planes.rows_from::<4>(row);
            let logs = &mut self.pairs[joint - self.group.start];
            let [x, y, z] = logs.each_mut().map(|v| {
                v.resize(span.len(), T::ZERO);
                &mut v[..span.len()]
            });
            kernels::pair_logs(q.map(|q| &q[span.clone()]), q.map(|q| &q[other.clone()]), x, y, z);
            kernels::add_lengths(sums, logs.each_ref().map(|v| &v[..span.len()]), direct);
        } else {
            let x = tile.planes.rows_from::<3>(row);
            kernels::add_squares(sums, x.map(|x| &x[span.clone()]), x.map(|x| &x[other.clone()]), direct);
        }
        if let Some(confidence) = &tile.confidence {
            let c = confidence.row(joint);
            kernels::multiply_planes(&mut self.share, &c[span], &c[other]);
            kernels::add_shares(&mut self.distances, &mut self.shares, &self.squares, &self.share, factor);
            self.squares.fill(T::ZERO);
        }
    }
}
