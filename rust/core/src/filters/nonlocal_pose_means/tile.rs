//! One tile of frames: from quaternions to planes, weights and means, and back to quaternions.

use super::candidates::Library;
use super::kernels::{self, LANE};
use super::means::Means;
use super::patch_distance::PatchDistances;
use super::path::{JointChart, Paths};
use super::{NonlocalPoseMeans, Reach};
use crate::clip::Planes;
use crate::parallel::Interrupt;
use crate::rotations::quaternion::conjugate_one;
use crate::search::bounds::Bounds;
use crate::search::join::Scratch;
use crate::window::{Boundary, Extended, extended_number};
use crate::{Error, Real};
use std::ops::Range;

/// Target size of a tile's planes in bytes: half of a typical second-level cache.
const TILE_BYTES: usize = 256 * 1024;

/// Least and largest number of frames of a tile, unless its surroundings require more.
const TILE_FRAMES: Range<usize> = 128..2048;

/// Lags that are weighted before their samples are added.
const BLOCK_LAGS: usize = 16;

/// Data shared by all tiles.
#[derive(Debug)]
pub(super) struct Clip<'a, T> {
    pub(super) filter: &'a NonlocalPoseMeans,
    pub(super) extended: &'a Extended<'a, T>,
    pub(super) paths: &'a Paths<T>,
    pub(super) confidence: Option<&'a [T]>,
    pub(super) translation: Option<&'a [T]>,
    pub(super) library: Option<Library<T>>,
    /// Lower bounds of the candidates' distances, per group of joints; empty if unused.
    pub(super) bounds: Vec<Bounds<T>>,
    pub(super) reach: Reach,
    pub(super) frames: usize,
}

impl<T: Real> Clip<'_, T> {
    /// Frames per tile: as many as fit in the cache, but at least twice the surroundings loaded with it.
    pub(super) fn tile_length(&self) -> usize {
        let row = self.extended.joints() * 4 * size_of::<T>();
        let fitting = (TILE_BYTES / row).clamp(TILE_FRAMES.start, TILE_FRAMES.end);
        let around = if self.reach.added {
            self.reach.back + self.reach.ahead + self.reach.before + self.reach.after
        } else {
            0
        };
        fitting.max(2 * around).next_multiple_of(LANE)
    }
}

/// Pairs `(u, u + lag)` of frames, as indices of planes, and the frames of the tile that use them.
#[derive(Debug)]
pub(super) struct Piece {
    /// The earlier frames of the pairs.
    pub(super) pairs: Range<usize>,
    /// Frames of the tile for which the later frame is the candidate.
    pub(super) forward: Option<Side>,
    /// Frames of the tile for which the earlier frame is the candidate.
    pub(super) backward: Option<Side>,
}

/// Some pairs of a [`Piece`], and the frames of the tile that they belong to.
#[derive(Debug)]
pub(super) struct Side {
    /// Relative to the first pair.
    pub(super) pairs: Range<usize>,
    /// Relative to the tile's first frame.
    pub(super) frames: Range<usize>,
}

/// Scratch memory, reused from tile to tile: fresh pages cost as much as the arithmetic.
#[derive(Debug, Default)]
pub(super) struct Buffers<T> {
    planes: Planes<T>,
    sums: Planes<T>,
    forward: Planes<T>,
    backward: Planes<T>,
    rows: Vec<[T; 4]>,
    scratch: Scratch<T>,
}

/// A tile and its surroundings, as planes.
#[derive(Debug)]
pub(super) struct Tile<'a, T> {
    pub(super) clip: &'a Clip<'a, T>,
    /// Number of frames of the tile.
    pub(super) frames: usize,
    /// Index of the tile's first frame in the planes.
    pub(super) at: usize,
    /// Indices of the candidates in the planes.
    pub(super) candidates: Range<usize>,
    /// Per joint: half rotation vectors (fixed chart) or unit quaternions (local chart).
    pub(super) planes: Planes<T>,
    /// Index of the first plane of each joint.
    pub(super) rows: Vec<usize>,
    /// Confidence per joint.
    pub(super) confidence: Option<Planes<T>>,
    /// Translation, 3 planes.
    pub(super) translation: Option<Planes<T>>,
}

impl<'a, T: Real> Tile<'a, T> {
    /// Loads the frames `first..end` of the clip with the surroundings that the window needs.
    pub(super) fn new(clip: &'a Clip<'a, T>, first: usize, end: usize, buffers: &mut Buffers<T>) -> Self {
        let Reach { back, ahead, before, after, pad, added } = clip.reach;
        let joints = clip.extended.joints();
        let from = (pad + first).saturating_sub(back + before);
        let to = (pad + end + ahead + after).min(clip.extended.frames());
        let own = if added { 0..clip.extended.frames() } else { pad..pad + clip.frames };
        let mut rows = Vec::with_capacity(joints);
        let mut count = 0;
        for chart in &clip.paths.charts {
            rows.push(count);
            count += if *chart == JointChart::Local { 4 } else { 3 };
        }
        // The last lane of the tile may extend past the loaded frames; its samples there are never used.
        let mut planes = std::mem::take(&mut buffers.planes);
        planes.reshape(count, to - from + LANE);
        buffers.rows.resize(LANE * joints, [T::ZERO; 4]);
        for (at, block) in clip.extended.blocks(from..to) {
            let (samples, _) = block.as_chunks::<4>();
            load(clip.paths, &mut planes, &rows, samples, at, at - from, &mut buffers.rows);
        }
        let values = |source: &[T], columns: usize, slope: bool, boundary: Boundary| {
            let mut planes = Planes::new(columns, to - from + LANE);
            for column in 0..columns {
                for (i, value) in planes.row_mut(column)[..to - from].iter_mut().enumerate() {
                    let frame = (from + i).cast_signed() - pad.cast_signed();
                    *value = extended_number(source, columns, column, frame, boundary, slope);
                }
            }
            planes
        };
        let boundary = clip.filter.boundary;
        Self {
            clip,
            frames: end - first,
            at: pad + first - from,
            candidates: own.start.max(from) - from..own.end.min(to) - from,
            planes,
            rows,
            confidence: clip.confidence.map(|c| values(c, joints, false, boundary)),
            translation: clip.translation.map(|t| values(t, 3, true, boundary)),
        }
    }

    /// Filters the tile into `out`, `(frames, joints, 4)`, and the translation into `moved`.
    ///
    /// Returns whether the sign of a rotation changes from one frame to the next.
    pub(super) fn filter(
        self,
        out: &mut [T],
        moved: &mut [T],
        buffers: &mut Buffers<T>,
        interrupt: &Interrupt,
    ) -> Result<bool, Error> {
        let joints = self.rows.len();
        let mut means = Means::new(&self, std::mem::take(&mut buffers.sums));
        for (index, group) in self.clip.filter.groups(joints).into_iter().enumerate() {
            means.begin(group.clone());
            match self.clip.filter.neighbors {
                None => {
                    self.add_all(&mut PatchDistances::new(&self, group), &mut means, buffers, interrupt)?
                }
                Some(count) => {
                    let scratch = &mut buffers.scratch;
                    self.add_nearest(count, index, group, &mut means, scratch, interrupt)?;
                }
            }
            means.settle();
        }
        let turned = means.store(out, moved, &mut buffers.rows);
        buffers.sums = means.into_sums();
        buffers.planes = self.planes;
        Ok(turned)
    }

    /// Adds all candidates of the window, a block of lags at a time.
    fn add_all(
        &self,
        distances: &mut PatchDistances<'_, T>,
        means: &mut Means<'_, T>,
        buffers: &mut Buffers<T>,
        interrupt: &Interrupt,
    ) -> Result<(), Error> {
        let padded = self.frames.next_multiple_of(LANE);
        let Buffers { forward, backward, .. } = buffers;
        forward.reshape(BLOCK_LAGS, padded);
        backward.reshape(BLOCK_LAGS, padded);
        let back = self.clip.reach.back;
        for first in (1..=back).step_by(BLOCK_LAGS) {
            interrupt.check()?;
            let lags = BLOCK_LAGS.min(back + 1 - first);
            for l in 0..lags {
                forward.row_mut(l).fill(T::ZERO);
                backward.row_mut(l).fill(T::ZERO);
                for piece in self.pieces(first + l) {
                    let weights = distances.weights(first + l, piece.pairs.clone());
                    for (side, row) in
                        [(&piece.forward, forward.row_mut(l)), (&piece.backward, backward.row_mut(l))]
                    {
                        if let Some(side) = side {
                            row[side.frames.clone()].copy_from_slice(&weights[side.pairs.clone()]);
                        }
                    }
                    means.add_local(distances, &piece, first + l);
                }
                means.note(forward.row(l));
                means.note(backward.row(l));
            }
            means.add_block(first, lags, forward, backward);
        }
        Ok(())
    }

    /// The pairs of one lag that the tile needs, each computed once.
    pub(super) fn pieces(&self, lag: usize) -> Vec<Piece> {
        let (at, end) = (self.at, self.at + self.frames);
        let Range { start: low, end: high } = self.candidates;
        // Later candidates of frames t, as pairs (t, t + lag); earlier ones as pairs (t − lag, t).
        let ahead = if lag <= self.clip.reach.ahead { high.saturating_sub(lag) } else { 0 };
        let later = (at < end.min(ahead)).then(|| at..end.min(ahead));
        let earlier = (at.max(low + lag) < end).then(|| at.max(low + lag) - lag..end - lag);
        let side = |pairs: &Range<usize>, from: usize, lag: usize| Side {
            pairs: pairs.start - from..pairs.end - from,
            frames: pairs.start + lag - at..pairs.end + lag - at,
        };
        match (earlier, later) {
            (Some(earlier), Some(later)) if earlier.end >= later.start => vec![Piece {
                forward: Some(side(&later, earlier.start, 0)),
                backward: Some(side(&earlier, earlier.start, lag)),
                pairs: earlier.start..later.end,
            }],
            (earlier, later) => {
                let earlier = earlier.map(|e| Piece {
                    forward: None,
                    backward: Some(side(&e, e.start, lag)),
                    pairs: e,
                });
                let later =
                    later.map(|l| Piece { forward: Some(side(&l, l.start, 0)), backward: None, pairs: l });
                earlier.into_iter().chain(later).collect()
            }
        }
    }
}

/// Loads a block of rows, which starts at the extended frame `frame`, into the planes from `at`.
fn load<T: Real>(
    paths: &Paths<T>,
    planes: &mut Planes<T>,
    rows: &[usize],
    samples: &[[T; 4]],
    frame: usize,
    at: usize,
    buffer: &mut [[T; 4]],
) {
    let joints = rows.len();
    // Rows are copied in order to a buffer that stays in the cache, and transposed there.
    for (chunk, samples) in samples.chunks(LANE * joints).enumerate() {
        let width = samples.len() / joints;
        let buffer = &mut buffer[..samples.len()];
        let start = chunk * LANE;
        kernels::copy_signed(samples, paths.flips(frame + start..frame + start + width), buffer);
        let range = at + start..at + start + width;
        for (joint, &row) in rows.iter().enumerate() {
            match paths.charts[joint] {
                JointChart::Fixed(centre) => {
                    let [x, y, z] = planes.rows_mut::<3>(row).map(|plane| &mut plane[range.clone()]);
                    kernels::load_fixed(&buffer[joint..], joints, conjugate_one(centre), x, y, z);
                }
                JointChart::Local => {
                    let [w, x, y, z] = planes.rows_mut::<4>(row).map(|plane| &mut plane[range.clone()]);
                    kernels::load_local(&buffer[joint..], joints, w, x, y, z);
                }
            }
        }
    }
}
