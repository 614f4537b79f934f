//! The graph of neighbours: the nearest segments of every segment of a database.
//!
//! J. Chai and J. K. Hodgins, "Performance animation from low-dimensional control signals", 2005. Every segment is searched for
//! in the index: the graph is exact.

use super::nearest::TOGETHER;
use super::{Best, Index, Segments};
use crate::error::check_length;
use crate::parallel::{self, Interrupt};
use crate::{Error, Real};

/// What stands for a neighbour that does not exist.
const NOBODY: i32 = -1;

/// A graph: the numbers of the neighbours of every pose, nearest first.
#[derive(Debug, Clone, Copy)]
pub struct Graph<'a> {
    neighbors: &'a [i32],
    degree: usize,
}

impl<'a> Graph<'a> {
    /// Views `neighbors`, `(poses, degree)` in C order; negative numbers stand for nobody.
    ///
    /// # Errors
    /// [`Error::Length`] if they are of another number of poses.
    pub fn new(neighbors: &'a [i32], poses: usize, degree: usize) -> Result<Self, Error> {
        check_length("graph", poses * degree, neighbors.len())?;
        Ok(Self { neighbors, degree })
    }

    /// The neighbours of a pose.
    pub fn of(&self, pose: usize) -> impl Iterator<Item = usize> + use<'a> {
        let at = (pose * self.degree).min(self.neighbors.len());
        let row = &self.neighbors[at..self.neighbors.len().min(at + self.degree)];
        row.iter().map_while(|&neighbor| usize::try_from(neighbor).ok())
    }
}

/// Where the results of [`neighbors`] go: `degree` for each pose.
#[derive(Debug)]
pub struct Neighbors<'a, T> {
    /// How many are sought for each pose.
    pub degree: usize,
    /// Their numbers, nearest first; −1 where there are fewer, and all −1 for a pose at which no candidate ends.
    pub indices: &'a mut [i32],
    /// Their distances; infinite where there are fewer.
    pub distances: &'a mut [T],
}

/// Finds the candidates that are nearest to each candidate, but for those of its own clip at most `exclusion` poses away.
///
/// # Errors
/// [`Error::Length`] if slices do not fit together; [`Error::Parameter`] for more than 2³¹ poses; [`Error::Interrupted`].
pub fn neighbors<T: Real>(
    segments: &Segments<'_, T>,
    index: &Index<T>,
    exclusion: usize,
    out: Neighbors<'_, T>,
    interrupt: &Interrupt,
) -> Result<(), Error> {
    let Neighbors { degree, indices, distances } = out;
    check_length("indices", segments.poses() * degree, indices.len())?;
    check_length("distances", segments.poses() * degree, distances.len())?;
    if i32::try_from(segments.poses()).is_err() {
        return Err(Error::Parameter { name: "features", expected: "at most 2³¹ poses" });
    }
    indices.fill(NOBODY);
    distances.fill(T::ONE / T::ZERO);
    if degree == 0 {
        return Ok(());
    }
    let mut tasks = Vec::with_capacity(index.blocks.len());
    let (mut indices, mut distances, mut done) = (indices, distances, 0);
    for block in &index.blocks {
        // All poses up to the end of the passage: those of no passage stay as they are.
        let last = block.ends().end;
        let (index_rows, indices_left) = indices.split_at_mut((last - done) * degree);
        let (distance_rows, distances_left) = distances.split_at_mut((last - done) * degree);
        tasks.push((block.ends(), done, index_rows, distance_rows));
        (indices, distances, done) = (indices_left, distances_left, last);
    }
    let clips = segments.clips();
    let nanoseconds = segments.poses().saturating_mul(segments.poses() * segments.length()) / 2;
    parallel::for_each(tasks, nanoseconds, |_, (ends, before, indices, distances)| {
        interrupt.check()?;
        let clip = &clips[clips.partition_point(|clip| clip.end <= ends.start)];
        let queries: Vec<_> = ends
            .clone()
            .map(|end| {
                let excluded = end.saturating_sub(exclusion).max(clip.start)
                    ..clip.end.min(end.saturating_add(exclusion).saturating_add(1));
                index.query(segments.at(end), segments.dims(), excluded)
            })
            .collect();
        let mut bests = vec![Best::new(degree); queries.len()];
        let mut squares = Vec::new();
        for (queries, bests) in queries.chunks(TOGETHER).zip(bests.chunks_mut(TOGETHER)) {
            index.search(segments, queries, bests, &mut squares);
        }
        for (end, best) in ends.zip(&bests) {
            let row = (end - before) * degree..(end - before + 1) * degree;
            best.write(&mut indices[row.clone()], &mut distances[row]);
        }
        Ok(())
    })
}
