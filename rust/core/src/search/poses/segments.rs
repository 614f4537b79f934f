//! Segments of poses in a matrix of concatenated clips.

use crate::error::check_length;
use crate::{Error, Real};
use std::ops::Range;
use std::sync::Arc;

/// The candidate segments of a matrix: one bit per pose.
#[derive(Debug)]
pub struct Layout {
    dims: usize,
    length: usize,
    clips: Vec<Range<usize>>,
    /// Whether a candidate ends at this pose.
    members: Vec<u64>,
}

/// The segments of `length` poses of a borrowed matrix `(poses, dims)`.
#[derive(Debug, Clone)]
pub struct Segments<'a, T> {
    features: &'a [T],
    layout: Arc<Layout>,
}

impl<'a, T: Real> Segments<'a, T> {
    /// Views `features`, in C order. `starts` are the first poses of the clips, followed by the number of poses.
    /// `successors` is the number of poses of the clip that must follow a candidate.
    ///
    /// # Errors
    /// [`Error::Parameter`] if `starts` do not rise from 0, or `dims` or `length` is 0; [`Error::Length`] if the last
    /// of `starts` is not the number of poses.
    pub fn new(
        features: &'a [T],
        dims: usize,
        starts: &[usize],
        length: usize,
        successors: usize,
    ) -> Result<Self, Error> {
        if dims == 0 || length == 0 {
            return Err(Error::Parameter { name: "queries", expected: "poses of at least one number" });
        }
        let poses = features.len() / dims;
        if starts.first() != Some(&0) || starts.windows(2).any(|pair| pair[0] > pair[1]) {
            return Err(Error::Parameter { name: "starts", expected: "numbers that rise from 0" });
        }
        check_length("starts", poses, starts.last().copied().unwrap_or_default())?;
        check_length("features", poses * dims, features.len())?;
        let clips = starts
            .windows(2)
            .map(|pair| pair[0] + length - 1..pair[1].saturating_sub(successors))
            .filter(|ends| !ends.is_empty())
            .collect::<Vec<_>>();
        let mut members = vec![0; poses.div_ceil(64)];
        for ends in &clips {
            fill(&mut members, ends);
        }
        Ok(Self { features, layout: Arc::new(Layout { dims, length, clips, members }) })
    }

    /// Views `features` with the layout of earlier segments.
    ///
    /// # Errors
    /// [`Error::Length`] if the size of the matrix differs.
    pub fn again(features: &'a [T], layout: &Arc<Layout>) -> Result<Self, Error> {
        let segments = Self { features, layout: Arc::clone(layout) };
        check_length("features", layout.members.len(), segments.poses().div_ceil(64))?;
        check_length("features", segments.poses() * layout.dims, features.len())?;
        Ok(segments)
    }

    /// The layout, to view the same matrix [`again`](Self::again).
    #[must_use]
    pub fn layout(&self) -> &Arc<Layout> {
        &self.layout
    }

    /// Values per pose.
    #[must_use]
    pub fn dims(&self) -> usize {
        self.layout.dims
    }

    /// Poses per segment.
    #[must_use]
    pub fn length(&self) -> usize {
        self.layout.length
    }

    /// Values per segment.
    #[must_use]
    pub fn width(&self) -> usize {
        self.layout.length * self.layout.dims
    }

    /// Number of poses.
    #[must_use]
    pub fn poses(&self) -> usize {
        self.features.len() / self.layout.dims
    }

    /// Number of candidates.
    #[must_use]
    pub fn candidates(&self) -> usize {
        self.layout.clips.iter().map(Range::len).sum()
    }

    /// The candidates of each clip that has any.
    #[must_use]
    pub fn clips(&self) -> &[Range<usize>] {
        &self.layout.clips
    }

    /// Whether a candidate ends at a pose.
    #[inline(always)]
    #[must_use]
    pub fn contains(&self, end: usize) -> bool {
        self.layout.members.get(end / 64).is_some_and(|word| word >> (end % 64) & 1 == 1)
    }

    /// The values of the candidate that ends at a pose.
    #[inline(always)]
    #[must_use]
    pub fn at(&self, end: usize) -> &'a [T] {
        &self.features[(end + 1 - self.layout.length) * self.layout.dims..(end + 1) * self.layout.dims]
    }

    /// The values of the poses of consecutive candidates.
    #[inline(always)]
    pub(super) fn rows(&self, ends: &Range<usize>) -> &'a [T] {
        &self.features[(ends.start + 1 - self.layout.length) * self.layout.dims..ends.end * self.layout.dims]
    }

    /// The matrix.
    pub(super) fn features(&self) -> &'a [T] {
        self.features
    }
}

/// Sets the bits of a non-empty range.
fn fill(words: &mut [u64], bits: &Range<usize>) {
    let (first, last) = (bits.start / 64, (bits.end - 1) / 64);
    let (from, to) = (u64::MAX << (bits.start % 64), u64::MAX >> (63 - (bits.end - 1) % 64));
    if first == last {
        words[first] |= from & to;
        return;
    }
    words[first] |= from;
    words[first + 1..last].fill(u64::MAX);
    words[last] |= to;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bits_of_ranges_of_any_length_are_set() {
        for start in [0, 1, 63, 64, 100] {
            for end in [start + 1, start + 2, start + 63, start + 64, start + 65, start + 200] {
                let mut words = [0; 5];
                fill(&mut words, &(start..end));
                let set = |bit: usize| words[bit / 64] >> (bit % 64) & 1 == 1;
                assert!((0..320).all(|bit| set(bit) == (start..end).contains(&bit)), "{start}..{end}");
            }
        }
    }

    #[test]
    fn segments_lie_within_clips_and_have_successors() {
        let features = [0.0_f32; 14];
        let segments = Segments::new(&features, 2, &[0, 4, 4, 7], 2, 1).expect("they fit");
        assert_eq!(segments.clips(), [1..3, 5..6]);
        let ends: Vec<usize> = (0..9).filter(|&end| segments.contains(end)).collect();
        assert_eq!(ends, [1, 2, 5]);
        assert_eq!((segments.candidates(), segments.at(1).len()), (3, 4));
    }

    #[test]
    fn borders_that_fall_are_refused() {
        let features = [0.0_f32; 6];
        let falling = Segments::new(&features, 2, &[0, 3, 2, 3], 1, 0).expect_err("they fall");
        assert_eq!(falling.to_string(), "starts: expected numbers that rise from 0");
        let short = Segments::new(&features, 2, &[0, 2], 1, 0).expect_err("a pose is left");
        assert_eq!(short.to_string(), "starts: expected 3 elements, got 2");
    }
}
