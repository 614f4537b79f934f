//! Weighted means of a tile: sums per joint, divided by their weights group by group.

use super::kernels::{self, LANE, Lags, SHIFT};
use super::patch_distance::PatchDistances;
use super::path::JointChart;
use super::tile::{Piece, Tile};
use crate::Real;
use crate::clip::Planes;
use crate::rotations::quaternion::{between, log_short};
use std::ops::Range;

/// Exponent of the floor of the self-weight: a frame without similar candidates is returned unchanged, in float32 and
/// float64.
const FLOOR: f64 = -80.0;

/// Sums of weighted samples, and their divisors.
pub(super) struct Means<'a, T> {
    tile: &'a Tile<'a, T>,
    /// The joints that share the weights being added.
    group: Range<usize>,
    /// Largest weight of any candidate, per frame.
    most: Vec<T>,
    /// Sum of the candidates' weights, per frame.
    total: Vec<T>,
    /// Per joint, then for the translation: sums of 3 coordinates and, with confidence, of the weights; after
    /// division, the means.
    sums: Planes<T>,
    /// Whether the group's sums in fixed charts still hold stale memory.
    fresh: bool,
    /// With confidence: per joint (fixed chart) and translation, the samples times their confidence, and the
    /// confidence.
    weighted: Option<Planes<T>>,
}

/// Planes per joint: 3 coordinates, and the sum of weights.
const PER_JOINT: usize = 4;

impl<'a, T: Real> Means<'a, T> {
    pub(super) fn new(tile: &'a Tile<'a, T>, mut sums: Planes<T>) -> Self {
        let joints = tile.rows.len();
        let padded = tile.frames.next_multiple_of(LANE);
        let weighted = tile.confidence.as_ref().map(|confidence| {
            let mut weighted = Planes::new((joints + 1) * PER_JOINT, tile.planes.length());
            let moved =
                tile.translation.as_ref().map(|translation| (joints, 0, translation.rows_from::<3>(0)));
            let fixed = (0..joints)
                .filter(|&joint| tile.clip.paths.charts[joint] != JointChart::Local)
                .map(|joint| (joint, joint, tile.planes.rows_from::<3>(tile.rows[joint])));
            for (index, joint, planes) in fixed.chain(moved) {
                for (c, x) in planes.into_iter().enumerate() {
                    kernels::multiply_planes(
                        weighted.row_mut(index * PER_JOINT + c),
                        x,
                        confidence.row(joint),
                    );
                }
            }
            for index in 0..=joints {
                let joint = if index == joints { 0 } else { index };
                weighted.row_mut(index * PER_JOINT + 3).copy_from_slice(confidence.row(joint));
            }
            weighted
        });
        sums.reshape((joints + 1) * PER_JOINT, padded);
        Self {
            tile,
            group: 0..0,
            most: vec![T::ZERO; padded],
            total: vec![T::ZERO; padded],
            sums,
            fresh: true,
            weighted,
        }
    }

    /// Starts the joints of a group, which share weights.
    pub(super) fn begin(&mut self, group: Range<usize>) {
        self.group = group;
        self.most.fill(T::ZERO);
        self.total.fill(T::ZERO);
        self.fresh = true;
        // Local charts and single candidates are added one by one.
        let singly = self.tile.clip.filter.neighbors.is_some();
        let moved = self.moved().map(|_| self.tile.rows.len());
        for index in self.group.clone().chain(moved) {
            let local = self.tile.clip.paths.charts.get(index) == Some(&JointChart::Local);
            if singly || local {
                for sums in self.sums.rows_mut::<PER_JOINT>(index * PER_JOINT) {
                    sums.fill(T::ZERO);
                }
            }
        }
    }

    /// Returns the memory of the sums.
    pub(super) fn into_sums(self) -> Planes<T> {
        self.sums
    }

    /// The translation, if the group includes it.
    fn moved(&self) -> Option<&'a Planes<T>> {
        self.tile.translation.as_ref().filter(|_| self.group.start == 0)
    }

    /// Updates the largest weight and the sum of weights with those of one lag.
    pub(super) fn note(&mut self, weights: &[T]) {
        kernels::note_weights(&mut self.most, &mut self.total, weights);
    }

    /// Joints and translation with a fixed chart: their index among the sums, and the planes of their samples.
    fn fixed(&self) -> Vec<(usize, [&'a [T]; 3])> {
        let tile = self.tile;
        let joints = self.group.clone().filter(|&joint| tile.clip.paths.charts[joint] != JointChart::Local);
        joints
            .map(|joint| (joint, tile.planes.rows_from::<3>(tile.rows[joint])))
            .chain(self.moved().map(|translation| (tile.rows.len(), translation.rows_from::<3>(0))))
            .collect()
    }

    /// Adds the samples of a block of lags, for fixed charts and the translation.
    pub(super) fn add_block(
        &mut self,
        first: usize,
        count: usize,
        forward: &Planes<T>,
        backward: &Planes<T>,
    ) {
        let block = Lags { at: self.tile.at, first, count, forward, backward, fresh: self.fresh };
        for (index, planes) in self.fixed() {
            let row = index * PER_JOINT;
            match &self.weighted {
                None => kernels::accumulate(self.sums.rows_mut::<3>(row), planes, &block),
                Some(weighted) => {
                    let planes = weighted.rows_from::<PER_JOINT>(row);
                    kernels::accumulate(self.sums.rows_mut::<PER_JOINT>(row), planes, &block);
                }
            }
        }
        self.fresh = false;
    }

    /// Adds the samples of the pairs weighted last, for joints in the local chart.
    ///
    /// A pair's half rotation vector is the same at both of its frames, up to its sign.
    pub(super) fn add_local(&mut self, distances: &PatchDistances<'_, T>, piece: &Piece, lag: usize) {
        let tile = self.tile;
        for joint in self.group.clone().filter(|&joint| tile.clip.paths.charts[joint] == JointChart::Local) {
            for (side, sign, later) in [(&piece.forward, T::ONE, lag), (&piece.backward, -T::ONE, 0)] {
                let Some(side) = side else { continue };
                let mut weights = distances.current()[side.pairs.clone()].to_vec();
                if let Some(weighted) = &self.weighted {
                    let from = piece.pairs.start + side.pairs.start + later;
                    let confidence = &weighted.row(joint * PER_JOINT + 3)[from..from + weights.len()];
                    for (weight, c) in weights.iter_mut().zip(confidence) {
                        *weight *= *c;
                    }
                }
                let logs = distances.pair_logs(joint, side.pairs.clone());
                let [x, y, z, share] = self
                    .sums
                    .rows_mut::<PER_JOINT>(joint * PER_JOINT)
                    .map(|row| &mut row[side.frames.clone()]);
                for (sums, logs) in [x, y, z].into_iter().zip(logs) {
                    kernels::add_products(sums, &weights, logs, sign);
                }
                for (share, weight) in share.iter_mut().zip(&weights) {
                    *share += *weight;
                }
            }
        }
    }

    /// Adds one candidate, at a column of the planes, to one frame of the tile.
    pub(super) fn add_one(&mut self, frame: usize, candidate: usize, weight: T) {
        let tile = self.tile;
        self.most[frame] = self.most[frame].max(weight);
        self.total[frame] += weight;
        for joint in self.group.clone() {
            let row = joint * PER_JOINT;
            let confidence =
                self.weighted.as_ref().map_or(T::ONE, |weighted| weighted.row(row + 3)[candidate]);
            let value = if tile.clip.paths.charts[joint] == JointChart::Local {
                let q = tile.planes.rows_from::<4>(tile.rows[joint]);
                let at = |i: usize| q.map(|q| q[i]);
                log_short(between(at(tile.at + frame), at(candidate)))
            } else {
                tile.planes.rows_from::<3>(tile.rows[joint]).map(|x| x[candidate])
            };
            self.add_value(row, frame, weight * confidence, value);
        }
        if let Some(translation) = self.moved() {
            let row = tile.rows.len() * PER_JOINT;
            let confidence =
                self.weighted.as_ref().map_or(T::ONE, |weighted| weighted.row(row + 3)[candidate]);
            self.add_value(
                row,
                frame,
                weight * confidence,
                translation.rows_from::<3>(0).map(|x| x[candidate]),
            );
        }
    }

    /// Adds one frame of the library to one frame of the tile. It has no translation.
    pub(super) fn add_other(&mut self, frame: usize, other: usize, weight: T) {
        let tile = self.tile;
        let Some(library) = &tile.clip.library else { return };
        self.most[frame] = self.most[frame].max(weight);
        self.total[frame] += weight;
        for joint in self.group.clone() {
            let (r, confidence) = library.sample(other, joint, tile.clip.reach.before);
            let q = tile.planes.rows_from::<4>(tile.rows[joint]).map(|q| q[tile.at + frame]);
            self.add_value(joint * PER_JOINT, frame, weight * confidence, log_short(between(q, r)));
        }
    }

    fn add_value(&mut self, row: usize, frame: usize, weight: T, value: [T; 3]) {
        for (c, value) in value.into_iter().enumerate() {
            self.sums.row_mut(row + c)[frame] += weight * value;
        }
        self.sums.row_mut(row + 3)[frame] += weight;
    }

    /// Divides the sums of the group by their weights: means in the chart, or relative to the sample in the local
    /// chart.
    pub(super) fn settle(&mut self) {
        let tile = self.tile;
        let floor = T::from_f64(SHIFT + FLOOR).exp();
        let own: Vec<T> = self.most.iter().map(|most| most.max(floor)).collect();
        let here = tile.at..tile.at + tile.frames;
        let mut weighted_own = own.clone();
        let moved = self.moved().map(|translation| (tile.rows.len(), Some(translation.rows_from::<3>(0))));
        let joints = self.group.clone().map(|joint| {
            let fixed = tile.clip.paths.charts[joint] != JointChart::Local;
            (joint, fixed.then(|| tile.planes.rows_from::<3>(tile.rows[joint])))
        });
        for (index, planes) in joints.chain(moved) {
            let row = index * PER_JOINT;
            if let Some(weighted) = &self.weighted {
                let confidence = &weighted.row(row + 3)[here.clone()];
                kernels::multiply_planes(&mut weighted_own[..tile.frames], &own, confidence);
            }
            let [x, y, z, share] = self.sums.rows_mut::<PER_JOINT>(row).map(|sums| &mut sums[..tile.frames]);
            // Frames of the library have weights, but no translation.
            let apart = index == tile.rows.len() && tile.clip.library.is_some();
            let total =
                if self.weighted.is_some() || apart { &share[..] } else { &self.total[..tile.frames] };
            for (c, sums) in [x, y, z].into_iter().enumerate() {
                match planes {
                    Some(planes) => kernels::settle(sums, &planes[c][here.clone()], total, &weighted_own),
                    None => kernels::settle_local(sums, total, &weighted_own),
                }
            }
        }
    }

    /// Writes the means to `out`, `(frames, joints, 4)`, and to `moved`, `(frames, 3)`.
    ///
    /// Returns whether the sign of a rotation changes from one frame to the next.
    pub(super) fn store(&self, out: &mut [T], moved: &mut [T], rows: &mut [[T; 4]]) -> bool {
        let tile = self.tile;
        let joints = tile.rows.len();
        let (samples, _) = out.as_chunks_mut::<4>();
        // Rows are assembled in a buffer that stays in the cache, and then written once, in order.
        let mut before: Option<Vec<[T; 4]>> = None;
        let mut turned = false;
        for (chunk, out) in samples.chunks_mut(LANE * joints).enumerate() {
            let start = chunk * LANE;
            let width = out.len() / joints;
            for joint in 0..joints {
                let sign = tile.clip.paths.sign(tile.clip.reach.pad, joint);
                let v = self.sums.rows_from::<3>(joint * PER_JOINT).map(|sums| &sums[start..start + LANE]);
                let to = &mut rows[joint..];
                match tile.clip.paths.charts[joint] {
                    JointChart::Fixed(centre) => kernels::store_fixed(v, centre, sign, to, joints),
                    JointChart::Local => {
                        let at = tile.at + start;
                        let q = tile.planes.rows_from::<4>(tile.rows[joint]).map(|q| &q[at..at + LANE]);
                        kernels::store_local(v, q, sign, to, joints);
                    }
                }
            }
            let rows = &rows[..width * joints];
            turned |= kernels::turns(rows, &rows[joints..])
                || before.as_ref().is_some_and(|before| kernels::turns(before, rows));
            before = Some(rows[rows.len() - joints..].to_vec());
            out.copy_from_slice(rows);
        }
        if tile.translation.is_some() {
            for (c, sums) in self.sums.rows_from::<3>(joints * PER_JOINT).into_iter().enumerate() {
                for (moved, sums) in moved[c..].iter_mut().step_by(3).zip(sums) {
                    *moved = *sums;
                }
            }
        }
        turned
    }
}
