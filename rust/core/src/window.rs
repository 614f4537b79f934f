//! Boundary conditions of clips, on rotations and on plain numbers.

use crate::rotations::quaternion::{between, exp_one, log_short, product, unit};
use crate::{ClipView, Real};
use std::f64::consts::TAU;
use std::ops::Range;

/// Continuation of a clip beyond its ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Boundary {
    /// Reflection at the end frame, which is not repeated: `c b a b c`.
    Mirror,
    /// Constant angular velocity (or slope) of the end.
    Linear,
    /// Repetition of the end frame: `a a a b c`.
    Nearest,
}

impl Boundary {
    /// The frame of a clip of `frames` frames at `index`, for the conditions that repeat frames.
    ///
    /// [`Boundary::Linear`] returns the same as [`Boundary::Nearest`]: its frames are extrapolated from the end
    /// frame.
    #[must_use]
    pub fn source(self, index: isize, frames: usize) -> usize {
        let last = frames.saturating_sub(1);
        match self {
            Self::Mirror if last > 0 => {
                let phase = index.unsigned_abs() % (2 * last);
                phase.min(2 * last - phase)
            }
            _ => usize::try_from(index).map_or(0, |i| i.min(last)),
        }
    }
}

/// A clip with `pad` more frames at both ends, without a copy of its own frames.
///
/// Frames are counted from the first added one: the clip's frame `t` is the extended frame `pad + t`.
#[derive(Debug)]
pub struct Extended<'a, T> {
    clip: ClipView<'a, T>,
    head: Vec<T>,
    tail: Vec<T>,
    pad: usize,
}

impl<'a, T: Real> Extended<'a, T> {
    /// Extends a clip of at least one frame.
    #[must_use]
    pub fn new(clip: ClipView<'a, T>, pad: usize, boundary: Boundary) -> Self {
        let (head, tail) =
            (Self::beyond(clip, pad, boundary, true), Self::beyond(clip, pad, boundary, false));
        Self { clip, head, tail, pad }
    }

    fn beyond(clip: ClipView<'a, T>, pad: usize, boundary: Boundary, before: bool) -> Vec<T> {
        let mut rows = Vec::with_capacity(pad * clip.joints() * 4);
        let last = clip.frames().saturating_sub(1);
        for i in 0..pad {
            let steps = if before { pad - i } else { i + 1 };
            for joint in 0..clip.joints() {
                let q = if boundary == Boundary::Linear && last > 0 {
                    let (end, inner) = if before { (0, 1) } else { (last, last - 1) };
                    continued(clip.at(end, joint), clip.at(inner, joint), steps)
                } else {
                    let steps = isize::try_from(steps).unwrap_or(isize::MAX);
                    let index = if before { -steps } else { last.cast_signed() + steps };
                    clip.at(boundary.source(index, clip.frames()), joint)
                };
                rows.extend_from_slice(&q);
            }
        }
        rows
    }

    /// Number of frames, including added ones.
    #[must_use]
    pub fn frames(&self) -> usize {
        self.clip.frames() + 2 * self.pad
    }

    /// Number of joints.
    #[must_use]
    pub fn joints(&self) -> usize {
        self.clip.joints()
    }

    /// Number of frames added at each end.
    #[must_use]
    pub fn pad(&self) -> usize {
        self.pad
    }

    /// The quaternions of one frame.
    #[must_use]
    pub fn row(&self, frame: usize) -> &[[T; 4]] {
        let after = self.pad + self.clip.frames();
        let (rows, first) = if frame < self.pad {
            (&self.head[..], 0)
        } else if frame < after {
            (self.clip.data(), self.pad)
        } else {
            (&self.tail[..], after)
        };
        let (samples, _) = rows.as_chunks::<4>();
        &samples[(frame - first) * self.clip.joints()..][..self.clip.joints()]
    }

    /// The frames of `range` in up to three blocks of contiguous rows, each with its first frame.
    pub fn blocks(&self, range: Range<usize>) -> impl Iterator<Item = (usize, &[T])> {
        let row = self.clip.joints() * 4;
        let after = self.pad + self.clip.frames();
        [
            (&self.head[..], 0, self.pad),
            (self.clip.data(), self.pad, after),
            (&self.tail[..], after, self.frames()),
        ]
        .into_iter()
        .filter_map(move |(rows, first, end)| {
            let (from, to) = (range.start.max(first), range.end.min(end));
            (from < to).then(|| (from, &rows[(from - first) * row..(to - first) * row]))
        })
    }
}

/// The rotation `steps` frames beyond `end`, at the angular velocity from `inner` to `end`.
pub(crate) fn continued<T: Real>(end: [T; 4], inner: [T; 4], steps: usize) -> [T; 4] {
    let (end, inner) = (end.map(T::to_f64), inner.map(T::to_f64));
    let step = log_short(between(inner, end));
    let length = (step[0] * step[0] + step[1] * step[1] + step[2] * step[2]).sqrt();
    if length == 0.0 {
        return end.map(T::from_f64);
    }
    let angle = (length * steps as f64) % TAU;
    unit(product(end, exp_one(step.map(|x| x / length * angle)))).map(T::from_f64)
}

/// An element of a row of `columns` values, beyond the ends if necessary: `index` counts frames from the clip's first
/// one.
///
/// [`Boundary::Linear`] extrapolates the slope of the end if `slope` is set, and repeats the end otherwise.
#[must_use]
pub fn extended_number<T: Real>(
    values: &[T],
    columns: usize,
    column: usize,
    index: isize,
    boundary: Boundary,
    slope: bool,
) -> T {
    let frames = values.len() / columns;
    let at = |frame: usize| values[frame * columns + column];
    let source = boundary.source(index, frames);
    if boundary == Boundary::Linear && slope && frames > 1 {
        let steps = (index - source.cast_signed()) as f64;
        let (end, inner) = if steps < 0.0 { (at(0), at(1)) } else { (at(frames - 1), at(frames - 2)) };
        if steps != 0.0 {
            return end + (end - inner) * T::from_f64(steps.abs());
        }
    }
    at(source)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mirrored_indices_turn_round_at_both_ends() {
        let indices: Vec<usize> = (-5..9).map(|i| Boundary::Mirror.source(i, 4)).collect();
        assert_eq!(indices, [1, 2, 3, 2, 1, 0, 1, 2, 3, 2, 1, 0, 1, 2]);
        assert_eq!(Boundary::Mirror.source(-7, 1), 0);
        assert_eq!([-2, 0, 3, 9].map(|i| Boundary::Nearest.source(i, 4)), [0, 0, 3, 3]);
    }

    #[test]
    fn linear_numbers_continue_the_slope() {
        let values = [1.0, 3.0, 4.0];
        let at = |i| extended_number(&values, 1, 0, i, Boundary::Linear, true);
        assert_eq!([-2, -1, 0, 2, 3, 5].map(at), [-3.0, -1.0, 1.0, 4.0, 5.0, 7.0]);
    }
}
