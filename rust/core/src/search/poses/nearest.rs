//! Exact search for the nearest segments.

use super::kernels::{self, Probe};
use super::{Best, Index, Segments};
use crate::error::check_length;
use crate::parallel::{self, Interrupt};
use crate::{Error, Real};
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};

/// Poses of all queries from which it pays to make an index first: to make it takes about as long as to measure nine queries of a
/// pose, or four of three, and with it a query takes a tenth of the time.
const QUERIED: usize = 10;

/// Pairs of a candidate and a pose of a query from which it does: learning the directions takes a millisecond in any case.
const PAIRS: usize = 400_000;

/// Segments of a task where everything is measured: a few megabytes.
const TASK: usize = 8192;

/// Segments that are measured before they are compared.
const STRIP: usize = 64;

/// Queries of a task: all of them see a part of the index while it is in the cache.
pub(super) const TOGETHER: usize = 4;

/// Where the results of [`nearest`] go: `count` for each query.
#[derive(Debug)]
pub struct Nearest<'a, T> {
    /// How many are sought for each query.
    pub count: usize,
    /// Numbers of the last poses, nearest first; −1 where there are fewer.
    pub indices: &'a mut [i64],
    /// Distances; infinite where there are fewer.
    pub distances: &'a mut [T],
}

/// Finds the candidates that are nearest to each of `queries`, `(queries, length, dims)` in C order.
///
/// `excluded` are the candidates that do not count, for each query. With `index`, which must be that of `segments`, most
/// candidates are passed over; the results are the same. A candidate or a query with a number that is not finite is near to
/// nothing.
///
/// # Errors
/// [`Error::Length`] if slices do not fit together; those of [`Index::new`].
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
                    // Most strips hold nothing, and that is told without a branch for each segment.
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

/// Looks at the index, and measures the candidates that matter.
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

/// Cuts clips into tasks of [`TASK`] candidates.
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

/// Offers candidates in sequence, but for those that are excluded or beyond a limit.
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

/// The least squared distance beyond which a task found that nothing counts, for all tasks: where one has found as many as are
/// sought, others need not look for farther ones. What counts in the end does not depend on who is first.
struct Limit(AtomicU64);

impl Limit {
    /// Everything counts.
    fn new() -> Self {
        Self(AtomicU64::new(f64::INFINITY.to_bits()))
    }

    /// The squared distance beyond which nothing counts.
    fn get<T: Real>(&self) -> T {
        T::from_f64(f64::from_bits(self.0.load(Ordering::Relaxed)))
    }

    /// Takes note of what a task has found. The bits of numbers that are not negative lie in the order of the numbers.
    fn lower<T: Real>(&self, best: &Best<T>) {
        if let Some(limit) = best.limit() {
            self.0.fetch_min(limit.to_f64().to_bits(), Ordering::Relaxed);
        }
    }
}
