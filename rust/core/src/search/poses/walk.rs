//! Search from frame to frame: the nearest segments of one frame lie near those of the next.
//!
//! J. Chai and J. K. Hodgins, "Performance animation from low-dimensional control signals", 2005: the nearest of a frame lie near those
//! of the frame before. From them and their successors the search goes on to the neighbours of the nearest that is known, in the graph and
//! in time, as long as that leads nearer than the last of a list that is longer than what is sought (Y. A. Malkov and D. A. Yashunin,
//! "Efficient and robust approximate nearest neighbor search using hierarchical navigable small world graphs", 2020, algorithm 2).
//! What was lost on the way is found again by full searches, at the start, in regular intervals, and where the last of the
//! nearest is farther than it was.

use super::graph::Graph;
use super::{Best, Index, Probe, Segments, kernels};
use crate::error::check_length;
use crate::{Error, Real};
use std::ops::Range;

/// When the results of a walk are not enough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fallback {
    /// Frames after a full search until the next; 0: each frame has one.
    pub frames: usize,
    /// How many times as far as it was at best since the last full search the last of the nearest segments may be.
    pub ratio: f64,
}

/// What all searches along a motion share.
#[derive(Debug, Clone, Copy)]
pub struct Database<'a, T> {
    /// The candidates.
    pub segments: &'a Segments<'a, T>,
    /// Their index.
    pub index: &'a Index<T>,
    /// Their neighbours.
    pub graph: Graph<'a>,
}

/// A search along a motion.
#[derive(Debug)]
pub struct Walk<T> {
    /// How many are sought.
    count: usize,
    fallback: Fallback,
    /// As many as are gone out from.
    best: Best<T>,
    probe: Probe<T>,
    /// Those of the frame before.
    before: Vec<usize>,
    /// Frames since the last full search; `None`: there was none.
    since: Option<usize>,
    /// The least squared distance to the last of the nearest since the last full search.
    least: T,
    /// A bit for each pose that was measured in this frame.
    seen: Vec<u64>,
    /// A bit for each whose neighbours were.
    left: Vec<u64>,
    /// Where there are such bits.
    touched: Vec<usize>,
    firsts: Vec<u32>,
    squares: Vec<T>,
}

impl<T: Real> Walk<T> {
    /// A search for the `count` nearest segments in each frame, which goes out from the `breadth` nearest that it knows, at least
    /// `count`.
    #[must_use]
    pub fn new(count: usize, breadth: usize, fallback: Fallback) -> Self {
        Self {
            count,
            fallback,
            best: Best::new(breadth.max(count)),
            probe: Probe::new(&[]),
            before: Vec::new(),
            since: None,
            least: T::ZERO,
            seen: Vec::new(),
            left: Vec::new(),
            touched: Vec::new(),
            firsts: Vec::new(),
            squares: Vec::new(),
        }
    }

    /// Forgets the frames before: the next frame has a full search.
    pub fn reset(&mut self) {
        self.since = None;
    }

    /// Finds the segments that are nearest to `query`, `(length, dims)` in C order, but for those that are `excluded`: the first of
    /// those that are returned.
    ///
    /// Says whether there was a full search.
    ///
    /// # Errors
    /// [`Error::Length`] if the query is of another length than the segments.
    pub fn next(
        &mut self,
        database: Database<'_, T>,
        query: &[T],
        excluded: &Range<usize>,
    ) -> Result<(&Best<T>, bool), Error> {
        let Database { segments, index, .. } = database;
        check_length("query", segments.width(), query.len())?;
        self.probe.set(query);
        self.best.clear();
        if !self.probe.is_finite() {
            self.since = None;
            return Ok((&self.best, false));
        }
        let walked = self.since.is_some_and(|since| since < self.fallback.frames);
        if walked {
            self.go(database, excluded);
        }
        let ratio = T::from_f64(self.fallback.ratio);
        let kept = walked
            && self
                .last()
                .is_some_and(|square| !ratio.is_finite() || square.sqrt() <= self.least.sqrt() * ratio);
        if !kept {
            let made = index.query(query, segments.dims(), excluded.clone());
            let bests = std::slice::from_mut(&mut self.best);
            index.search(segments, &[made], bests, &mut self.squares);
        }
        if let Some(square) = self.last() {
            self.least = if kept { self.least.min(square) } else { square };
        }
        self.since = Some(if kept { self.since.map_or(0, |since| since + 1) } else { 0 });
        self.before.clear();
        self.before.extend(self.best.found().iter().map(|found| found.1));
        Ok((&self.best, !kept))
    }

    /// The squared distance of the last of those that are sought.
    fn last(&self) -> Option<T> {
        self.best.found().get(self.count.checked_sub(1)?).map(|last| last.0)
    }

    /// Goes out from what the frame before tells of, from the nearest that is known to its neighbours, as long as that leads nearer.
    fn go(&mut self, database: Database<'_, T>, excluded: &Range<usize>) {
        let words = database.segments.poses().div_ceil(64);
        for bits in [&mut self.seen, &mut self.left] {
            bits.resize(words, 0);
        }
        self.touched.clear();
        self.firsts.clear();
        let before = std::mem::take(&mut self.before);
        for &end in &before {
            self.see(database.segments, excluded, end);
            self.see(database.segments, excluded, end + 1);
        }
        self.before = before;
        self.measure(database.segments);
        let mut at = 0;
        while let Some(&(_, end)) = self.best.found().get(at) {
            let (word, bit) = (end / 64, 1 << (end % 64));
            if self.left[word] & bit != 0 {
                at += 1;
                continue;
            }
            self.left[word] |= bit;
            let beside = [end.checked_sub(1), Some(end + 1)].into_iter().flatten();
            for neighbor in beside.chain(database.graph.of(end)) {
                self.see(database.segments, excluded, neighbor);
            }
            // All before this one have been left; what came in before it has not.
            at = at.min(self.measure(database.segments));
        }
        for &end in &self.touched {
            self.seen[end / 64] = 0;
            self.left[end / 64] = 0;
        }
    }

    /// Takes note of a candidate, unless it was seen in this frame.
    fn see(&mut self, segments: &Segments<'_, T>, excluded: &Range<usize>, end: usize) {
        let (word, bit) = (end / 64, 1 << (end % 64));
        if segments.contains(end) && self.seen[word] & bit == 0 && !excluded.contains(&end) {
            self.seen[word] |= bit;
            self.touched.push(end);
            // Those of a graph fit.
            self.firsts.extend(u32::try_from(end + 1 - segments.length()));
        }
    }

    /// Offers the candidates that were seen last, and says where the first of them that is among the nearest lies.
    fn measure(&mut self, segments: &Segments<'_, T>) -> usize {
        // In the order of the memory.
        self.firsts.sort_unstable();
        self.squares.clear();
        self.squares.resize(self.firsts.len(), T::ZERO);
        kernels::scattered(segments, &self.firsts, &self.probe, &mut self.squares);
        let mut least: Option<(T, usize)> = None;
        for (&first, &square) in self.firsts.iter().zip(&self.squares) {
            let end = first as usize + segments.length() - 1;
            self.best.offer(square, end);
            if square.is_finite() && least.is_none_or(|(other, _)| square < other) {
                least = Some((square, end));
            }
        }
        self.firsts.clear();
        let found = self.best.found();
        least.map_or(found.len(), |least| found.partition_point(|&one| one < least))
    }
}
