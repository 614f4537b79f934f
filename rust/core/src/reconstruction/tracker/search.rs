//! Exact search for the examples nearest to the last poses and the last control points.
//!
//! The distance of an example has two terms. The term of the control points is computed first, for all candidates
//! side by side; candidates for which it alone exceeds the limit are skipped. The term of the poses is computed in
//! single precision, with bounds of its error, and again in double precision for candidates that may be among the
//! nearest.

use super::lattice::Lattice;
use super::observations::{Fit, Observations};
use super::poses::Poses;
use super::recent::Recent;
use super::trajectories::{LANES as SIDE_BY_SIDE, Trajectories};
use crate::Error;
use crate::parallel::{self, Interrupt};
use crate::search::poses::squares_of;
use std::ops::Range;

/// Candidates per task.
const TASK: usize = 2048;

/// A candidate that may be among the nearest, with bounds of its squared distance.
#[derive(Debug, Clone, Copy)]
struct Measured {
    least: f64,
    greatest: f64,
    seen: f64,
    pose: u32,
}

/// An example and its squared distance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Example {
    pub(super) square: f64,
    pub(super) pose: usize,
}

/// A query for the nearest examples.
pub(super) struct Query<'a> {
    pub(super) poses: Poses<'a>,
    pub(super) lattice: &'a Lattice,
    pub(super) trajectories: &'a Trajectories,
    pub(super) observations: &'a Observations,
    pub(super) up: usize,
    /// Distance of control points that counts as much as one radian between poses.
    pub(super) scale: f64,
    /// Number of examples.
    pub(super) count: usize,
    /// Minimum distance between two examples of one clip, in frames.
    pub(super) spacing: usize,
}

impl Query<'_> {
    /// The nearest examples, nearest first; ties go to the lower index. Each example is identified by its next pose.
    /// Of examples less than `spacing` frames apart in one clip only the nearest is kept.
    ///
    /// `near` are poses that are probably among the nearest. The nearer they are, the more candidates are skipped.
    pub(super) fn among_all(
        &self,
        recent: &Recent,
        near: &[u32],
        interrupt: &Interrupt,
    ) -> Result<Vec<Example>, Error> {
        let all = self.lattice.poses();
        let share = self.share();
        let mut seen = vec![0.0; all.len()];
        if share > 0.0 {
            let tasks: Vec<&mut [f64]> = seen.chunks_mut(TASK).collect();
            let work = all.len() * (self.observations.count() * 2 + 4);
            parallel::for_each(tasks, work, |task, out| {
                interrupt.check()?;
                self.observations
                    .distances(self.trajectories.planes(task * TASK..task * TASK + out.len()), out);
                for distance in out {
                    *distance *= share;
                }
                Ok(())
            })?;
        }
        let slots = self.probable(near, &seen);
        let first: Vec<u32> = slots.iter().map(|&slot| all[slot]).collect();
        let seen_first: Vec<f64> = slots.iter().map(|&slot| seen[slot]).collect();
        let far = self.limit(&mut self.measured(recent, &first, &seen_first));
        let tasks: Vec<Range<usize>> =
            (0..all.len()).step_by(TASK).map(|start| start..(start + TASK).min(all.len())).collect();
        let work = all.len() * recent.numbers() / 16;
        let parts = parallel::map(tasks, work, |_, range| {
            interrupt.check()?;
            let (mut left, mut left_seen) =
                (Vec::with_capacity(range.len()), Vec::with_capacity(range.len()));
            for slot in range {
                // Not `!(<=)`: NaN must not be skipped.
                if seen[slot] > far {
                    continue;
                }
                left.push(all[slot]);
                left_seen.push(seen[slot]);
            }
            let mut part = self.measured(recent, &left, &left_seen);
            self.limit(&mut part);
            Ok(part)
        })?;
        Ok(self.nearest(recent, parts.into_iter().flatten().collect()))
    }

    /// Indices of candidates that are probably near: the given poses, or, where these are too few, those whose
    /// control points fit best.
    fn probable(&self, near: &[u32], seen: &[f64]) -> Vec<usize> {
        let enough = self.enough();
        if near.len() >= enough || enough == 0 || enough >= seen.len() {
            return near.iter().filter_map(|pose| self.lattice.poses().binary_search(pose).ok()).collect();
        }
        let mut slots: Vec<usize> = (0..seen.len()).collect();
        slots.select_nth_unstable_by(enough - 1, |&a, &b| seen[a].total_cmp(&seen[b]));
        slots.truncate(enough);
        slots
    }

    /// The nearest examples among some candidates, in ascending order.
    pub(super) fn among(&self, recent: &Recent, candidates: &[u32]) -> Vec<Example> {
        let share = self.share();
        let mut seen = vec![0.0; candidates.len()];
        if share > 0.0 {
            let mut planes = Vec::new();
            let wide = candidates.len().next_multiple_of(SIDE_BY_SIDE);
            self.trajectories.fill(&self.poses, candidates, &mut planes);
            seen.resize(wide, 0.0);
            self.observations.distances(&planes, &mut seen);
            seen.truncate(candidates.len());
            for distance in &mut seen {
                *distance *= share;
            }
        }
        let measured = self.measured(recent, candidates, &seen);
        self.nearest(recent, measured)
    }

    /// The pose that fits the control points best.
    pub(super) fn best_fit(&self, interrupt: &Interrupt) -> Result<Option<(usize, Fit)>, Error> {
        let all = self.lattice.poses();
        let tasks: Vec<Range<usize>> =
            (0..all.len()).step_by(TASK).map(|start| start..(start + TASK).min(all.len())).collect();
        let work = all.len() * (self.observations.count() * 2 + 4);
        let parts = parallel::map(tasks, work, |_, range| {
            interrupt.check()?;
            let mut distances = vec![0.0; range.len()];
            self.observations.distances(self.trajectories.planes(range.clone()), &mut distances);
            let of_all = distances.into_iter().zip(range);
            Ok(of_all.reduce(|best, next| if next.0 < best.0 { next } else { best }))
        })?;
        let best = parts.into_iter().flatten().reduce(|best, next| if next.0 < best.0 { next } else { best });
        Ok(best.map(|(_, slot)| {
            let pose = all[slot] as usize;
            (pose, self.observations.fit(&self.poses, self.trajectories.points(), pose, self.up))
        }))
    }

    /// Weight of a squared distance of control points.
    fn share(&self) -> f64 {
        if self.scale.is_finite() { 1.0 / (self.scale * self.scale) } else { 0.0 }
    }

    fn measured(&self, recent: &Recent, candidates: &[u32], seen: &[f64]) -> Vec<Measured> {
        let before = |&pose: &u32| pose.saturating_sub(recent.before);
        let firsts: Vec<u32> = candidates.iter().map(before).collect();
        let mut squares = vec![0.0; candidates.len()];
        let dims = 3 * self.poses.joints();
        squares_of(self.poses.features, dims, &firsts, &recent.probe, &mut squares);
        let each = squares.iter().zip(candidates).zip(seen);
        each.map(|((&square, &pose), &seen)| {
            let [least, greatest] = recent.bounds(square).map(|bound| bound + seen);
            Measured { least, greatest, seen, pose }
        })
        .collect()
    }

    /// Number of nearest candidates that always suffices: each chosen example rules out a bounded number of others.
    fn enough(&self) -> usize {
        let beside = self.spacing.saturating_sub(1) / self.lattice.stride();
        self.count.saturating_mul(2 * beside + 1)
    }

    /// Removes candidates that cannot be among those needed, and returns the upper limit of their distances.
    fn limit(&self, measured: &mut Vec<Measured>) -> f64 {
        let enough = self.enough();
        if measured.len() < enough || enough == 0 {
            return f64::INFINITY;
        }
        let at = enough - 1;
        let far = measured.select_nth_unstable_by(at, |a, b| a.greatest.total_cmp(&b.greatest)).1.greatest;
        measured.retain(|one| {
            let beyond = one.least > far;
            !beyond
        });
        far
    }

    fn nearest(&self, recent: &Recent, mut measured: Vec<Measured>) -> Vec<Example> {
        self.limit(&mut measured);
        let mut all: Vec<Example> = measured
            .into_iter()
            .map(|one| {
                let pose = one.pose as usize;
                Example { square: recent.exact(&self.poses, pose) + one.seen, pose }
            })
            .collect();
        all.sort_unstable_by(|a, b| a.square.total_cmp(&b.square).then(a.pose.cmp(&b.pose)));
        let mut found: Vec<Example> = Vec::with_capacity(self.count);
        for one in all {
            if found.len() == self.count {
                break;
            }
            let apart = |other: &Example| {
                other.pose.abs_diff(one.pose) >= self.spacing
                    || self.poses.border(other.pose.min(one.pose), other.pose.max(one.pose))
            };
            if found.iter().all(apart) {
                found.push(one);
            }
        }
        found
    }
}
