//! Patch search: the nearest patches of every frame.
//!
//! The patch of a frame `t` is `t − r … t + r`; past the ends of a clip the end frame is repeated. With `θ` the
//! rotation angle between two samples, neither of which is missing, and weights `w` of the joints,
//!
//! ```text
//! D(t, s)² = Σ w_j θ_j(t + o, s + o)² / Σ w_j      over offsets o and joints j
//! ```
//!
//! The search is exact: every frame gets its `k` nearest candidates by that distance. Ties go to the lower index.
//!
//! - `poses`: clips as planes of unit quaternions.

mod poses;

use super::bounds::{Bounds, LONGEST};
use super::diagonal::Measure;
use super::features::Side;
use super::join::{Join, Lags, Scratch};
use super::nearest::{Lists, Nearest, Ties};
use crate::error::check_length;
use crate::parallel::{self, Interrupt};
use crate::{ClipView, Error, Real};
pub(crate) use poses::{Loaded, Poses};
use std::ops::Range;
use std::sync::Mutex;

/// Frames of a task: their planes and their distances to a chunk of candidates fit in the second-level cache.
const TASK_FRAMES: usize = 256;

/// Candidates loaded at once: their planes fit in a typical third-level cache.
const CHUNK_FRAMES: usize = 16_384;

/// Least number of frames for which bounds pay off: they require reading all candidates.
const FEW_FRAMES: usize = 128;

/// Index of a missing neighbour.
const NO_NEIGHBOR: i64 = -1;

/// The parameters of the search.
#[derive(Debug, Clone)]
pub struct PatchNeighbors {
    /// Radius of a patch in frames.
    pub patch_radius: usize,
    /// Number of neighbours per frame.
    pub count: usize,
    /// Within the same clip, candidates at most this many frames away are left out.
    pub exclusion: usize,
    /// Weight of each joint, not negative.
    pub weights: Vec<f64>,
}

/// Work on the frames of one task.
type Work<'a, T> = dyn Fn(&Join<'_, T>, &mut Scratch<T>) -> Result<(), Error> + Sync + 'a;

impl PatchNeighbors {
    /// Finds the nearest patches of every frame of `clip`: in `library`, whose frames are counted through all its
    /// clips, or in `clip` itself if there is no library.
    ///
    /// `indices` and `distances` are `(frames, count)`, nearest first, in radians. Missing entries are −1 and
    /// infinity. Quaternions need not have length 1 exactly.
    ///
    /// # Errors
    /// [`Error::Length`] if the lengths of slices do not agree; [`Error::Interrupted`].
    pub fn search<T: Real>(
        &self,
        clip: ClipView<'_, T>,
        library: Option<&[ClipView<'_, T>]>,
        indices: &mut [i64],
        distances: &mut [T],
        interrupt: &Interrupt,
    ) -> Result<(), Error> {
        let (frames, joints) = (clip.frames(), clip.joints());
        check_length("indices", frames * self.count, indices.len())?;
        check_length("distances", frames * self.count, distances.len())?;
        check_length("weights", joints, self.weights.len())?;
        for other in library.unwrap_or_default() {
            check_length("joints of the library", joints, other.joints())?;
        }
        indices.fill(NO_NEIGHBOR);
        distances.fill(T::ONE / T::ZERO);
        if joints == 0 || frames == 0 {
            return Ok(());
        }
        let own = [clip];
        let scenes = library.unwrap_or(&own);
        let weights: Vec<T> = self.weights.iter().map(|weight| T::from_f64(*weight)).collect();
        let measure = Measure {
            before: self.patch_radius,
            after: self.patch_radius,
            joints: 0..joints,
            factors: weights.clone(),
            units: weights,
            averaged: true,
        };
        let poses = Poses::new(clip, scenes, false, interrupt)?;
        let library = library.is_some();
        let found = self.nearest(&measure, &poses, clip, scenes, library, interrupt)?;
        for (tile, nearest) in found.enumerate() {
            for frame in tile * TASK_FRAMES..frames.min((tile + 1) * TASK_FRAMES) {
                let row = frame * self.count;
                for (i, (distance, number)) in nearest.of(frame - tile * TASK_FRAMES).enumerate() {
                    indices[row + i] = i64::try_from(number).unwrap_or(NO_NEIGHBOR);
                    distances[row + i] = distance;
                }
            }
        }
        Ok(())
    }

    /// The nearest candidates for the frames of each task.
    fn nearest<T: Real>(
        &self,
        measure: &Measure<T>,
        poses: &Poses<T>,
        clip: ClipView<'_, T>,
        scenes: &[ClipView<'_, T>],
        library: bool,
        interrupt: &Interrupt,
    ) -> Result<impl Iterator<Item = Nearest<T>> + use<T>, Error> {
        let frames = clip.frames();
        let without = self.exclusion.min(frames).cast_signed();
        let lags = if library { Lags::all() } else { Lags { without: -without..=without, ..Lags::all() } };
        let candidates: usize = scenes.iter().map(ClipView::frames).sum();
        let lists = Lists::new(0, frames, TASK_FRAMES, self.count.min(candidates), Ties::Lower);
        let bounded = poses.complete() && frames >= FEW_FRAMES;
        let mutual = bounded && !library && measure.window() <= LONGEST;
        let pool: Mutex<Vec<(Loaded<T>, Scratch<T>)>> = Mutex::default();
        let at = self.patch_radius;
        let mut first = 0;
        for scene in scenes {
            for start in (0..scene.frames()).step_by(CHUNK_FRAMES) {
                let end = scene.frames().min(start + CHUNK_FRAMES);
                let mut chunk = Loaded::default();
                poses.load(*scene, start..end, at, &mut chunk);
                let side = Side { features: chunk.features(), at, first: first + start, count: end - start };
                let bounds = if bounded { Some(Bounds::new(measure, &side, interrupt)?) } else { None };
                let each = |tasks: Range<usize>, work: &Work<'_, T>| {
                    let nanoseconds = tasks.len() * TASK_FRAMES * side.count * measure.joints.len();
                    parallel::for_each(tasks.collect(), nanoseconds, |_, task: usize| {
                        interrupt.check()?;
                        let kept = pool.lock().map_or(None, |mut pool| pool.pop());
                        let (mut loaded, mut scratch) = kept.unwrap_or_default();
                        let from = task * TASK_FRAMES;
                        let to = frames.min(from + TASK_FRAMES);
                        let count = to - from;
                        let own = if !library && (start..end).contains(&from) {
                            Side { at: at + from - start, first: from, count, ..side }
                        } else {
                            poses.load(clip, from..to, at, &mut loaded);
                            Side { features: loaded.features(), at, first: from, count }
                        };
                        let join = Join {
                            measure,
                            frames: own,
                            candidates: side,
                            lags: lags.clone(),
                            bounds: bounds.as_ref(),
                            mutual,
                        };
                        let done = work(&join, &mut scratch);
                        if let Ok(mut pool) = pool.lock() {
                            pool.push((loaded, scratch));
                        }
                        done
                    })
                };
                let tasks = if mutual {
                    let own = start / TASK_FRAMES..end.div_ceil(TASK_FRAMES);
                    each(own.clone(), &|join, scratch| {
                        join.prepare(&lists, scratch);
                        Ok(())
                    })?;
                    // Later frames compare themselves with these as candidates.
                    0..own.end
                } else {
                    0..frames.div_ceil(TASK_FRAMES)
                };
                each(tasks, &|join, scratch| join.run(&lists, scratch, interrupt))?;
            }
            first += scene.frames();
        }
        Ok(lists.into_nearest())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oscillations that repeat approximately, with a jerk in one place.
    fn clip<T: Real>(frames: usize, joints: usize, speed: f64) -> Vec<T> {
        (0..frames * joints)
            .flat_map(|i| {
                let (time, joint) = ((i / joints) as f64 * speed, (i % joints) as f64);
                let jerk = if i / joints == frames / 3 { 0.7 } else { 0.0 };
                let ((slow, _), (_, fast)) = (Real::sin_cos(time), Real::sin_cos(1.7 * time + joint));
                let (sine, cosine) = Real::sin_cos((1.0 + 0.3 * joint) * (slow + 0.2 * fast) + jerk);
                [cosine, 0.6 * sine, 0.8 * sine, 0.0].map(T::from_f64)
            })
            .collect()
    }

    fn measure<T: Real>(joints: usize) -> Measure<T> {
        let ones = vec![T::ONE; joints];
        Measure { before: 3, after: 3, joints: 0..joints, factors: ones.clone(), units: ones, averaged: true }
    }

    fn passing_over_changes_nothing<T: Real>(
        cases: &[(usize, usize, f64)],
        joints: usize,
    ) -> Result<(), Error> {
        let interrupt = Interrupt::new();
        for &(frames, others, speed) in cases {
            let (q, r) = (clip::<T>(frames, joints, speed), clip::<T>(others, joints, 1.1 * speed));
            let (q, r) = (ClipView::new(&q, frames, joints)?, ClipView::new(&r, others, joints)?);
            let poses = Poses::new(q, &[r], false, &interrupt)?;
            let (mut here, mut there) = (Loaded::default(), Loaded::default());
            poses.load(q, 0..frames, 3, &mut here);
            poses.load(r, 0..others, 3, &mut there);
            let measure = measure::<T>(joints);
            let side = Side { features: there.features(), at: 3, first: 0, count: others };
            let bounds = Bounds::new(&measure, &side, &interrupt)?;
            let near = Lags { without: -7..=7, ..Lags::all() };
            let window = Lags { within: -90..=33, ..near.clone() };
            for lags in [Lags::all(), near, window] {
                let found = [None, Some(&bounds)].map(|bounds| {
                    let join = Join {
                        measure: &measure,
                        frames: Side { features: here.features(), at: 3, first: 0, count: frames },
                        candidates: side,
                        lags: lags.clone(),
                        bounds,
                        mutual: false,
                    };
                    let lists = Lists::new(0, frames, frames, 5, Ties::Lower);
                    join.run(&lists, &mut Scratch::default(), &interrupt)
                        .map(|()| lists.into_nearest().collect::<Vec<_>>())
                });
                let [all, some] = found;
                let (all, some) = (all?, some?);
                for frame in 0..frames {
                    assert!(
                        all[0].of(frame).eq(some[0].of(frame)),
                        "frame {frame} of {frames}, {others} candidates"
                    );
                }
            }
        }
        Ok(())
    }

    /// Compares the results of the mutual search, which visits each pair once, with those of all pairs for some
    /// frames.
    fn looking_once_changes_nothing<T: Real>(
        (frames, joints): (usize, usize),
        some: &[Range<usize>],
    ) -> Result<(), Error> {
        let interrupt = Interrupt::new();
        let count = 5;
        let q = clip::<T>(frames, joints, 0.03);
        let q = ClipView::new(&q, frames, joints)?;
        let search = PatchNeighbors { patch_radius: 3, count, exclusion: 7, weights: vec![1.0; joints] };
        let (mut indices, mut distances) = (vec![0; count * frames], vec![T::ZERO; count * frames]);
        search.search(q, None, &mut indices, &mut distances, &interrupt)?;
        let poses = Poses::new(q, &[q], false, &interrupt)?;
        let mut all = Loaded::default();
        poses.load(q, 0..frames, 3, &mut all);
        let measure = measure::<T>(joints);
        let candidates = Side { features: all.features(), at: 3, first: 0, count: frames };
        for range in some {
            let (first, length) = (range.start, range.len());
            let join = Join {
                measure: &measure,
                frames: Side { at: 3 + first, first, count: length, ..candidates },
                candidates,
                lags: Lags { without: -7..=7, ..Lags::all() },
                bounds: None,
                mutual: false,
            };
            let lists = Lists::new(first, length, length, count, Ties::Lower);
            join.run(&lists, &mut Scratch::default(), &interrupt)?;
            for nearest in lists.into_nearest() {
                for frame in range.clone() {
                    let row = count * frame..count * (frame + 1);
                    let found = distances[row.clone()].iter().copied().zip(indices[row].iter().copied());
                    let expected =
                        nearest.of(frame - first).map(|(d, n)| (d, i64::try_from(n).unwrap_or(NO_NEIGHBOR)));
                    assert!(expected.eq(found), "frame {frame} of {frames}");
                }
            }
        }
        Ok(())
    }

    #[test]
    fn what_is_passed_over_is_not_missed() -> Result<(), Error> {
        let cases = [(300, 500, 0.03), (150, 41, 0.01), (130, 1, 0.5), (200, 900, 1.1)];
        passing_over_changes_nothing::<f32>(&cases, 2)?;
        passing_over_changes_nothing::<f64>(&cases, 2)
    }

    #[test]
    fn no_points_are_missed() -> Result<(), Error> {
        let cases = [(140, 2305, 0.03), (131, 2100, 0.5)];
        passing_over_changes_nothing::<f32>(&cases, 9)?;
        passing_over_changes_nothing::<f64>(&cases, 9)
    }

    #[test]
    fn a_pair_that_is_looked_at_once_counts_for_both() -> Result<(), Error> {
        looking_once_changes_nothing::<f32>((2305, 9), &[0..100, 100..2305])?;
        looking_once_changes_nothing::<f64>((300, 2), &[0..100, 100..300])?;
        // Two chunks of candidates.
        let frames = CHUNK_FRAMES + 700;
        let some = [0..60, CHUNK_FRAMES - 30..CHUNK_FRAMES + 30, frames - 60..frames];
        looking_once_changes_nothing::<f32>((frames, 1), &some)
    }
}
