//! Exact search from frame to frame: a motion cannot come near to what was far a moment ago.
//!
//! Of each passage of the index a number is kept: no segment of it was nearer than that when it was last looked at. Since then
//! the query has travelled some way, and by the triangle inequality the segments are at most so much nearer. Only where what
//! remains is within reach of the nearest, the passage is looked at again. Nothing is lost.

use super::index::Query;
use super::kernels::TILE;
use super::{Best, Index, Segments};
use crate::error::check_length;
use crate::{Error, Real};
use std::ops::Range;

/// How far a query travels before all is looked at again, in lengths of the longest segment: bounds are sums with the way so far,
/// and round the more the longer it is.
const LONGEST_PATH: f64 = 64.0;

/// An exact search along a motion.
#[derive(Debug)]
pub struct Along<T> {
    best: Best<T>,
    /// The query before; empty where all is to be looked at.
    before: Vec<T>,
    /// How far queries have travelled since all was looked at: never less than it is.
    travelled: f64,
    /// The way so far when a passage was looked at last, and how near its segments were at least then, added.
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

    /// Forgets the frames before.
    pub fn reset(&mut self) {
        self.before.clear();
        self.best.clear();
    }

    /// Finds the segments that are nearest to `query`, `(length, dims)` in C order, but for those that are `excluded`. The
    /// segments and their index must be those of the frames before.
    ///
    /// # Errors
    /// [`Error::Length`] if the query is of another length than the segments.
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
            // Upwards, so that the way from any frame to any other is never taken for less than it is.
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

    /// Offers the nearest of the frame before and those after them, to know early how near the nearest are.
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

    /// Looks at the passages that may hold one of the nearest.
    fn look(&mut self, segments: &Segments<'_, T>, index: &Index<T>, query: &Query<T>) {
        let Self { best, travelled, bounds, .. } = self;
        let reach = |best: &Best<T>| {
            T::from_f64((index.near(best).to_f64() + *travelled) * (1.0 + 4.0 * T::EPSILON.to_f64()))
        };
        let mut within = reach(best);
        // Not `<=`: where nothing is known the bound is no number.
        #[allow(clippy::neg_cmp_op_on_partial_ord, reason = "a bound that is no number is within reach")]
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
                // Of two bounds the higher says more.
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
