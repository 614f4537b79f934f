//! Approximate search from frame to frame: the nearest segments of one frame lie near those of the next.
//!
//! J. Chai and J. K. Hodgins, "Performance animation from low-dimensional control signals", 2005. The search starts
//! from the neighbours of the previous frame and their successors. It then expands the nearest known segment, in the
//! graph and in time, until that yields nothing nearer than the last of a list longer than the result (Y. A. Malkov
//! and D. A. Yashunin, "Efficient and robust approximate nearest neighbor search using hierarchical navigable small
//! world graphs", 2020, algorithm 2). Full searches recover neighbours that the walk has lost: at the start, at
//! regular intervals, and when the last neighbour is farther than expected.

use super::graph::Graph;
use super::{Best, Index, Probe, Segments, kernels};
use crate::error::check_length;
use crate::{Error, Real};
use std::ops::Range;

/// When a walk falls back to a full search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fallback {
    /// Frames after a full search until the next; 0: every frame has one.
    pub frames: usize,
    /// Largest distance of the last neighbour, relative to the smallest since the last full search.
    pub ratio: f64,
}

/// Data shared by all searches along a motion.
#[derive(Debug, Clone, Copy)]
pub struct Database<'a, T> {
    /// The candidates.
    pub segments: &'a Segments<'a, T>,
    /// Their index.
    pub index: &'a Index<T>,
    /// Their graph of neighbours.
    pub graph: Graph<'a>,
}

/// A search along a motion.
#[derive(Debug)]
pub struct Walk<T> {
    /// Number of neighbours sought.
    count: usize,
    fallback: Fallback,
    /// The segments known so far, as many as are expanded.
    best: Best<T>,
    probe: Probe<T>,
    /// The neighbours of the previous frame.
    before: Vec<usize>,
    /// Frames since the last full search; `None`: there was none.
    since: Option<usize>,
    /// The least squared distance of the last neighbour since the last full search.
    least: T,
    /// One bit per pose: measured in this frame.
    seen: Vec<u64>,
    /// One bit per pose: expanded in this frame.
    left: Vec<u64>,
    /// Poses whose bits are set.
    touched: Vec<usize>,
    firsts: Vec<u32>,
    squares: Vec<T>,
}

impl<T: Real> Walk<T> {
    /// A search for the `count` nearest segments in each frame that expands the `breadth` nearest it knows, at least
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

    /// Discards the state of the previous frames: the next frame has a full search.
    pub fn reset(&mut self) {
        self.since = None;
    }

    /// Finds the segments nearest to `query`, `(length, dims)` in C order, except for the `excluded` ones. The result
    /// are the first `count` of the segments returned.
    ///
    /// Also returns whether there was a full search.
    ///
    /// # Errors
    /// [`Error::Length`] if the length of the query is not that of the segments.
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

    /// The squared distance of the last of the `count` nearest.
    fn last(&self) -> Option<T> {
        self.best.found().get(self.count.checked_sub(1)?).map(|last| last.0)
    }

    /// Starts from the neighbours of the previous frame and expands the nearest known segment until that yields
    /// nothing nearer.
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
            // All before this index have been expanded; a segment inserted before it has not.
            at = at.min(self.measure(database.segments));
        }
        for &end in &self.touched {
            self.seen[end / 64] = 0;
            self.left[end / 64] = 0;
        }
    }

    /// Adds a candidate to those to be measured, unless it was in this frame already.
    fn see(&mut self, segments: &Segments<'_, T>, excluded: &Range<usize>, end: usize) {
        let (word, bit) = (end / 64, 1 << (end % 64));
        if segments.contains(end) && self.seen[word] & bit == 0 && !excluded.contains(&end) {
            self.seen[word] |= bit;
            self.touched.push(end);
            // The conversion cannot fail: indices of a graph are 32-bit.
            self.firsts.extend(u32::try_from(end + 1 - segments.length()));
        }
    }

    /// Measures and offers the added candidates, and returns the index in the list of the nearest of them.
    fn measure(&mut self, segments: &Segments<'_, T>) -> usize {
        // In memory order.
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
