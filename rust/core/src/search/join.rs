//! Patch distances between a block of frames and a block of candidates: all pairs, or those that may matter.
//!
//! If no sample is missing, a cheap lower bound rejects most pairs: they are farther apart than the nearest
//! candidates found so far. The distances of the remaining pairs are computed along their diagonals. The result
//! equals that of computing all pairs, to the last bit.

use super::bounds::{Bounds, COLUMNS, ROWS, Strip};
use super::diagonal::{Diagonal, Measure};
use super::features::Side;
use super::nearest::Lists;
use crate::parallel::Interrupt;
use crate::{Error, Real};
use std::ops::{Range, RangeInclusive};

/// Longest gap, in frames, that a run of frames bridges: each run costs one patch length more than its number of
/// frames.
const LARGEST_HOLE: usize = 16;

/// The range of lags, candidate index minus frame index, that are compared.
#[derive(Debug, Clone)]
pub(crate) struct Lags {
    /// The lags that are compared,
    pub(crate) within: RangeInclusive<isize>,
    /// except for these.
    pub(crate) without: RangeInclusive<isize>,
}

impl Lags {
    /// All lags: candidates of another motion.
    pub(crate) fn all() -> Self {
        #[allow(clippy::reversed_empty_ranges, reason = "none is left out")]
        Self { within: isize::MIN..=isize::MAX, without: 1..=0 }
    }

    fn count(&self, lag: isize) -> bool {
        self.within.contains(&lag) && !self.without.contains(&lag)
    }
}

/// Scratch memory, reused from block to block.
#[derive(Debug, Default)]
pub(crate) struct Scratch<T> {
    diagonal: Diagonal<T>,
    marks: Vec<u8>,
    distances: Vec<T>,
    strip: Strip<T>,
    /// Surviving pairs of frames and candidates, packed, in order of diagonals.
    pairs: Vec<u64>,
}

/// The query frames, the candidates, and the patch distance.
#[derive(Debug)]
pub(crate) struct Join<'a, T> {
    pub(crate) measure: &'a Measure<T>,
    pub(crate) frames: Side<'a, T>,
    pub(crate) candidates: Side<'a, T>,
    pub(crate) lags: Lags,
    /// Bound data of the candidates. If given, pairs that cannot matter are skipped; no sample may be missing.
    pub(crate) bounds: Option<&'a Bounds<T>>,
    /// Whether the candidates need neighbours among the frames too. Then each pair of frames of a clip is compared
    /// once. Requires `bounds`.
    pub(crate) mutual: bool,
}

impl<T: Real> Join<'_, T> {
    /// Offers to each frame all candidates that may be among its nearest; if `mutual`, also the frames to the
    /// candidates.
    pub(crate) fn run(
        &self,
        lists: &Lists<T>,
        scratch: &mut Scratch<T>,
        interrupt: &Interrupt,
    ) -> Result<(), Error> {
        let Some(lags) = self.lags() else { return Ok(()) };
        if let Some(bounds) = self.bounds
            && bounds.apply_to(&self.frames.features)
        {
            return self.sift(&lags, bounds, lists, scratch, interrupt);
        }
        for lag in lags.filter(|lag| self.lags.count(lag + self.shift())) {
            interrupt.check()?;
            self.look(lag, self.meeting(lag), false, lists, scratch);
        }
        Ok(())
    }

    /// The range of diagonals, relative to the first frame and the first candidate of the blocks.
    fn lags(&self) -> Option<RangeInclusive<isize>> {
        let last_frame = self.frames.count.cast_signed() - 1;
        let last_candidate = self.candidates.count.cast_signed() - 1;
        let low = (-last_frame).max(self.lags.within.start().saturating_sub(self.shift()));
        let high = last_candidate.min(self.lags.within.end().saturating_sub(self.shift()));
        if low > high || last_frame < 0 { None } else { Some(low..=high) }
    }

    /// Index of the first candidate minus index of the first frame.
    fn shift(&self) -> isize {
        self.candidates.first.cast_signed() - self.frames.first.cast_signed()
    }

    /// The frames that have a candidate on a diagonal.
    fn meeting(&self, lag: isize) -> Range<usize> {
        let last = (self.candidates.count.cast_signed() - lag).max(0).cast_unsigned();
        let first = (-lag).max(0).cast_unsigned();
        first..last.min(self.frames.count).max(first)
    }

    /// Computes the distances along a diagonal, from the frame `first` on.
    fn measure(&self, diagonal: &mut Diagonal<T>, lag: isize, first: usize, out: &mut [T]) {
        let (a, b) = (&self.frames, &self.candidates);
        let at = [a.at + first, (b.at + first).wrapping_add_signed(lag)];
        diagonal.measure(self.measure, &a.features, &b.features, at, out);
    }

    /// Computes the distances of the pairs that survive the bounds.
    fn sift(
        &self,
        lags: &RangeInclusive<isize>,
        bounds: &Bounds<T>,
        lists: &Lists<T>,
        scratch: &mut Scratch<T>,
        interrupt: &Interrupt,
    ) -> Result<(), Error> {
        let mut strip = std::mem::take(&mut scratch.strip);
        let mut pairs = std::mem::take(&mut scratch.pairs);
        let (mut limits, mut others) = ([T::ZERO; ROWS], [T::ZERO; COLUMNS]);
        for start in (0..self.frames.count).step_by(ROWS) {
            let frames = start..self.frames.count.min(start + ROWS);
            let limits = &mut limits[..frames.len()];
            strip.load(bounds, self.measure, &self.frames, frames.clone());
            if !self.mutual {
                self.seed(lags, &frames, lists, scratch);
            }
            for tile in self.tiles(&frames) {
                interrupt.check()?;
                lists.read_limits(self.frames.first + start, limits);
                strip.limit(bounds, limits);
                let candidates = tile * COLUMNS..self.candidates.count.min((tile + 1) * COLUMNS);
                // The strip itself: both of a pair are already compared as frames.
                let own = self.candidates.first + candidates.start == self.frames.first + start;
                let mutual = self.mutual && !own;
                if mutual {
                    lists.read_limits(
                        self.candidates.first + candidates.start,
                        &mut others[..candidates.len()],
                    );
                } else {
                    others.fill(T::ZERO);
                }
                strip.limit_others(bounds, &others);
                pairs.clear();
                strip.sift(bounds, tile, |row, candidate| {
                    let frame = start + row;
                    let lag = candidate.cast_signed() - frame.cast_signed();
                    if lags.contains(&lag) && self.lags.count(lag + self.shift()) {
                        pairs.push(pack(lag, frame));
                    }
                });
                pairs.sort_unstable();
                for (lag, run) in runs(&pairs) {
                    self.look(lag, run, mutual, lists, scratch);
                }
            }
        }
        (scratch.strip, scratch.pairs) = (strip, pairs);
        Ok(())
    }

    /// Computes the distances of a range of frames on a diagonal, and offers them.
    fn look(
        &self,
        lag: isize,
        frames: Range<usize>,
        mutual: bool,
        lists: &Lists<T>,
        scratch: &mut Scratch<T>,
    ) {
        let Scratch { diagonal, distances, marks, .. } = scratch;
        distances.resize(frames.len(), T::ZERO);
        self.measure(diagonal, lag, frames.start, distances);
        let frame = self.frames.first + frames.start;
        let candidate = (self.candidates.first + frames.start).wrapping_add_signed(lag);
        lists.offer(frame, candidate, distances, marks);
        if mutual {
            lists.offer(candidate, frame, distances, marks);
        }
    }

    /// Offers a few candidates to frames that have fewer than `count`, so that limits are small from the start.
    /// Mutual joins require this for all frames beforehand.
    pub(crate) fn prepare(&self, lists: &Lists<T>, scratch: &mut Scratch<T>) {
        if let Some(lags) = self.lags() {
            for start in (0..self.frames.count).step_by(ROWS) {
                self.seed(&lags, &(start..self.frames.count.min(start + ROWS)), lists, scratch);
            }
        }
    }

    /// Offers the candidates nearest in time, which are often the most similar. Where these are too few, offers
    /// evenly spaced candidates.
    fn seed(
        &self,
        lags: &RangeInclusive<isize>,
        frames: &Range<usize>,
        lists: &Lists<T>,
        scratch: &mut Scratch<T>,
    ) {
        let (shift, without) = (self.shift(), &self.lags.without);
        let low = (*lags.start()).max(1 - frames.end.cast_signed());
        let high = (*lags.end()).min(self.candidates.count.cast_signed() - 1 - frames.start.cast_signed());
        let count = lists.count().cast_signed();
        let near = (0..count).flat_map(|i| [without.end() + 1 + i - shift, without.start() - 1 - i - shift]);
        let step = ((high - low) / (2 * count.max(1))).max(1).cast_unsigned();
        let spaced = (low..=high).step_by(step);
        let mut limits = [T::ZERO; ROWS];
        let limits = &mut limits[..frames.len()];
        for lag in near.chain(spaced) {
            if !(low..=high).contains(&lag) || !self.lags.count(lag + shift) {
                continue;
            }
            lists.read_limits(self.frames.first + frames.start, limits);
            if limits.iter().all(|limit| limit.is_finite()) {
                return;
            }
            let range = self.meeting(lag);
            let range = range.start.max(frames.start)..range.end.min(frames.end);
            if !range.is_empty() {
                self.look(lag, range, false, lists, scratch);
            }
        }
    }

    /// The tiles with candidates for at least one of the frames, nearest in time first.
    fn tiles(&self, frames: &Range<usize>) -> Vec<usize> {
        let Lags { within, without } = &self.lags;
        let lag =
            |tile: usize, frame: usize| self.shift() + (tile * COLUMNS).cast_signed() - frame.cast_signed();
        let mut tiles: Vec<usize> = (0..self.candidates.count.div_ceil(COLUMNS))
            .filter(|&tile| {
                let lowest = lag(tile, frames.end - 1);
                let highest = lag(tile + 1, frames.start) - 1;
                let left_out = without.contains(&lowest) && without.contains(&highest);
                highest >= *within.start() && lowest <= *within.end() && !left_out
            })
            .collect();
        // Each pair of two strips of the same clip is compared once. Every strip takes the half of the others ahead
        // of it, as on a circle.
        let count = self.candidates.count.div_ceil(COLUMNS);
        let own = (self.frames.first + frames.start).checked_sub(self.candidates.first);
        if let Some(own) = own.map(|own| own / COLUMNS).filter(|own| self.mutual && *own < count) {
            tiles.retain(|&tile| {
                let ahead = (tile + count - own) % count;
                2 * ahead < count || (2 * ahead == count && own < tile)
            });
        }
        tiles.sort_by_key(|&tile| lag(tile, frames.start).unsigned_abs());
        tiles
    }
}

/// Offset of the lags in a [`pack`].
const ORIGIN: isize = 1 << 31;

/// A lag and a frame as one integer that sorts by lag, then by frame. Such integers are fast to sort.
fn pack(lag: isize, frame: usize) -> u64 {
    ((lag + ORIGIN).cast_unsigned() as u64) << 32 | frame as u64
}

#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    reason = "halves of a number of 64 bits"
)]
fn unpack(pair: u64) -> (isize, usize) {
    ((pair >> 32) as isize - ORIGIN, (pair & u64::from(u32::MAX)) as usize)
}

/// The runs of frames on each diagonal in sorted packed pairs. A run bridges gaps of at most [`LARGEST_HOLE`].
fn runs(pairs: &[u64]) -> Vec<(isize, Range<usize>)> {
    let mut runs: Vec<(isize, Range<usize>)> = Vec::new();
    for &pair in pairs {
        let (lag, frame) = unpack(pair);
        match runs.last_mut() {
            Some((last, run)) if *last == lag && frame - run.end <= LARGEST_HOLE => run.end = frame + 1,
            _ => runs.push((lag, frame..frame + 1)),
        }
    }
    runs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_go_across_small_holes() {
        let pairs = [(-1, 99), (2, 3), (2, 4), (2, 20), (2, 37), (2, 60), (3, 61)];
        let pairs = pairs.map(|(lag, frame)| pack(lag, frame));
        assert_eq!(runs(&pairs), [(-1, 99..100), (2, 3..38), (2, 60..61), (3, 61..62)]);
    }
}
