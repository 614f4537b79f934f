//! The weighted means of a group of joints over a tile.

use super::kernels::{self, LANE, SHIFT};
use super::likeness::Likeness;
use super::path::JointChart;
use super::tile::{Piece, Tile};
use crate::Real;
use crate::clip::Planes;
use crate::rotations::quaternion::{between, log_short};
use std::ops::Range;

/// Exponent of the floor of the self-weight: a frame without likeness comes back unchanged, in float32 and float64.
const FLOOR: f64 = -80.0;

/// Sums of weighted samples, and what they are divided by.
pub(super) struct Means<'a, T> {
    tile: &'a Tile<'a, T>,
    group: Range<usize>,
    /// Largest weight of any candidate, per frame.
    most: Vec<T>,
    /// Sum of the candidates' weights, per frame.
    total: Vec<T>,
    /// Per joint, and then for the translation: sums of 3 coordinates and, with confidence, of its share of weights.
    sums: Planes<T>,
    /// With confidence: per joint (fixed chart) and translation, the samples times their confidence, and it.
    trusted: Option<Planes<T>>,
}

/// Planes per joint: 3 coordinates, and the share of weights.
const PER_JOINT: usize = 4;

impl<'a, T: Real> Means<'a, T> {
    pub(super) fn new(tile: &'a Tile<'a, T>, group: Range<usize>) -> Self {
        let padded = tile.frames.next_multiple_of(LANE);
        let columns = group.len() + 1;
        let trusted = tile.confidence.as_ref().map(|confidence| {
            let mut trusted = Planes::new(columns * PER_JOINT, tile.planes.length());
            for joint in group.clone() {
                let row = (joint - group.start) * PER_JOINT;
                trusted.row_mut(row + 3).copy_from_slice(confidence.row(joint));
                if tile.clip.paths.charts[joint] != JointChart::Local {
                    for (c, x) in tile.planes.rows_from::<3>(tile.rows[joint]).into_iter().enumerate() {
                        kernels::multiply_planes(trusted.row_mut(row + c), x, confidence.row(joint));
                    }
                }
            }
            if let Some(translation) = tile.translation.as_ref().filter(|_| group.start == 0) {
                let row = group.len() * PER_JOINT;
                trusted.row_mut(row + 3).copy_from_slice(confidence.row(0));
                for c in 0..3 {
                    kernels::multiply_planes(trusted.row_mut(row + c), translation.row(c), confidence.row(0));
                }
            }
            trusted
        });
        Self {
            tile,
            group,
            most: vec![T::ZERO; padded],
            total: vec![T::ZERO; padded],
            sums: Planes::new(columns * PER_JOINT, padded),
            trusted,
        }
    }

    /// Notes one lag's weights: their largest and their sum.
    pub(super) fn note(&mut self, weights: &[T]) {
        kernels::note_weights(&mut self.most, &mut self.total, weights);
    }

    /// The rows of sums with a fixed chart: position in the group, and the planes of their samples.
    fn fixed(&self) -> Vec<(usize, [&'a [T]; 3])> {
        let tile = self.tile;
        let joints = self.group.clone().filter(|&joint| tile.clip.paths.charts[joint] != JointChart::Local);
        let moved = tile.translation.as_ref().filter(|_| self.group.start == 0);
        joints
            .map(|joint| (joint - self.group.start, tile.planes.rows_from::<3>(tile.rows[joint])))
            .chain(moved.map(|translation| (self.group.len(), translation.rows_from::<3>(0))))
            .collect()
    }

    /// Adds the samples of a block of lags from `lag`, for fixed charts and the translation.
    pub(super) fn add_block(&mut self, lag: usize, lags: usize, forward: &Planes<T>, backward: &Planes<T>) {
        let at = self.tile.at;
        for (index, planes) in self.fixed() {
            let row = index * PER_JOINT;
            match &self.trusted {
                None => {
                    kernels::accumulate(
                        self.sums.rows_mut::<3>(row),
                        planes,
                        at,
                        lag,
                        lags,
                        forward,
                        backward,
                    );
                }
                Some(trusted) => {
                    let planes = trusted.rows_from::<PER_JOINT>(row);
                    let sums = self.sums.rows_mut::<PER_JOINT>(row);
                    kernels::accumulate(sums, planes, at, lag, lags, forward, backward);
                }
            }
        }
    }

    /// Adds the samples of pairs that were just weighed, for joints in the local chart.
    ///
    /// A pair's half rotation vector is the same at either of its frames, up to its sign.
    pub(super) fn add_local(&mut self, likeness: &Likeness<'_, T>, piece: &Piece, lag: usize) {
        let tile = self.tile;
        for joint in self.group.clone().filter(|&joint| tile.clip.paths.charts[joint] == JointChart::Local) {
            let index = joint - self.group.start;
            for (side, sign, later) in [(&piece.forward, T::ONE, lag), (&piece.backward, -T::ONE, 0)] {
                let Some(side) = side else { continue };
                let mut weights = likeness.current()[side.pairs.clone()].to_vec();
                if let Some(trusted) = &self.trusted {
                    let from = piece.pairs.start + side.pairs.start + later;
                    let confidence = &trusted.row(index * PER_JOINT + 3)[from..from + weights.len()];
                    for (weight, c) in weights.iter_mut().zip(confidence) {
                        *weight *= *c;
                    }
                }
                let logs = likeness.pair_logs(joint, side.pairs.clone());
                let [x, y, z, share] = self
                    .sums
                    .rows_mut::<PER_JOINT>(index * PER_JOINT)
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

    /// Adds one candidate, `lag` frames before or after, to one frame of the tile.
    pub(super) fn add_one(&mut self, frame: usize, lag: usize, later: bool, weight: T) {
        let tile = self.tile;
        let candidate = if later { tile.at + frame + lag } else { tile.at + frame - lag };
        self.most[frame] = self.most[frame].max(weight);
        self.total[frame] += weight;
        for joint in self.group.clone() {
            let row = (joint - self.group.start) * PER_JOINT;
            let trust = self.trusted.as_ref().map_or(T::ONE, |trusted| trusted.row(row + 3)[candidate]);
            let value = if tile.clip.paths.charts[joint] == JointChart::Local {
                let q = tile.planes.rows_from::<4>(tile.rows[joint]);
                let at = |i: usize| q.map(|q| q[i]);
                log_short(between(at(tile.at + frame), at(candidate)))
            } else {
                tile.planes.rows_from::<3>(tile.rows[joint]).map(|x| x[candidate])
            };
            self.add_value(row, frame, weight * trust, value);
        }
        if let Some(translation) = tile.translation.as_ref().filter(|_| self.group.start == 0) {
            let row = self.group.len() * PER_JOINT;
            let trust = self.trusted.as_ref().map_or(T::ONE, |trusted| trusted.row(row + 3)[candidate]);
            self.add_value(row, frame, weight * trust, translation.rows_from::<3>(0).map(|x| x[candidate]));
        }
    }

    fn add_value(&mut self, row: usize, frame: usize, weight: T, value: [T; 3]) {
        for (c, value) in value.into_iter().enumerate() {
            self.sums.row_mut(row + c)[frame] += weight * value;
        }
        self.sums.row_mut(row + 3)[frame] += weight;
    }

    /// Divides, and writes rotations to `out`, `(frames, joints, 4)`, and the translation to `moved`, `(frames, 3)`.
    pub(super) fn store(mut self, out: &mut [T], moved: &mut [T]) {
        let tile = self.tile;
        let floor = T::from_f64(SHIFT + FLOOR).exp();
        let own: Vec<T> = self.most.iter().map(|most| most.max(floor)).collect();
        let joints = tile.rows.len();
        let (samples, _) = out.as_chunks_mut::<4>();
        let frames = tile.frames;
        let here = tile.at..tile.at + frames;
        let mut trusted_own = own.clone();
        for joint in self.group.clone() {
            let row = (joint - self.group.start) * PER_JOINT;
            if let Some(trusted) = &self.trusted {
                kernels::multiply_planes(
                    &mut trusted_own[..frames],
                    &own,
                    &trusted.row(row + 3)[here.clone()],
                );
            }
            let [x, y, z, share] = self.sums.rows_mut::<PER_JOINT>(row).map(|sums| &mut sums[..frames]);
            let total = if self.trusted.is_some() { &share[..] } else { &self.total[..frames] };
            let sign = tile.clip.paths.sign(tile.clip.reach.pad, joint);
            let to = &mut samples[joint..];
            match tile.clip.paths.charts[joint] {
                JointChart::Fixed(centre) => {
                    let planes = tile.planes.rows_from::<3>(tile.rows[joint]).map(|x| &x[here.clone()]);
                    for (sums, plane) in [&mut *x, &mut *y, &mut *z].into_iter().zip(planes) {
                        kernels::settle(sums, plane, total, &trusted_own);
                    }
                    kernels::store_fixed([x, y, z], centre, sign, to, joints);
                }
                JointChart::Local => {
                    for sums in [&mut *x, &mut *y, &mut *z] {
                        kernels::settle_local(sums, total, &trusted_own);
                    }
                    let q = tile.planes.rows_from::<4>(tile.rows[joint]).map(|q| &q[here.clone()]);
                    kernels::store_local([x, y, z], q, sign, to, joints);
                }
            }
        }
        let Some(translation) = tile.translation.as_ref().filter(|_| self.group.start == 0) else { return };
        let row = self.group.len() * PER_JOINT;
        if let Some(trusted) = &self.trusted {
            kernels::multiply_planes(&mut trusted_own[..frames], &own, &trusted.row(row + 3)[here.clone()]);
        }
        let [x, y, z, share] = self.sums.rows_mut::<PER_JOINT>(row).map(|sums| &mut sums[..frames]);
        let total = if self.trusted.is_some() { &share[..] } else { &self.total[..frames] };
        for (c, sums) in [x, y, z].into_iter().enumerate() {
            kernels::settle(sums, &translation.row(c)[here.clone()], total, &trusted_own);
            for (moved, sums) in moved[c..].iter_mut().step_by(3).zip(sums) {
                *moved = *sums;
            }
        }
    }
}
