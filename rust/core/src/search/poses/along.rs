//! Exact search from frame to frame with bounds carried over by the triangle inequality.
//!
//! For each block of the index a lower bound is kept: the distance of its nearest segment when the block was last
//! measured. Since then the query has moved by a known path length, so by the triangle inequality the segments are
//! nearer by at most that length. A block is measured again only if the remaining bound is below the current limit.
//! The result is exact.

use super::index::Query;
use super::kernels::TILE;
use super::{Best, Index, Segments};
use crate::error::check_length;
use crate::{Error, Real};
use std::ops::Range;

/// Path length of the query, in lengths of the longest segment, after which all blocks are measured again. Bounds are
/// sums with the path length, and their rounding errors grow with it.
const LONGEST_PATH: f64 = 64.0;

/// An exact search along a motion.
#[derive(Debug)]
pub struct Along<T> {
    best: Best<T>,
    /// The previous query; empty if all blocks have to be measured.
    before: Vec<T>,
    /// Path length of the queries since all blocks were measured, rounded up.
    travelled: f64,
    /// For each block: the path length when it was last measured plus the lower bound of its distances then.
    bounds: Vec<T>,
    squares: Vec<T>,
}

impl<T: Real> Along<T> {
    /// A search for the `count` nearest segments in each frame.
    #[must_use]
    pub fn new(count: usize) -> Self {
        Self {
            best: Best::new(count),
            before: Vec::new(),
            travelled: 0.0,
            bounds: Vec::new(),
            squares: Vec::new(),
        }
    }

    /// Discards the state of the previous frames.
    pub fn reset(&mut self) {
        self.before.clear();
        self.best.clear();
    }

    /// Finds the segments nearest to `query`, `(length, dims)` in C order, except for the `excluded` ones. The
    /// segments and their index must be the same for all frames.
    ///
    /// # Errors
    /// [`Error::Length`] if the length of the query is not that of the segments.
    pub fn next(
        &mut self,
        segments: &Segments<'_, T>,
        index: &Index<T>,
        query: &[T],
        excluded: &Range<usize>,
    ) -> Result<&Best<T>, Error> {
        check_length("query", segments.width(), query.len())?;
        let made = index.query(query, segments.dims(), excluded.clone());
        if !made.is_finite() {
            self.reset();
            return Ok(&self.best);
        }
        let known = self.before.len() == query.len() && self.bounds.len() == index.blocks.len();
        if known {
            // Rounded up: the path length between any two frames must never be underestimated.
            let step = index.distance(&made, &self.before).to_f64();
            self.travelled = (self.travelled + step) * (1.0 + 2.0 * f64::EPSILON);
        }
        if known && self.travelled <= LONGEST_PATH * index.largest().to_f64() {
            self.offer_those_before(segments, &made, excluded);
            self.look(segments, index, &made);
        } else {
            self.best.clear();
            self.travelled = 0.0;
            let bests = std::slice::from_mut(&mut self.best);
            index.search(segments, std::slice::from_ref(&made), bests, &mut self.squares);
            self.bounds.clear();
            let squares = self.squares.iter().take(index.blocks.len()).enumerate();
            self.bounds.extend(squares.map(|(block, &square)| index.below(&made, block, square)));
        }
        self.before.clear();
        self.before.extend_from_slice(query);
        Ok(&self.best)
    }

    /// Offers the neighbours of the previous frame and their successors, so that the limit is small from the start.
    fn offer_those_before(&mut self, segments: &Segments<'_, T>, query: &Query<T>, excluded: &Range<usize>) {
        let mut ends: Vec<usize> = self.best.found().iter().flat_map(|&(_, end)| [end, end + 1]).collect();
        ends.sort_unstable();
        ends.dedup();
        self.best.clear();
        for end in ends {
            if segments.contains(end) && !excluded.contains(&end) {
                self.best.offer(query.square(segments.at(end)), end);
            }
        }
    }

    /// Measures the blocks that may hold one of the nearest segments.
    fn look(&mut self, segments: &Segments<'_, T>, index: &Index<T>, query: &Query<T>) {
        let Self { best, travelled, bounds, .. } = self;
        let reach = |best: &Best<T>| {
            T::from_f64((index.near(best).to_f64() + *travelled) * (1.0 + 4.0 * T::EPSILON.to_f64()))
        };
        let mut within = reach(best);
        // Not `<=`: an unknown bound is NaN and counts as reached.
        #[allow(clippy::neg_cmp_op_on_partial_ord, reason = "a bound that is NaN counts as reached")]
        let reached = |bound: T, within: T| !(bound > within);
        let mut squares = [T::ZERO; TILE];
        for (tile, bounds) in bounds.chunks_mut(TILE).enumerate() {
            if !bounds.iter().fold(false, |any, &bound| any | reached(bound, within)) {
                continue;
            }
            index.tile(query, tile, &mut squares);
            for (column, (bound, square)) in bounds.iter_mut().zip(squares).enumerate() {
                let block = tile * TILE + column;
                let below = T::from_f64(index.below(query, block, square).to_f64() + *travelled);
                // The higher of two lower bounds is the stronger one.
                *bound = if *bound > below { *bound } else { below };
                if reached(*bound, within) {
                    let below = index.measure(segments, query, block, best);
                    *bound = T::from_f64(below.to_f64() + *travelled);
                    within = reach(best);
                }
            }
        }
    }
}
