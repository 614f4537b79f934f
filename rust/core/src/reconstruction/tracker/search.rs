//! The examples nearest to the last poses and the last control points, among all.

use super::poses::Poses;
use super::sight::{Fit, Sight};
use crate::Error;
use crate::parallel::{self, Interrupt};
use crate::simd::multiversion;

/// Candidates per task.
const TASK: usize = 8192;

/// Sums that run side by side.
const LANES: usize = 8;

multiversion! {
    /// Adds the squared distance of every `stride`-th row of `features` from `query`.
    fn add_squares(features: &[f32], stride: usize, query: &[f64], out: &mut [f64]) {
        let (wide, rest) = query.as_chunks::<LANES>();
        for (row, out) in features.chunks_exact(query.len().max(1)).step_by(stride).zip(out) {
            let mut sums = [0.0; LANES];
            let (row_wide, row_rest) = row.as_chunks::<LANES>();
            for (a, b) in row_wide.iter().zip(wide) {
                for i in 0..LANES {
                    let difference = f64::from(a[i]) - b[i];
                    sums[i] += difference * difference;
                }
            }
            for (i, (a, b)) in row_rest.iter().zip(rest).enumerate() {
                let difference = f64::from(*a) - b;
                sums[i] += difference * difference;
            }
            *out += ((sums[0] + sums[1]) + (sums[2] + sums[3])) + ((sums[4] + sums[5]) + (sums[6] + sums[7]));
        }
    }
}

/// What examples are compared with.
pub(super) struct Query<'a> {
    pub(super) poses: Poses<'a>,
    /// The last poses as vectors, the newest first.
    pub(super) features: &'a [Vec<f64>],
    pub(super) sight: &'a Sight,
    pub(super) points: usize,
    pub(super) up: usize,
    /// How many poses of its clip an example has before it.
    pub(super) before: usize,
    /// Every which pose of a clip may be an example.
    pub(super) stride: usize,
    /// Distance of control points that counts as much as a radian between poses.
    pub(super) scale: f64,
}

impl Query<'_> {
    /// Squared distances of every `stride`-th pose of `range`, and the poses.
    fn squares(&self, range: std::ops::Range<usize>) -> Vec<(f64, usize)> {
        let mut squares = vec![0.0; range.len().div_ceil(self.stride)];
        let width = 3 * self.poses.joints();
        for (lag, feature) in self.features.iter().enumerate() {
            let rows = (range.start - lag - 1) * width..(range.end - lag - 1) * width;
            add_squares(&self.poses.features[rows], self.stride, feature, &mut squares);
        }
        let order = self.features.len() as f64;
        let share = if self.scale.is_finite() { 1.0 / (self.scale * self.scale) } else { 0.0 };
        let distance = |(square, pose): (f64, usize)| {
            let seen = if share > 0.0 {
                share * self.sight.fit(&self.poses, self.points, pose, self.up).distance
            } else {
                0.0
            };
            (square / order + seen, pose)
        };
        squares.into_iter().zip(range.step_by(self.stride)).map(distance).collect()
    }

    /// The `count` nearest examples' next poses, nearest first; the first of those equally near. Of those within less than
    /// `spacing` frames of each other in a clip only the nearest is taken.
    pub(super) fn nearest(
        &self,
        count: usize,
        spacing: usize,
        interrupt: &Interrupt,
    ) -> Result<Vec<usize>, Error> {
        // Each that is taken keeps at most so many from being taken.
        let beside = spacing.saturating_sub(1) / self.stride;
        let enough = count.saturating_mul(2 * beside + 1);
        let work = self.poses.count() / self.stride * (self.poses.joints() * self.features.len() + 20);
        let parts = parallel::map(self.tasks(), work, |_, range| {
            interrupt.check()?;
            let mut part = self.squares(range);
            keep_least(&mut part, enough);
            Ok(part)
        })?;
        let mut all: Vec<(f64, usize)> = parts.into_iter().flatten().collect();
        keep_least(&mut all, enough);
        all.sort_unstable_by(order);
        let mut found: Vec<usize> = Vec::with_capacity(count);
        for (_, pose) in all {
            if found.len() == count {
                break;
            }
            let apart = |&other: &usize| {
                other.abs_diff(pose) >= spacing || self.border(other.min(pose), other.max(pose))
            };
            if found.iter().all(apart) {
                found.push(pose);
            }
        }
        Ok(found)
    }

    /// The pose that fits the control points best.
    pub(super) fn best_fit(&self, interrupt: &Interrupt) -> Result<Option<(usize, Fit)>, Error> {
        let work = self.poses.count() / self.stride * 20;
        let parts = parallel::map(self.tasks(), work, |_, range| {
            interrupt.check()?;
            let fits = range
                .step_by(self.stride)
                .map(|pose| (pose, self.sight.fit(&self.poses, self.points, pose, self.up)));
            Ok(fits.reduce(|best, next| if next.1.distance < best.1.distance { next } else { best }))
        })?;
        Ok(parts
            .into_iter()
            .flatten()
            .reduce(|best, next| if next.1.distance < best.1.distance { next } else { best }))
    }

    /// Whether a clip ends between two poses.
    fn border(&self, first: usize, second: usize) -> bool {
        let before = |pose: usize| {
            self.poses
                .starts
                .partition_point(|&start| usize::try_from(start).is_ok_and(|start| start <= pose))
        };
        before(first) != before(second)
    }

    fn tasks(&self) -> Vec<std::ops::Range<usize>> {
        let clips = self.poses.old_enough(self.before);
        let length = TASK.next_multiple_of(self.stride);
        clips
            .flat_map(|clip| {
                let stop = clip.end;
                clip.step_by(length).map(move |start| start..(start + length).min(stop))
            })
            .collect()
    }
}

fn order(a: &(f64, usize), b: &(f64, usize)) -> std::cmp::Ordering {
    a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))
}

fn keep_least(items: &mut Vec<(f64, usize)>, count: usize) {
    if items.len() > count && count > 0 {
        items.select_nth_unstable_by(count - 1, order);
        items.truncate(count);
    }
}
