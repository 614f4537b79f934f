//! All pairs between a block of frames and a block of candidates, or those that matter.
//!
//! With complete samples, most pairs are farther apart than the nearest candidates that are known by a bound that takes little
//! time. What is left is measured along its diagonals. Nothing is lost: what is kept is what measuring all pairs would have kept,
//! to the last bit.

use super::bounds::{Bounds, COLUMNS, ROWS, Strip};
use super::diagonal::{Diagonal, Measure};
use super::features::Side;
use super::nearest::Lists;
use crate::parallel::Interrupt;
use crate::{Error, Real};
use std::ops::{Range, RangeInclusive};

/// Frames without a candidate that matters which a run may hold: every run measures a patch more than it has frames.
const LARGEST_HOLE: usize = 16;

/// Which candidates of a frame count, by their number less that of the frame.
#[derive(Debug, Clone)]
pub(crate) struct Lags {
    /// The lags that count.
    pub(crate) within: RangeInclusive<isize>,
    /// Of those, the ones left out.
    pub(crate) without: RangeInclusive<isize>,
}

impl Lags {
    /// Candidates of another motion, all of which count.
    pub(crate) fn all() -> Self {
        #[allow(clippy::reversed_empty_ranges, reason = "none is left out")]
        Self { within: isize::MIN..=isize::MAX, without: 1..=0 }
    }

    fn count(&self, lag: isize) -> bool {
        self.within.contains(&lag) && !self.without.contains(&lag)
    }
}

/// Memory that goes from block to block.
#[derive(Debug, Default)]
pub(crate) struct Scratch<T> {
    diagonal: Diagonal<T>,
    marks: Vec<u8>,
    distances: Vec<T>,
    strip: Strip<T>,
    /// Pairs of frames and candidates, by diagonals.
    pairs: Vec<u64>,
}

/// The frames whose neighbours are sought, the candidates, and how they are compared.
#[derive(Debug)]
pub(crate) struct Join<'a, T> {
    pub(crate) measure: &'a Measure<T>,
    pub(crate) frames: Side<'a, T>,
    pub(crate) candidates: Side<'a, T>,
    pub(crate) lags: Lags,
    /// Of these candidates: where they are given, pairs that do not matter are passed over; the samples must be complete.
    pub(crate) bounds: Option<&'a Bounds<T>>,
    /// Whether the candidates look for neighbours among the frames too: then of a clip whose frames are both, each pair is
    /// looked at once. Bounds must be given.
    pub(crate) mutual: bool,
}

impl<T: Real> Join<'_, T> {
    /// Offers to the frames whatever candidate may be among the nearest, and the other way round if they are mutual.
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

    /// The diagonals, from the first frame and the first candidate of the blocks.
    fn lags(&self) -> Option<RangeInclusive<isize>> {
        let last_frame = self.frames.count.cast_signed() - 1;
        let last_candidate = self.candidates.count.cast_signed() - 1;
        let low = (-last_frame).max(self.lags.within.start().saturating_sub(self.shift()));
        let high = last_candidate.min(self.lags.within.end().saturating_sub(self.shift()));
        if low > high || last_frame < 0 { None } else { Some(low..=high) }
    }

    /// The lag between the numbers of the first candidate and the first frame.
    fn shift(&self) -> isize {
        self.candidates.first.cast_signed() - self.frames.first.cast_signed()
    }

    /// The frames that meet a candidate on a diagonal.
    fn meeting(&self, lag: isize) -> Range<usize> {
        let last = (self.candidates.count.cast_signed() - lag).max(0).cast_unsigned();
        let first = (-lag).max(0).cast_unsigned();
        first..last.min(self.frames.count).max(first)
    }

    /// Measures a diagonal from a frame.
    fn measure(&self, diagonal: &mut Diagonal<T>, lag: isize, first: usize, out: &mut [T]) {
        let (a, b) = (&self.frames, &self.candidates);
        let at = [a.at + first, (b.at + first).wrapping_add_signed(lag)];
        diagonal.measure(self.measure, &a.features, &b.features, at, out);
    }

    /// Measures the pairs that may be near enough.
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
                // Both of a pair are frames of the strip itself.
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

    /// Offers the candidates of some frames on a diagonal.
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

    /// Offers a few candidates to frames that do not have enough yet, to know early how near the nearest are. Mutual joins need
    /// it done for all frames before.
    pub(crate) fn prepare(&self, lists: &Lists<T>, scratch: &mut Scratch<T>) {
        if let Some(lags) = self.lags() {
            for start in (0..self.frames.count).step_by(ROWS) {
                self.seed(&lags, &(start..self.frames.count.min(start + ROWS)), lists, scratch);
            }
        }
    }

    /// Offers the candidates nearest in time, which often are the nearest, and where there are not enough, some of all.
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

    /// The tiles of candidates that count for one of the frames, those nearest in time first.
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
        // Of the pairs of two strips of the same candidates, one of both looks at them: half of them each, as on a circle.
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

/// What lags in a [`pack`] are counted from.
const ORIGIN: isize = 1 << 31;

/// A lag and a frame as a number, in order of lags, then of frames: such numbers are fast to sort.
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

/// The runs of frames on a diagonal, across holes of at most [`LARGEST_HOLE`], among packed pairs in order.
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
