//! All diagonals between a block of frames and a block of candidates, or those that matter.
//!
//! With complete samples a patch distance `D` obeys the triangle inequality: no candidate within `h` frames of `s` is nearer
//! to `t` than `D(t, s) − S_h(s)`, where `S_h(s)` is the largest distance from `s` to a patch at most `h` frames away. So one
//! diagonal in 81 is measured for all frames. Where the bound lies beyond the nearest candidates that are known, the 80
//! diagonals around it are passed over; elsewhere the same is asked of blocks of 27, of 9 and of 3. Nothing is lost: what is kept is
//! what measuring all diagonals would have kept, to the last bit.

use super::diagonal::{Diagonal, Measure};
use super::features::Side;
use super::kernels;
use super::nearest::Nearest;
use super::spread::{HALVES, Spreads};
use crate::clip::Planes;
use crate::parallel::Interrupt;
use crate::{Error, Real};
use std::ops::{Range, RangeInclusive};

/// Frames without a candidate that matters which a run may hold: every run measures a patch more than it has frames.
const LARGEST_HOLE: usize = 16;

/// Roundings, in units of the last place, by which distances may break the triangle inequality: those of a hundred terms.
const ROUNDINGS: f64 = 256.0;

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
    /// Distances of the middle diagonal of each of the widest blocks.
    coarse: Planes<T>,
    /// Those of diagonals within blocks, per level.
    fine: [Vec<T>; HALVES.len()],
}

/// The frames whose neighbours are sought, the candidates, and how they are compared.
#[derive(Debug)]
pub(crate) struct Join<'a, T> {
    pub(crate) measure: &'a Measure<T>,
    pub(crate) frames: Side<'a, T>,
    pub(crate) candidates: Side<'a, T>,
    pub(crate) lags: Lags,
    /// Where they are given, diagonals that do not matter are passed over; the samples must be complete, and the planes
    /// of the candidates reach [`MARGIN`](super::spread::MARGIN) frames farther than the patches.
    pub(crate) spreads: Option<&'a Spreads<T>>,
}

impl<T: Real> Join<'_, T> {
    /// Offers to `nearest`, which knows the frames as 0, 1, …, whatever candidate may be among the nearest.
    pub(crate) fn run(
        &self,
        nearest: &mut Nearest<T>,
        scratch: &mut Scratch<T>,
        interrupt: &Interrupt,
    ) -> Result<(), Error> {
        // Diagonals count from the first frame and the first candidate of the blocks.
        let shift = self.shift();
        let last_frame = self.frames.count.cast_signed() - 1;
        let last_candidate = self.candidates.count.cast_signed() - 1;
        let low = (-last_frame).max(self.lags.within.start().saturating_sub(shift));
        let high = last_candidate.min(self.lags.within.end().saturating_sub(shift));
        if low > high || last_frame < 0 {
            return Ok(());
        }
        if let Some(spreads) = self.spreads {
            return self.pass_over(low, high, spreads, nearest, scratch, interrupt);
        }
        for lag in (low..=high).filter(|lag| self.lags.count(lag + shift)) {
            interrupt.check()?;
            let range = self.meeting(lag, 0);
            let Scratch { diagonal, distances, marks, .. } = scratch;
            distances.resize(range.len(), T::ZERO);
            self.measure(diagonal, lag, range.start, distances);
            self.offer(nearest, marks, lag, range.start, distances);
        }
        Ok(())
    }

    /// The lag between the numbers of the first candidate and the first frame.
    fn shift(&self) -> isize {
        self.candidates.first.cast_signed() - self.frames.first.cast_signed()
    }

    /// The frames that meet a candidate on a diagonal, or a patch at most `margin` frames beyond the candidates.
    fn meeting(&self, lag: isize, margin: usize) -> Range<usize> {
        let margin = margin.cast_signed();
        let last = (self.candidates.count.cast_signed() + margin - lag).max(0).cast_unsigned();
        let first = (-margin - lag).max(0).cast_unsigned();
        first..last.min(self.frames.count).max(first)
    }

    /// Measures a diagonal from a frame.
    fn measure(&self, diagonal: &mut Diagonal<T>, lag: isize, first: usize, out: &mut [T]) {
        let (a, b) = (&self.frames, &self.candidates);
        let at = [a.at + first, (b.at + first).wrapping_add_signed(lag)];
        diagonal.measure(self.measure, &a.features, &b.features, at, out);
    }

    /// Offers the candidates of a diagonal, measured from a frame.
    fn offer(
        &self,
        nearest: &mut Nearest<T>,
        marks: &mut Vec<u8>,
        lag: isize,
        first: usize,
        distances: &[T],
    ) {
        let inside = self.meeting(lag, 0);
        let (from, to) = (first.max(inside.start), (first + distances.len()).min(inside.end));
        if from >= to || !self.lags.count(lag + self.shift()) {
            return;
        }
        let distances = &distances[from - first..to - first];
        marks.resize(to - from, 0);
        if !kernels::mark_nearest(marks, distances, &nearest.limits()[from..to]) {
            return;
        }
        let number = (self.candidates.first + from).wrapping_add_signed(lag);
        for (i, distance) in distances.iter().enumerate() {
            if marks[i] != 0 {
                nearest.offer(from + i, *distance, number + i);
            }
        }
    }

    /// Measures one diagonal of each block, and of the others those that matter.
    fn pass_over(
        &self,
        low: isize,
        high: isize,
        spreads: &Spreads<T>,
        nearest: &mut Nearest<T>,
        scratch: &mut Scratch<T>,
        interrupt: &Interrupt,
    ) -> Result<(), Error> {
        let half = HALVES[0];
        let mut middles: Vec<isize> =
            (low + half.cast_signed()..=high + half.cast_signed()).step_by(2 * half + 1).collect();
        // Near candidates first, for they are often the nearest, and the others are then passed over.
        middles.sort_by_key(|middle| (middle + self.shift()).unsigned_abs());
        let Scratch { diagonal, coarse, fine, marks, .. } = scratch;
        coarse.reshape(middles.len(), self.frames.count);
        for (block, &middle) in middles.iter().enumerate() {
            interrupt.check()?;
            let range = self.meeting(middle, half);
            let row = &mut coarse.row_mut(block)[range.clone()];
            self.measure(diagonal, middle, range.start, row);
            self.offer(nearest, marks, middle, range.start, row);
        }
        for (block, &middle) in middles.iter().enumerate() {
            interrupt.check()?;
            let range = self.meeting(middle, half);
            let row = &coarse.row(block)[range.clone()];
            self.refine(0, middle, range.start, row, spreads, nearest, diagonal, marks, fine);
        }
        Ok(())
    }

    /// Measures what matters of a block of diagonals, whose middle one was measured from the frame `first`.
    #[allow(clippy::too_many_arguments, reason = "parts of one scratch, borrowed apart")]
    fn refine(
        &self,
        level: usize,
        middle: isize,
        first: usize,
        distances: &[T],
        spreads: &Spreads<T>,
        nearest: &mut Nearest<T>,
        diagonal: &mut Diagonal<T>,
        marks: &mut Vec<u8>,
        fine: &mut [Vec<T>],
    ) {
        let Some((own, deeper)) = fine.split_first_mut() else { return };
        let margin = HALVES[0];
        let from = (first + margin).wrapping_add_signed(middle);
        let spread = &spreads.level(level)[from..from + distances.len()];
        let limits = &nearest.limits()[first..first + distances.len()];
        marks.resize(distances.len(), 0);
        let keep = T::from_f64(1.0 - ROUNDINGS * T::EPSILON.to_f64());
        if !kernels::mark_near(marks, distances, spread, limits, keep) {
            return;
        }
        let inner = HALVES.get(level + 1).copied().unwrap_or(0);
        let step = (2 * inner + 1).cast_signed();
        for run in runs(marks) {
            if level + 1 < HALVES.len() {
                let known = &distances[run.clone()];
                self.refine(
                    level + 1,
                    middle,
                    first + run.start,
                    known,
                    spreads,
                    nearest,
                    diagonal,
                    marks,
                    deeper,
                );
            }
            for lag in [middle - step, middle + step] {
                let reach = self.meeting(lag, inner);
                let range = (first + run.start).max(reach.start)..(first + run.end).min(reach.end);
                if range.is_empty() {
                    continue;
                }
                own.resize(range.len(), T::ZERO);
                self.measure(diagonal, lag, range.start, own);
                self.offer(nearest, marks, lag, range.start, own);
                self.refine(level + 1, lag, range.start, own, spreads, nearest, diagonal, marks, deeper);
            }
        }
    }
}

/// The runs of marks, across holes of at most [`LARGEST_HOLE`].
fn runs(marks: &[u8]) -> Vec<Range<usize>> {
    let mut runs: Vec<Range<usize>> = Vec::new();
    for (i, mark) in marks.iter().enumerate() {
        if *mark == 0 {
            continue;
        }
        match runs.last_mut() {
            Some(run) if i - run.end <= LARGEST_HOLE => run.end = i + 1,
            _ => runs.push(i..i + 1),
        }
    }
    runs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_go_across_small_holes() {
        let mut marks = vec![0; 100];
        for i in [3, 4, 20, 37, 60, 99] {
            marks[i] = 1;
        }
        assert_eq!(runs(&marks), [3..38, 60..61, 99..100]);
    }
}
