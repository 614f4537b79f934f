//! Filters that run frame by frame: eight joints side by side, so that their recursions become vector code.

use crate::parallel;
use crate::rotations::quaternion::{dot, unit};
use crate::simd::multiversion;
use crate::{ClipView, Error, Real};
use std::sync::Mutex;

/// Joints side by side: a vector of float64 at the widest level.
pub(super) const LANES: usize = 8;

/// Frames per task of the last pass.
const TILE: usize = 1024;

/// A value for each joint.
pub(super) type Lane = [f64; LANES];

/// Joints of a clip that are filtered side by side.
pub(super) struct Group<'a, T> {
    clip: ClipView<'a, T>,
    confidence: Option<&'a [T]>,
    /// Index of the first joint.
    pub(super) first: usize,
    /// Number of joints, at most [`LANES`].
    pub(super) joints: usize,
}

impl<T: Real> Group<'_, T> {
    /// Values per joint of the clip as lanes; 1 in lanes without a joint.
    pub(super) fn lane(&self, numbers: &[f64]) -> Lane {
        let numbers = &numbers[self.first..self.first + self.joints];
        std::array::from_fn(|lane| numbers.get(lane).copied().unwrap_or(1.0))
    }

    /// Reads the quaternions of a frame, of any length, and their confidences; lanes without a joint are unchanged.
    pub(super) fn load(&self, frame: usize, q: &mut [Lane; 4], confidences: &mut Lane) {
        let at = frame * self.clip.joints() + self.first;
        let (samples, _) = self.clip.data().as_chunks::<4>();
        for (lane, sample) in samples[at..at + self.joints].iter().enumerate() {
            for c in 0..4 {
                q[c][lane] = sample[c].to_f64();
            }
        }
        if let Some(confidence) = self.confidence {
            for (out, confidence) in confidences.iter_mut().zip(&confidence[at..at + self.joints]) {
                *out = confidence.to_f64();
            }
        }
    }

    /// The first frame with confidence.
    pub(super) fn begin(&self, lane: usize) -> Option<usize> {
        let Some(confidence) = self.confidence else { return Some(0) };
        let mut path = confidence.iter().skip(self.first + lane).step_by(self.clip.joints());
        path.position(|&confidence| confidence > T::ZERO)
    }

    /// The rows of the result, `(frames, joints of the group, 4)`, continuous in sign from the hemisphere of the
    /// clip's first frame. Frames before the first one with confidence repeat it; joints without any confidence are
    /// unchanged.
    pub(super) fn rows<'b>(&self, rotation: impl Fn(usize) -> &'b [Lane; 4]) -> Vec<T> {
        let frames = self.clip.frames();
        let begin: Vec<Option<usize>> = (0..self.joints).map(|lane| self.begin(lane)).collect();
        let late = begin.iter().map(|begin| begin.unwrap_or(frames)).max().unwrap_or(0);
        let mut before = [[1.0; LANES]; 4];
        self.load(0, &mut before, &mut [0.0; LANES]);
        let mut rows = vec![T::ZERO; frames * self.joints * 4];
        for (frame, row) in rows.chunks_exact_mut(self.joints * 4).enumerate() {
            let mut planes = *rotation(frame);
            if frame < late {
                let mut samples = planes;
                self.load(frame, &mut samples, &mut [0.0; LANES]);
                for (lane, begin) in begin.iter().enumerate() {
                    let there = begin.map(|begin| rotation(frame.max(begin)));
                    set_lane(&mut planes, lane, of_lane(there.unwrap_or(&samples), lane));
                }
            }
            follow(&mut planes, &mut before);
            for (lane, q) in row.chunks_exact_mut(4).enumerate() {
                for c in 0..4 {
                    q[c] = T::from_f64(planes[c][lane]);
                }
            }
        }
        rows
    }
}

multiversion! {
    /// Normalises quaternions, with the sign nearer to the previous ones, and updates these.
    fn follow(q: &mut [Lane; 4], before: &mut [Lane; 4]) {
        let (mut now, last) = (*q, *before);
        for i in 0..LANES {
            let one = unit(of_lane(&now, i));
            let sign = if dot(one, of_lane(&last, i)) < 0.0 { -1.0 } else { 1.0 };
            set_lane(&mut now, i, [one[0] * sign, one[1] * sign, one[2] * sign, one[3] * sign]);
        }
        *q = now;
        *before = now;
    }
}

/// Values of joints as lanes, 1 in lanes without a joint.
pub(super) fn lanes(numbers: &[f64]) -> Vec<Lane> {
    let lane = |numbers: &[f64]| std::array::from_fn(|i| numbers.get(i).copied().unwrap_or(1.0));
    numbers.chunks(LANES).map(lane).collect()
}

/// Filters a clip group by group: `filter` processes the frames of a group and returns its [`Group::rows`] with a
/// second result, of which the first group's is returned. Its buffers are reused from group to group: fresh pages
/// cost as much as the arithmetic.
///
/// # Errors
/// The first error of the groups.
pub(super) fn run<T: Real, B: Default + Send, R: Send>(
    clip: ClipView<'_, T>,
    confidence: Option<&[T]>,
    out: &mut [T],
    nanoseconds: usize,
    filter: impl Fn(&Group<'_, T>, &mut B) -> Result<(Vec<T>, R), Error> + Sync + Send,
) -> Result<Option<R>, Error> {
    let joints = clip.joints();
    let firsts: Vec<usize> = (0..joints).step_by(LANES).collect();
    let spare: Mutex<Vec<B>> = Mutex::default();
    let filtered = parallel::map(firsts, nanoseconds, |_, first| {
        let kept = spare.lock().map_or(None, |mut spare| spare.pop());
        let mut buffers = kept.unwrap_or_default();
        let group = Group { clip, confidence, first, joints: LANES.min(joints - first) };
        let result = filter(&group, &mut buffers)?;
        if let Ok(mut spare) = spare.lock() {
            spare.push(buffers);
        }
        Ok(result)
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

/// One of two finite arrays, selected by multiplication: the compiler turns selects of many values into branches,
/// which are not vectorised.
#[inline(always)]
pub(super) fn select<const N: usize>(condition: bool, yes: [f64; N], no: [f64; N]) -> [f64; N] {
    let (one, other) = if condition { (1.0, 0.0) } else { (0.0, 1.0) };
    let mut chosen = yes;
    for c in 0..N {
        chosen[c] = yes[c] * one + no[c] * other;
    }
    chosen
}

/// The lane `lane` of `N` planes.
#[inline(always)]
pub(super) fn of_lane<const N: usize>(planes: &[Lane; N], lane: usize) -> [f64; N] {
    let mut values = [0.0; N];
    for c in 0..N {
        values[c] = planes[c][lane];
    }
    values
}

/// Writes values to the lane of `N` planes.
#[inline(always)]
pub(super) fn set_lane<const N: usize>(planes: &mut [Lane; N], lane: usize, values: [f64; N]) {
    for c in 0..N {
        planes[c][lane] = values[c];
    }
}

/// A vector times a scalar.
#[inline(always)]
pub(super) fn scaled(v: [f64; 3], factor: f64) -> [f64; 3] {
    [v[0] * factor, v[1] * factor, v[2] * factor]
}
