//! Patch search: the most similar patches of every frame.
//!
//! The patch of a frame `t` is `t − r … t + r`; beyond the ends of a clip the end frame is held. With the rotation angles `θ`
//! between the samples of two patches that are both there, and weights `w` of the joints,
//!
//! ```text
//! D(t, s)² = Σ w_j θ_j(t + o, s + o)² / Σ w_j      over offsets o and joints j
//! ```
//!
//! Exact: every frame gets its `k` nearest candidates by that distance, of equally near ones those with lower numbers.
//!
//! - `poses`: clips as planes.

mod poses;

use super::diagonal::Measure;
use super::features::Side;
use super::join::{Join, Lags, Scratch};
use super::nearest::{Nearest, Ties};
use super::spread::{MARGIN, Spreads};
use crate::error::check_length;
use crate::parallel::{self, Interrupt};
use crate::{ClipView, Error, Real};
pub(crate) use poses::{Loaded, Poses};
use std::sync::Mutex;

/// Frames of a task: their planes and their distances to a chunk of candidates stay within the second-level cache.
const TASK_FRAMES: usize = 256;

/// Candidates whose planes are held at once: they stay within a common third-level cache.
const CHUNK_FRAMES: usize = 16_384;

/// Fewer frames are not worth the search for diagonals that do not matter, which costs as much as 40 of them.
const FEW_FRAMES: usize = 128;

/// What a number that is not there stands for.
const NOBODY: i64 = -1;

/// The parameters of the search.
#[derive(Debug, Clone)]
pub struct PatchNeighbors {
    /// Radius of a patch in frames.
    pub patch_radius: usize,
    /// How many neighbours.
    pub count: usize,
    /// In the clip itself, candidates at most so many frames away are left out.
    pub exclusion: usize,
    /// What each joint counts, not negative.
    pub weights: Vec<f64>,
}

impl PatchNeighbors {
    /// Finds the nearest patches of every frame of `clip` among those of `library`, counted through its clips, or among its
    /// own without one.
    ///
    /// `indices` and `distances` are `(frames, count)`, nearest first, in radians; −1 and infinity where there are no more.
    /// Quaternions need not have length 1 exactly.
    ///
    /// # Errors
    /// [`Error::Length`] if slices do not fit together; [`Error::Interrupted`].
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
        indices.fill(NOBODY);
        distances.fill(T::ONE / T::ZERO);
        if joints == 0 || frames == 0 {
            return Ok(());
        }
        let own = [clip];
        let scenes = library.unwrap_or(&own);
        let without = self.exclusion.min(frames).cast_signed();
        let lags =
            if library.is_some() { Lags::all() } else { Lags { without: -without..=without, ..Lags::all() } };
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
        for (tile, nearest) in
            self.nearest(&measure, &poses, clip, scenes, &lags, interrupt)?.iter().enumerate()
        {
            for frame in tile * TASK_FRAMES..frames.min((tile + 1) * TASK_FRAMES) {
                let row = frame * self.count;
                for (i, (distance, number)) in nearest.of(frame - tile * TASK_FRAMES).enumerate() {
                    indices[row + i] = i64::try_from(number).unwrap_or(NOBODY);
                    distances[row + i] = distance;
                }
            }
        }
        Ok(())
    }

    /// What was found for each task.
    fn nearest<T: Real>(
        &self,
        measure: &Measure<T>,
        poses: &Poses<T>,
        clip: ClipView<'_, T>,
        scenes: &[ClipView<'_, T>],
        lags: &Lags,
        interrupt: &Interrupt,
    ) -> Result<Vec<Nearest<T>>, Error> {
        let frames = clip.frames();
        let candidates: usize = scenes.iter().map(ClipView::frames).sum();
        let count = self.count.min(candidates);
        let mut found: Vec<Nearest<T>> = (0..frames)
            .step_by(TASK_FRAMES)
            .map(|first| Nearest::new(first, TASK_FRAMES.min(frames - first), count, Ties::Lower))
            .collect();
        let triangular = poses.complete() && frames >= FEW_FRAMES;
        let margin = if triangular { MARGIN } else { 0 };
        let spare: Mutex<Vec<(Loaded<T>, Scratch<T>)>> = Mutex::default();
        let mut first = 0;
        for scene in scenes {
            for start in (0..scene.frames()).step_by(CHUNK_FRAMES) {
                let length = CHUNK_FRAMES.min(scene.frames() - start);
                let mut chunk = Loaded::default();
                let pad = self.patch_radius + margin;
                poses.load(*scene, start..start + length, pad, &mut chunk);
                let side = Side { features: chunk.features(), at: pad, first: first + start, count: length };
                let spreads = if triangular { Some(Spreads::new(measure, &side, interrupt)?) } else { None };
                let work = frames * length * measure.joints.len();
                parallel::for_each(found.iter_mut().collect(), work, |task, nearest| {
                    interrupt.check()?;
                    let kept = spare.lock().map_or(None, |mut spare| spare.pop());
                    let (mut loaded, mut scratch) = kept.unwrap_or_default();
                    let from = task * TASK_FRAMES;
                    let to = frames.min(from + TASK_FRAMES);
                    poses.load(clip, from..to, self.patch_radius, &mut loaded);
                    let join = Join {
                        measure,
                        frames: Side {
                            features: loaded.features(),
                            at: self.patch_radius,
                            first: from,
                            count: to - from,
                        },
                        candidates: side,
                        lags: lags.clone(),
                        spreads: spreads.as_ref(),
                    };
                    let done = join.run(nearest, &mut scratch, interrupt);
                    if let Ok(mut spare) = spare.lock() {
                        spare.push((loaded, scratch));
                    }
                    done
                })?;
            }
            first += scene.frames();
        }
        Ok(found)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const JOINTS: usize = 2;

    /// Swings that repeat more or less, with a jerk in one place.
    fn clip<T: Real>(frames: usize, speed: f64) -> Vec<T> {
        (0..frames * JOINTS)
            .flat_map(|i| {
                let (time, joint) = ((i / JOINTS) as f64 * speed, (i % JOINTS) as f64);
                let jerk = if i / JOINTS == frames / 3 { 0.7 } else { 0.0 };
                let ((slow, _), (_, fast)) = (Real::sin_cos(time), Real::sin_cos(1.7 * time + joint));
                let (sine, cosine) = Real::sin_cos((1.0 + joint) * (slow + 0.2 * fast) + jerk);
                [cosine, 0.6 * sine, 0.8 * sine, 0.0].map(T::from_f64)
            })
            .collect()
    }

    fn passing_over_changes_nothing<T: Real>() -> Result<(), Error> {
        let interrupt = Interrupt::new();
        let pad = 3 + MARGIN;
        for (frames, others, speed) in [(300, 500, 0.03), (150, 41, 0.01), (130, 1, 0.5), (200, 900, 1.1)] {
            let (q, r) = (clip::<T>(frames, speed), clip::<T>(others, 1.1 * speed));
            let (q, r) = (ClipView::new(&q, frames, JOINTS)?, ClipView::new(&r, others, JOINTS)?);
            let poses = Poses::new(q, &[r], false, &interrupt)?;
            let (mut here, mut there) = (Loaded::default(), Loaded::default());
            poses.load(q, 0..frames, 3, &mut here);
            poses.load(r, 0..others, pad, &mut there);
            let ones = vec![T::ONE; JOINTS];
            let measure = Measure {
                before: 3,
                after: 3,
                joints: 0..JOINTS,
                factors: ones.clone(),
                units: ones,
                averaged: true,
            };
            let side = Side { features: there.features(), at: pad, first: 0, count: others };
            let spreads = Spreads::new(&measure, &side, &interrupt)?;
            let near = Lags { without: -7..=7, ..Lags::all() };
            let window = Lags { within: -90..=33, ..near.clone() };
            for lags in [Lags::all(), near, window] {
                let found = [None, Some(&spreads)].map(|spreads| {
                    let join = Join {
                        measure: &measure,
                        frames: Side { features: here.features(), at: 3, first: 0, count: frames },
                        candidates: side,
                        lags: lags.clone(),
                        spreads,
                    };
                    let mut nearest = Nearest::new(0, frames, 5, Ties::Lower);
                    join.run(&mut nearest, &mut Scratch::default(), &interrupt).map(|()| nearest)
                });
                let [all, some] = found;
                let (all, some) = (all?, some?);
                for frame in 0..frames {
                    assert!(
                        all.of(frame).eq(some.of(frame)),
                        "frame {frame} of {frames}, {others} candidates"
                    );
                }
            }
        }
        Ok(())
    }

    #[test]
    fn what_is_passed_over_is_not_missed() -> Result<(), Error> {
        passing_over_changes_nothing::<f32>()?;
        passing_over_changes_nothing::<f64>()
    }
}
