//! Exact search for the nearest segments.

use super::kernels::{self, Probe};
use super::{Best, Index, Segments};
use crate::error::check_length;
use crate::parallel::{self, Interrupt};
use crate::{Error, Real};
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};

/// Poses of all queries from which building an index pays off. Building takes about as long as measuring nine queries
/// of one pose, or four of three poses; with the index a query takes a tenth of the time.
const QUERIED: usize = 10;

/// Pairs of a candidate and a query pose from which an index pays off: computing the directions takes a millisecond
/// in any case.
const PAIRS: usize = 400_000;

/// Segments of a task in the search without an index: a few megabytes.
const TASK: usize = 8192;

/// Segments that are measured before they are compared.
const STRIP: usize = 64;

/// Queries of a task: they share each part of the index while it is in the cache.
pub(super) const TOGETHER: usize = 4;

/// Output of [`nearest`]: `count` entries for each query.
#[derive(Debug)]
pub struct Nearest<'a, T> {
    /// Number of neighbours per query.
    pub count: usize,
    /// Indices of the last poses, nearest first; −1 for missing entries.
    pub indices: &'a mut [i64],
    /// Distances; infinite for missing entries.
    pub distances: &'a mut [T],
}

/// Finds the candidates nearest to each of `queries`, `(queries, length, dims)` in C order.
///
/// `excluded` are the candidates left out for each query. `index`, if given, must be that of `segments`; it skips
/// most candidates and does not change the result. Candidates and queries with values that are not finite have no
/// neighbours.
///
/// # Errors
/// [`Error::Length`] if the lengths of slices do not agree; those of [`Index::new`].
pub fn nearest<T: Real>(
    segments: &Segments<'_, T>,
    index: Option<&Index<T>>,
    queries: &[T],
    excluded: Option<&[Range<usize>]>,
    out: Nearest<'_, T>,
    interrupt: &Interrupt,
) -> Result<(), Error> {
    let Nearest { count, indices, distances } = out;
    let number = queries.len() / segments.width();
    check_length("queries", number * segments.width(), queries.len())?;
    check_length("indices", number * count, indices.len())?;
    check_length("distances", number * count, distances.len())?;
    if let Some(excluded) = excluded {
        check_length("excluded", number, excluded.len())?;
    }
    if count == 0 || number == 0 {
        return Ok(());
    }
    let queried = number.saturating_mul(segments.length());
    let few = queried < QUERIED || queried.saturating_mul(segments.candidates()) < PAIRS;
    let without = |query: usize| excluded.map_or(0..0, |excluded| excluded[query].clone());
    let results = match index {
        None if few => everywhere(segments, queries, &without, count, interrupt)?,
        Some(index) => indexed(segments, index, queries, &without, count, interrupt)?,
        None => indexed(segments, &Index::new(segments, interrupt)?, queries, &without, count, interrupt)?,
    };
    let rows = indices.chunks_exact_mut(count).zip(distances.chunks_exact_mut(count));
    for (best, (indices, distances)) in results.iter().zip(rows) {
        best.write(indices, distances);
    }
    Ok(())
}

/// Measures all candidates.
fn everywhere<T: Real>(
    segments: &Segments<'_, T>,
    queries: &[T],
    excluded: &(dyn Fn(usize) -> Range<usize> + Sync),
    count: usize,
    interrupt: &Interrupt,
) -> Result<Vec<Best<T>>, Error> {
    let sought: Vec<(Probe<T>, Range<usize>, Limit)> = queries
        .chunks_exact(segments.width())
        .enumerate()
        .map(|(i, query)| (Probe::new(query), excluded(i), Limit::new()))
        .collect();
    let tasks = tasks(segments.clips());
    let nanoseconds = segments.candidates() * sought.len() * (segments.width() / 32 + 4);
    let parts = parallel::map(tasks, nanoseconds, |_, task| {
        interrupt.check()?;
        let mut bests = vec![Best::new(count); sought.len()];
        let mut squares = [T::ZERO; STRIP];
        for ends in task {
            for first in ends.clone().step_by(STRIP) {
                let strip = first..ends.end.min(first + STRIP);
                let squares = &mut squares[..strip.len()];
                for ((probe, excluded, limit), best) in sought.iter().zip(&mut bests) {
                    kernels::in_sequence(segments.rows(&strip), segments.dims(), probe, squares);
                    let within = limit.get();
                    // Most strips hold no near segment, and one branch for the whole strip shows it.
                    if squares.iter().fold(false, |any, &square| any | (square <= within)) {
                        offer(best, &strip, squares, excluded, within);
                        limit.lower(best);
                    }
                }
            }
        }
        Ok(bests)
    })?;
    let mut results = vec![Best::new(count); sought.len()];
    for bests in parts {
        for (result, best) in results.iter_mut().zip(bests) {
            for &(square, end) in best.found() {
                result.offer(square, end);
            }
        }
    }
    Ok(results)
}

/// Searches the index, and measures the candidates that survive its bounds.
fn indexed<T: Real>(
    segments: &Segments<'_, T>,
    index: &Index<T>,
    queries: &[T],
    excluded: &(dyn Fn(usize) -> Range<usize> + Sync),
    count: usize,
    interrupt: &Interrupt,
) -> Result<Vec<Best<T>>, Error> {
    let width = segments.width();
    let tasks: Vec<&[T]> = queries.chunks(TOGETHER * width).collect();
    let nanoseconds = (segments.candidates() * segments.length()).saturating_mul(queries.len() / width) / 2;
    let results = parallel::map(tasks, nanoseconds, |task, queries| {
        interrupt.check()?;
        let queries: Vec<_> = queries
            .chunks_exact(width)
            .enumerate()
            .map(|(i, query)| index.query(query, segments.dims(), excluded(task * TOGETHER + i)))
            .collect();
        let mut bests = vec![Best::new(count); queries.len()];
        index.search(segments, &queries, &mut bests, &mut Vec::new());
        Ok(bests)
    })?;
    Ok(results.into_iter().flatten().collect())
}

/// Splits clips into tasks of [`TASK`] candidates.
fn tasks(clips: &[Range<usize>]) -> Vec<Vec<Range<usize>>> {
    let mut tasks: Vec<Vec<Range<usize>>> = Vec::new();
    let mut room = 0;
    for ends in clips {
        let mut first = ends.start;
        while first < ends.end {
            if room == 0 {
                tasks.push(Vec::new());
                room = TASK;
            }
            let last = ends.end.min(first + room);
            room -= last - first;
            if let Some(task) = tasks.last_mut() {
                task.push(first..last);
            }
            first = last;
        }
    }
    tasks
}

/// Offers consecutive candidates within a limit, except for the excluded ones.
fn offer<T: Real>(
    best: &mut Best<T>,
    ends: &Range<usize>,
    squares: &[T],
    excluded: &Range<usize>,
    within: T,
) {
    for (end, square) in ends.clone().zip(squares) {
        if *square <= within && !excluded.contains(&end) {
            best.offer(*square, end);
        }
    }
}

/// The smallest limit, as a squared distance, of all tasks: once one task has enough segments, others can skip
/// farther ones. The final result does not depend on the order of the tasks.
struct Limit(AtomicU64);

impl Limit {
    /// No limit yet.
    fn new() -> Self {
        Self(AtomicU64::new(f64::INFINITY.to_bits()))
    }

    /// The squared distance beyond which segments are skipped.
    fn get<T: Real>(&self) -> T {
        T::from_f64(f64::from_bits(self.0.load(Ordering::Relaxed)))
    }

    /// Lowers the limit to that of a task. The bits of non-negative floats are ordered as the floats.
    fn lower<T: Real>(&self, best: &Best<T>) {
        if let Some(limit) = best.limit() {
            self.0.fetch_min(limit.to_f64().to_bits(), Ordering::Relaxed);
        }
    }
}
