//! The graph of neighbours: the nearest segments of every segment of a database.
//!
//! J. Chai and J. K. Hodgins, "Performance animation from low-dimensional control signals", 2005. Every segment is a
//! query to the index, so the graph is exact. Neighbours of the same clip keep a minimum distance in time: they lead
//! to different parts of the motion, and a search along the graph visits the segments beside them anyway.

use super::nearest::TOGETHER;
use super::{Best, Index, Segments};
use crate::error::check_length;
use crate::parallel::{self, Interrupt};
use crate::{Error, Real};
use std::ops::Range;

/// Index of a missing neighbour.
const NO_NEIGHBOR: i32 = -1;

/// The graph: the indices of the neighbours of every pose, nearest first.
#[derive(Debug, Clone, Copy)]
pub struct Graph<'a> {
    neighbors: &'a [i32],
    degree: usize,
}

impl<'a> Graph<'a> {
    /// Views `neighbors`, `(poses, degree)` in C order; negative indices are missing neighbours.
    ///
    /// # Errors
    /// [`Error::Length`] if the length is not `poses · degree`.
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

/// Output of [`neighbors`]: `degree` entries for each pose.
#[derive(Debug)]
pub struct Neighbors<'a, T> {
    /// Number of neighbours per pose.
    pub degree: usize,
    /// Indices, nearest first; −1 for missing entries, and for all entries of a pose that ends no candidate.
    pub indices: &'a mut [i32],
    /// Distances; infinite for missing entries.
    pub distances: &'a mut [T],
}

/// Minimum distances in time.
#[derive(Debug, Clone, Copy)]
pub struct Apart {
    /// Segments of the same clip at most this many poses away are not neighbours.
    pub exclusion: usize,
    /// Minimum distance, in poses, between two neighbours of the same clip; the nearer one is kept.
    pub spacing: usize,
}

/// Finds the nearest candidates of each candidate that satisfy the minimum distances `apart`.
///
/// # Errors
/// [`Error::Length`] if the lengths of slices do not agree; [`Error::Parameter`] for more than 2³¹ poses;
/// [`Error::Interrupted`].
pub fn neighbors<T: Real>(
    segments: &Segments<'_, T>,
    index: &Index<T>,
    apart: Apart,
    out: Neighbors<'_, T>,
    interrupt: &Interrupt,
) -> Result<(), Error> {
    let Neighbors { degree, indices, distances } = out;
    check_length("indices", segments.poses() * degree, indices.len())?;
    check_length("distances", segments.poses() * degree, distances.len())?;
    if i32::try_from(segments.poses()).is_err() {
        return Err(Error::Parameter { name: "features", expected: "at most 2³¹ poses" });
    }
    indices.fill(NO_NEIGHBOR);
    distances.fill(T::ONE / T::ZERO);
    if degree == 0 {
        return Ok(());
    }
    let mut tasks = Vec::with_capacity(index.blocks.len());
    let (mut indices, mut distances, mut done) = (indices, distances, 0);
    for block in &index.blocks {
        // All poses up to the end of the block. Poses outside all blocks keep their missing entries.
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
        let query = |&end: &usize| {
            let excluded = end.saturating_sub(apart.exclusion).max(clip.start)
                ..clip.end.min(end.saturating_add(apart.exclusion).saturating_add(1));
            index.query(segments.at(end), segments.dims(), excluded)
        };
        let mut ends: Vec<usize> = ends.collect();
        let mut squares = Vec::new();
        for count in sought(degree, apart.spacing) {
            let queries: Vec<_> = ends.iter().map(query).collect();
            let mut left = Vec::new();
            for (ends, queries) in ends.chunks(TOGETHER).zip(queries.chunks(TOGETHER)) {
                let mut bests = vec![Best::new(count); queries.len()];
                index.search(segments, queries, &mut bests, &mut squares);
                for (&end, best) in ends.iter().zip(&bests) {
                    let chosen = thinned(best, clips, apart.spacing, degree);
                    if chosen.found().len() < degree && best.found().len() == count {
                        left.push(end);
                    }
                    let row = (end - before) * degree..(end - before + 1) * degree;
                    chosen.write(&mut indices[row.clone()], &mut distances[row]);
                }
            }
            ends = left;
        }
        Ok(())
    })
}

/// Numbers of candidates to search for. The first usually suffices for `degree` neighbours with the minimum distance.
/// The second always does: each chosen neighbour rules out at most `2·spacing − 2` others.
fn sought(degree: usize, spacing: usize) -> [usize; 2] {
    let spacing = spacing.max(1);
    [degree.saturating_mul(spacing), degree.saturating_mul(2 * spacing - 1)]
}

/// Keeps the nearest of all segments less than `spacing` poses apart in one clip.
fn thinned<T: Real>(best: &Best<T>, clips: &[Range<usize>], spacing: usize, degree: usize) -> Best<T> {
    let mut chosen: Best<T> = Best::new(degree);
    for &(square, end) in best.found() {
        let same_clip = |other: usize| {
            let first = end.min(other);
            clips[clips.partition_point(|clip| clip.end <= first)].contains(&end.max(other))
        };
        let near = |&(_, other): &(T, usize)| end.abs_diff(other) < spacing && same_clip(other);
        if !chosen.found().iter().any(near) {
            chosen.offer(square, end);
        }
    }
    chosen
}
