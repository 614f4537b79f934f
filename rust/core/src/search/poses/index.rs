//! Index for exact search: lower bounds of segment distances.
//!
//! The *projection* of a pose is its coordinates along the few directions of largest variance: two projections are at
//! most as far apart as the poses. The *projected window* of a segment is the mean of its poses' projections times
//! the square root of their number. Two projected windows are at most as far apart as the segments, and hardly
//! nearer, since consecutive poses are similar. Consecutive segments differ little compared with different motions.
//! The search therefore tests, for each block of a few segments, first the projected window of the middle segment,
//! then all projections, then the segments themselves. The result is exact.

use super::kernels::{self, LANES, Probe, TILE};
use super::principal::directions;
use super::{Best, Segments};
use crate::parallel::{self, Interrupt};
use crate::{Error, Real};
use std::ops::Range;

/// Coordinates of a projection: for motions they hold nine tenths of the variance of poses.
const WIDTH: usize = LANES;

/// Segments per block. More would be farther apart, fewer would save less.
pub(super) const BLOCK: usize = 8;

/// Poses that are projected at a time.
const STRIP: usize = 64;

/// Poses of a task.
const TASK: usize = 4096;

/// Consecutive segments of one clip.
#[derive(Debug, Clone, Copy)]
pub(super) struct Block<T> {
    first: usize,
    count: usize,
    /// Largest distance of a projected window from that of the middle segment; infinite if unknown.
    radius: T,
}

impl<T: Real> Block<T> {
    /// Indices of its segments.
    pub(super) fn ends(&self) -> Range<usize> {
        self.first..self.first + self.count
    }

    /// The middle segment.
    fn middle(&self) -> usize {
        self.first + self.count / 2
    }
}

/// Projections of all poses, and blocks of all candidates: 76 bytes per pose in float32.
#[derive(Debug, Clone)]
pub struct Index<T> {
    /// Directions of projection, `(dims, WIDTH)`.
    basis: Vec<T>,
    /// Projections, `(poses, WIDTH)`.
    projections: Vec<T>,
    /// The blocks.
    pub(super) blocks: Vec<Block<T>>,
    /// Projected windows of the blocks' middles in tiles: the first coordinates of all blocks of a tile, then the
    /// second ones.
    middles: Vec<T>,
    /// Relative rounding error of distances between projections, per unit of the segments' lengths.
    rounding: T,
    /// Length of the longest segment.
    largest: T,
    length: usize,
}

impl<T: Real> Index<T> {
    /// Builds the index from all poses of `segments`.
    ///
    /// # Errors
    /// [`Error::Interrupted`].
    pub fn new(segments: &Segments<'_, T>, interrupt: &Interrupt) -> Result<Self, Error> {
        let (dims, poses, length) = (segments.dims(), segments.poses(), segments.length());
        let directions = directions(segments, WIDTH);
        // Components far below the others' rounding errors are set to 0: products of subnormal numbers are many times
        // slower.
        let tiny = (T::EPSILON * T::EPSILON).to_f64();
        let basis: Vec<T> = (0..dims * WIDTH)
            .map(|i| directions[i % WIDTH * dims + i / WIDTH])
            .map(|x| if x.abs() < tiny { T::ZERO } else { T::from_f64(x) })
            .collect();
        let mut projections = vec![T::ZERO; poses * WIDTH];
        let tasks: Vec<_> =
            segments.features().chunks(TASK * dims).zip(projections.chunks_mut(TASK * WIDTH)).collect();
        let largest = parallel::map(tasks, poses * dims * 2, |_, (rows, projections)| {
            interrupt.check()?;
            Ok(project(&basis, rows, dims, projections))
        })?;
        let largest = largest.into_iter().fold(T::ZERO, Real::max) * T::from_f64(length as f64).sqrt();
        let mut blocks = Vec::with_capacity(poses / BLOCK + segments.clips().len());
        for ends in segments.clips() {
            for first in ends.clone().step_by(BLOCK) {
                blocks.push(Block { first, count: BLOCK.min(ends.end - first), radius: T::ZERO });
            }
        }
        let mut middles = vec![T::ZERO; blocks.len().next_multiple_of(TILE) * WIDTH];
        let tasks: Vec<_> = blocks.chunks_mut(TILE).zip(middles.chunks_exact_mut(TILE * WIDTH)).collect();
        parallel::for_each(tasks, poses * length * 8, |_, (blocks, middles)| {
            interrupt.check()?;
            let mut probe = Probe::new(&[]);
            let (mut windows, mut squares) = ([T::ZERO; WIDTH * BLOCK], [T::ZERO; BLOCK]);
            for (column, block) in blocks.iter_mut().enumerate() {
                for (end, window) in block.ends().zip(windows.chunks_exact_mut(WIDTH)) {
                    write_window(rows(&projections, length, &(end..end + 1)), window);
                }
                let middle = block.middle() - block.first;
                let window = &windows[middle * WIDTH..(middle + 1) * WIDTH];
                for (number, x) in window.iter().enumerate() {
                    middles[number * TILE + column] = *x;
                }
                probe.set(window);
                let squares = &mut squares[..block.count];
                kernels::in_sequence(&windows[..block.count * WIDTH], WIDTH, &probe, squares);
                block.radius = radius(squares, squares[middle]);
            }
            Ok(())
        })?;
        let rounding = T::EPSILON * T::from_f64((4 * (dims + WIDTH * length)) as f64);
        Ok(Self { basis, projections, blocks, middles, rounding, largest, length })
    }

    /// A query with its projection.
    pub(super) fn query(&self, values: &[T], dims: usize, excluded: Range<usize>) -> Query<T> {
        let mut query = Query {
            probe: Probe::new(&[]),
            projection: Probe::new(&[]),
            window: [T::ZERO; WIDTH],
            excluded,
            slack: T::ZERO,
        };
        self.set(&mut query, values, dims);
        query
    }

    /// Replaces the query.
    pub(super) fn set(&self, query: &mut Query<T>, values: &[T], dims: usize) {
        let mut projection = vec![T::ZERO; WIDTH * self.length];
        let own =
            project(&self.basis, values, dims, &mut projection) * T::from_f64(self.length as f64).sqrt();
        query.probe.set(values);
        query.projection.set(&projection);
        write_window(&projection, &mut query.window);
        query.slack = self.rounding * (self.largest + own) + T::TINY_SQUARE.sqrt();
    }

    /// Length of the scratch memory of [`Index::search`], per query.
    pub(super) fn room(&self) -> usize {
        self.blocks.len().next_multiple_of(TILE)
    }

    /// Offers to each query's list its nearest candidates; the lists may hold some already.
    pub(super) fn search(
        &self,
        segments: &Segments<'_, T>,
        queries: &[Query<T>],
        bests: &mut [Best<T>],
        squares: &mut Vec<T>,
    ) {
        let room = self.room();
        squares.resize(room * queries.len(), T::ZERO);
        for (tile, middles) in self.middles.chunks_exact(TILE * WIDTH).enumerate() {
            for (query, squares) in queries.iter().zip(squares.chunks_exact_mut(room)) {
                kernels::tile(middles, &query.window, &mut squares[tile * TILE..(tile + 1) * TILE]);
            }
        }
        if room > 0 {
            for ((query, best), squares) in queries.iter().zip(bests).zip(squares.chunks_exact(room)) {
                self.look(segments, query, &squares[..self.blocks.len()], best);
            }
        }
    }

    /// Offers a query its nearest candidates. `squares` are the squared distances between its projected window and
    /// those of the blocks' middles.
    fn look(&self, segments: &Segments<'_, T>, query: &Query<T>, squares: &[T], best: &mut Best<T>) {
        if !query.probe.is_finite() {
            return;
        }
        // First the blocks with the nearest middles, so that the limit is small from the start.
        let mut first = Best::new(2 * (best.count() / BLOCK + 2));
        for (block, square) in squares.iter().enumerate() {
            first.offer(*square, block);
        }
        for &(_, block) in first.found() {
            self.measure(segments, query, block, best);
        }
        let above = T::ONE + self.rounding;
        let mut far = query.far(best, self.rounding);
        for (block, square) in squares.iter().enumerate() {
            let reach = (far + self.blocks[block].radius) * above;
            // Not `!(<=)`: an unknown square is NaN, and its block must be measured.
            if *square > reach * reach {
                continue;
            }
            self.measure(segments, query, block, best);
            far = query.far(best, self.rounding);
        }
    }

    /// Offers the segments of a block, and returns a lower bound of their distances.
    pub(super) fn measure(
        &self,
        segments: &Segments<'_, T>,
        query: &Query<T>,
        block: usize,
        best: &mut Best<T>,
    ) -> T {
        let ends = self.blocks[block].ends();
        let mut squares = [T::ZERO; BLOCK];
        kernels::in_sequence(
            rows(&self.projections, self.length, &ends),
            WIDTH,
            &query.projection,
            &mut squares[..ends.len()],
        );
        let far = query.far(best, self.rounding);
        let (mut projection, mut least) = (T::ONE / T::ZERO, T::ONE / T::ZERO);
        for (end, square) in ends.zip(squares) {
            if square > far * far || query.excluded.contains(&end) {
                projection = if square < projection { square } else { projection };
                continue;
            }
            let exact = query.square(segments.at(end));
            least = if exact < least { exact } else { least };
            best.offer(exact, end);
        }
        let above = T::ONE + self.rounding;
        (projection.sqrt() / above - query.slack).min(least.sqrt() / above)
    }

    /// Upper bound of the distance between two queries.
    pub(super) fn distance(&self, query: &Query<T>, other: &[T]) -> T {
        query.square(other).sqrt() * (T::ONE + self.rounding) + T::TINY_SQUARE.sqrt()
    }

    /// Squared distances between the projected windows of a query and of the middles of a tile of blocks.
    pub(super) fn tile(&self, query: &Query<T>, tile: usize, squares: &mut [T; TILE]) {
        let at = tile * TILE * WIDTH;
        kernels::tile(&self.middles[at..at + TILE * WIDTH], &query.window, squares);
    }

    /// Lower bound of the distances of a block's segments to a query, given the squared distance of the middle's
    /// projected window; NaN if unknown.
    pub(super) fn below(&self, query: &Query<T>, block: usize, square: T) -> T {
        let above = T::ONE + self.rounding;
        square.sqrt() / (above * above) - self.blocks[block].radius * above - query.slack
    }

    /// Upper bound, with rounding allowed for, of the distance of the last segment kept.
    pub(super) fn near(&self, best: &Best<T>) -> T {
        best.limit().map_or(T::ONE / T::ZERO, |limit| limit.sqrt() * (T::ONE + self.rounding))
    }

    /// Length of the longest segment.
    pub(super) fn largest(&self) -> T {
        self.largest
    }
}

/// A query with its projection.
#[derive(Debug, Clone)]
pub(super) struct Query<T> {
    probe: Probe<T>,
    projection: Probe<T>,
    window: [T; WIDTH],
    pub(super) excluded: Range<usize>,
    slack: T,
}

impl<T: Real> Query<T> {
    /// Whether all values are finite.
    pub(super) fn is_finite(&self) -> bool {
        self.probe.is_finite()
    }

    /// Squared distance to a segment.
    pub(super) fn square(&self, segment: &[T]) -> T {
        let mut square = [T::ZERO];
        kernels::in_sequence(segment, segment.len(), &self.probe, &mut square);
        square[0]
    }

    /// Distance between projections beyond which a segment cannot be among the nearest.
    fn far(&self, best: &Best<T>, rounding: T) -> T {
        let above = T::ONE + rounding;
        best.limit().map_or(T::ONE / T::ZERO, |limit| (limit.sqrt() * above + self.slack) * above)
    }
}

/// The projections of the poses of consecutive candidates.
fn rows<'a, T: Real>(projections: &'a [T], length: usize, ends: &Range<usize>) -> &'a [T] {
    &projections[(ends.start + 1 - length) * WIDTH..ends.end * WIDTH]
}

/// Writes the projected window of a segment from the projections of its poses.
fn write_window<T: Real>(projections: &[T], window: &mut [T]) {
    let share = T::from_f64((WIDTH as f64 / projections.len() as f64).sqrt());
    window.fill(T::ZERO);
    for projection in projections.chunks_exact(WIDTH) {
        for (sum, x) in window.iter_mut().zip(projection) {
            *sum += *x;
        }
    }
    for sum in window {
        *sum *= share;
    }
}

/// Writes the projections of poses, and returns the length of the longest pose.
fn project<T: Real>(basis: &[T], poses: &[T], dims: usize, projections: &mut [T]) -> T {
    let origin = Probe::new(&vec![T::ZERO; dims]);
    let mut squares = [T::ZERO; STRIP];
    let mut largest = T::ZERO;
    for (poses, projections) in poses.chunks(STRIP * dims).zip(projections.chunks_mut(STRIP * WIDTH)) {
        let squares = &mut squares[..poses.len() / dims];
        // The pass that reads poses in order comes first: memory is slower for `products`, which reads several side
        // by side.
        kernels::in_sequence(poses, dims, &origin, squares);
        kernels::products(basis, poses, projections);
        for &square in &*squares {
            largest = if square > largest { square } else { largest };
        }
    }
    largest.sqrt()
}

/// Largest distance of a projected window, ignoring segments with missing values; infinite if the middle one has
/// missing values.
fn radius<T: Real>(squares: &[T], middle: T) -> T {
    if !middle.is_finite() {
        return T::ONE / T::ZERO;
    }
    squares.iter().fold(T::ZERO, |largest, &square| if square > largest { square } else { largest }).sqrt()
}
