//! Search from frame to frame: the nearest segments of one frame lie near those of the next.
//!
//! J. Chai and J. K. Hodgins, "Performance animation from low-dimensional control signals", 2005. Candidates are the nearest of
//! the frame before, their successors, and the neighbours of both in the graph. What was lost on the way is found again by full
//! searches, at the start, in regular intervals, and where the last of the nearest is farther than it was.

use super::graph::Graph;
use super::{Best, Index, Probe, Segments, kernels};
use crate::error::check_length;
use crate::{Error, Real};
use std::ops::Range;

/// When the results of a walk are not enough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trust {
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
    trust: Trust,
    best: Best<T>,
    probe: Probe<T>,
    /// The nearest of the frame before.
    before: Vec<usize>,
    /// Frames since the last full search; `None`: there was none.
    since: Option<usize>,
    /// The least squared distance to the last of the nearest since the last full search.
    least: T,
    /// A bit for each pose that is a candidate of this frame.
    seen: Vec<u64>,
    firsts: Vec<u32>,
    squares: Vec<T>,
}

impl<T: Real> Walk<T> {
    /// A search for the `count` nearest segments in each frame.
    #[must_use]
    pub fn new(count: usize, trust: Trust) -> Self {
        Self {
            trust,
            best: Best::new(count),
            probe: Probe::new(&[]),
            before: Vec::new(),
            since: None,
            least: T::ZERO,
            seen: Vec::new(),
            firsts: Vec::new(),
            squares: Vec::new(),
        }
    }

    /// Forgets the frames before: the next frame has a full search.
    pub fn reset(&mut self) {
        self.since = None;
    }

    /// Finds the segments that are nearest to `query`, `(length, dims)` in C order, but for those that are `excluded`.
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
        let walked = self.since.is_some_and(|since| since < self.trust.frames);
        if walked {
            self.gather(database, excluded);
        }
        let ratio = T::from_f64(self.trust.ratio);
        let trusted = walked
            && self
                .best
                .limit()
                .is_some_and(|square| !ratio.is_finite() || square.sqrt() <= self.least.sqrt() * ratio);
        if !trusted {
            let made = index.query(query, segments.dims(), excluded.clone());
            let bests = std::slice::from_mut(&mut self.best);
            index.search(segments, &[made], bests, &mut self.squares);
        }
        if let Some(square) = self.best.limit() {
            self.least = if trusted { self.least.min(square) } else { square };
        }
        self.since = Some(if trusted { self.since.map_or(0, |since| since + 1) } else { 0 });
        self.before.clear();
        self.before.extend(self.best.found().iter().map(|found| found.1));
        Ok((&self.best, !trusted))
    }

    /// Offers the candidates that the frame before tells of.
    fn gather(&mut self, database: Database<'_, T>, excluded: &Range<usize>) {
        let Database { segments, graph, .. } = database;
        let words = segments.poses().div_ceil(64);
        if self.seen.len() != words {
            self.seen = vec![0; words];
        }
        self.firsts.clear();
        let first = segments.length() - 1;
        let (seen, firsts) = (&mut self.seen, &mut self.firsts);
        let mut see = |end: usize| {
            let (word, bit) = (end / 64, 1 << (end % 64));
            if segments.contains(end) && seen[word] & bit == 0 && !excluded.contains(&end) {
                seen[word] |= bit;
                // Those of a graph fit.
                firsts.extend(u32::try_from(end - first));
            }
        };
        for &before in &self.before {
            for end in [before, before + 1] {
                see(end);
                for neighbor in graph.of(end) {
                    see(neighbor);
                }
            }
        }
        // In the order of the memory.
        self.firsts.sort_unstable();
        self.squares.clear();
        self.squares.resize(self.firsts.len(), T::ZERO);
        kernels::scattered(segments, &self.firsts, &self.probe, &mut self.squares);
        for (&begin, square) in self.firsts.iter().zip(&self.squares) {
            let end = begin as usize + first;
            self.seen[end / 64] &= !(1 << (end % 64));
            self.best.offer(*square, end);
        }
    }
}
