//! Filters that go through time frame by frame: eight joints side by side, so that their recursions become vector code.

use crate::parallel;
use crate::rotations::quaternion::{dot, negative, unit};
use crate::{ClipView, Error, Real};

/// Joints side by side: a vector of float64 at the widest level.
pub(super) const LANES: usize = 8;

/// Frames per task of the last pass.
const TILE: usize = 1024;

/// A number for each joint.
pub(super) type Lane = [f64; LANES];

/// Joints of a clip that are filtered side by side.
pub(super) struct Group<'a, T> {
    clip: ClipView<'a, T>,
    confidence: Option<&'a [T]>,
    /// The first of the joints.
    pub(super) first: usize,
    /// How many they are, at most [`LANES`].
    pub(super) joints: usize,
}

impl<T: Real> Group<'_, T> {
    /// One number per joint of the clip as one per lane, 1 where there is no joint.
    pub(super) fn lane(&self, numbers: &[f64]) -> Lane {
        let numbers = &numbers[self.first..self.first + self.joints];
        std::array::from_fn(|lane| numbers.get(lane).copied().unwrap_or(1.0))
    }

    /// The unit quaternion of a frame.
    pub(super) fn sample(&self, frame: usize, lane: usize) -> [f64; 4] {
        unit(self.clip.at(frame, self.first + lane).map(T::to_f64))
    }

    /// The confidence of a frame.
    pub(super) fn trust(&self, frame: usize, lane: usize) -> f64 {
        self.confidence.map_or(1.0, |c| c[frame * self.clip.joints() + self.first + lane].to_f64())
    }

    /// The first frame with confidence.
    pub(super) fn begin(&self, lane: usize) -> Option<usize> {
        (0..self.clip.frames()).find(|&frame| self.trust(frame, lane) > 0.0)
    }

    /// The rows of the result, `(frames, joints of the group, 4)`, continuous in sign from the hemisphere of the clip's
    /// first frame. Before the first frame with confidence the rotation is the one there; without any it is the sample.
    pub(super) fn rows(&self, rotation: impl Fn(usize, usize) -> [f64; 4]) -> Vec<T> {
        let frames = self.clip.frames();
        let begin: Vec<Option<usize>> = (0..self.joints).map(|lane| self.begin(lane)).collect();
        let mut before: Vec<[f64; 4]> = (0..self.joints).map(|lane| self.sample(0, lane)).collect();
        let mut rows = Vec::with_capacity(frames * self.joints * 4);
        for frame in 0..frames {
            for (lane, (begin, before)) in begin.iter().zip(&mut before).enumerate() {
                let q = match begin {
                    Some(begin) => unit(rotation(frame.max(*begin), lane)),
                    None => self.sample(frame, lane),
                };
                *before = if dot(q, *before) < 0.0 { negative(q) } else { q };
                rows.extend(before.map(T::from_f64));
            }
        }
        rows
    }
}

/// Numbers of joints as lanes, 1 where there is no joint.
pub(super) fn lanes(numbers: &[f64]) -> Vec<Lane> {
    let lane = |numbers: &[f64]| std::array::from_fn(|i| numbers.get(i).copied().unwrap_or(1.0));
    numbers.chunks(LANES).map(lane).collect()
}

/// Filters a clip group by group: `filter` goes through the frames of a group and gives its [`Group::rows`], and what else
/// it knows; for the first group that comes back.
///
/// # Errors
/// The first error of the groups.
pub(super) fn run<T: Real, R: Send>(
    clip: ClipView<'_, T>,
    confidence: Option<&[T]>,
    out: &mut [T],
    nanoseconds: usize,
    filter: impl Fn(&Group<'_, T>) -> Result<(Vec<T>, R), Error> + Sync + Send,
) -> Result<Option<R>, Error> {
    let joints = clip.joints();
    let firsts: Vec<usize> = (0..joints).step_by(LANES).collect();
    let filtered = parallel::map(firsts, nanoseconds, |_, first| {
        filter(&Group { clip, confidence, first, joints: LANES.min(joints - first) })
    })?;
    let (rows, more): (Vec<Vec<T>>, Vec<R>) = filtered.into_iter().unzip();
    let tiles: Vec<&mut [T]> = out.chunks_mut(TILE * joints * 4).collect();
    parallel::for_each(tiles, clip.frames() * joints * 2, |tile, out| {
        for (frame, row) in out.chunks_exact_mut(joints * 4).enumerate() {
            for (row, part) in row.chunks_mut(LANES * 4).zip(&rows) {
                let at = (tile * TILE + frame) * row.len();
                row.copy_from_slice(&part[at..at + row.len()]);
            }
        }
        Ok(())
    })?;
    Ok(more.into_iter().next())
}

/// The one or the other, both finite: as factors, for selects of many numbers become branches, and no vector code.
#[inline(always)]
pub(super) fn select<const N: usize>(condition: bool, yes: [f64; N], no: [f64; N]) -> [f64; N] {
    let (one, other) = if condition { (1.0, 0.0) } else { (0.0, 1.0) };
    let mut chosen = yes;
    for c in 0..N {
        chosen[c] = yes[c] * one + no[c] * other;
    }
    chosen
}

/// The quaternions in the lanes of four planes.
#[inline(always)]
pub(super) fn of_lane<const N: usize>(planes: &[Lane; N], lane: usize) -> [f64; N] {
    let mut values = [0.0; N];
    for c in 0..N {
        values[c] = planes[c][lane];
    }
    values
}

/// Writes the components into the planes.
#[inline(always)]
pub(super) fn set_lane<const N: usize>(planes: &mut [Lane; N], lane: usize, values: [f64; N]) {
    for c in 0..N {
        planes[c][lane] = values[c];
    }
}

/// A vector times a number.
#[inline(always)]
pub(super) fn scaled(v: [f64; 3], factor: f64) -> [f64; 3] {
    [v[0] * factor, v[1] * factor, v[2] * factor]
}
