//! Swaps: two joints that change places for some frames.

use super::Despike;
use super::place::{Place, Rotation, SLACK};
use crate::error::check_length;
use crate::parallel::{self, Interrupt};
use crate::rotations::quaternion::unit;
use crate::{ClipView, Error, Real};
use std::cmp::Ordering;
use std::collections::BTreeMap;
use std::ops::Range;

/// Where two joints cross, each moves so many times as far as from the place of one to that of the other, at least.
const CLEAR: f64 = 2.0;

/// Frames that one task looks at.
const TILE: usize = 1024;

/// Frames in which two joints have changed places.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Swap {
    /// The two joints, the smaller index first.
    pub joints: [usize; 2],
    /// The first frame.
    pub start: usize,
    /// The frame after the last.
    pub end: usize,
}

impl Despike {
    /// The swaps of a clip of rotations of at most `longest` frames, in order of joints and frames. No sample may be missing.
    ///
    /// # Errors
    /// [`Error::Length`] if slices do not fit together; [`Error::Interrupted`].
    pub fn swaps<T: Real>(
        &self,
        clip: ClipView<'_, T>,
        confidence: Option<&[T]>,
        interrupt: &Interrupt,
    ) -> Result<Vec<Swap>, Error> {
        let (frames, joints) = (clip.frames(), clip.joints());
        check_length("noise", joints, self.noise.len())?;
        check_length("smallest", joints, self.smallest.len())?;
        if let Some(confidence) = confidence {
            check_length("confidence", frames * joints, confidence.len())?;
        }
        if frames < 2 || joints < 2 {
            return Ok(Vec::new());
        }
        let least: Vec<f64> = (0..joints).map(|joint| self.least(joint)).collect();
        let poses =
            Poses { clip, confidence, bounds: least.iter().map(|&least| bound(least)).collect(), least };
        let tiles = (1..frames).step_by(TILE).map(|start| start..(start + TILE).min(frames)).collect();
        let crossings = parallel::map(tiles, frames * joints * 20, |_, tile: Range<usize>| {
            interrupt.check()?;
            Ok(poses.crossings(tile))
        })?;
        let mut times: BTreeMap<[usize; 2], Vec<usize>> = BTreeMap::new();
        for (pair, t) in crossings.into_iter().flatten() {
            times.entry(pair).or_default().push(t);
        }
        let mut swaps = Vec::new();
        for (pair, times) in times {
            for (i, ends) in times.windows(2).enumerate() {
                let (start, end) = (ends[0], ends[1]);
                let before = if i == 0 { 0 } else { times[i - 1] };
                let after = times.get(i + 2).copied().unwrap_or(frames);
                let length = end - start;
                if length <= self.longest && length < (start - before).min(after - end) {
                    swaps.push(Swap { joints: pair, start, end });
                }
            }
        }
        Ok(swaps)
    }
}

struct Poses<'a, T> {
    clip: ClipView<'a, T>,
    confidence: Option<&'a [T]>,
    /// Per joint, what a jump is longer than.
    least: Vec<f64>,
    /// The same for the cheap measure.
    bounds: Vec<f64>,
}

impl<T: Real> Poses<'_, T> {
    /// The pairs of joints that cross from the frame before to one of a tile, and that frame; in order of frames.
    fn crossings(&self, tile: Range<usize>) -> Vec<([usize; 2], usize)> {
        let joints = self.bounds.len();
        let pose = |frame| -> Vec<Rotation> {
            (0..joints).map(|joint| Rotation(unit(self.clip.at(frame, joint).map(T::to_f64)))).collect()
        };
        let mut found = Vec::new();
        let mut jumping = Vec::new();
        let mut before = pose(tile.start - 1);
        for t in tile {
            let after = pose(t);
            jumping.clear();
            jumping.extend((0..joints).filter(|&j| before[j].nearness(after[j]) > self.bounds[j]));
            if jumping.len() > 1 {
                jumping.retain(|&j| self.known(t, j) && before[j].distance(after[j]) > self.least[j]);
                found.extend(crossing(&before, &after, &jumping).into_iter().map(|pair| (pair, t)));
            }
            before = after;
        }
        found
    }

    /// Whether a joint has confidence at a frame and at the one before.
    fn known(&self, frame: usize, joint: usize) -> bool {
        let joints = self.bounds.len();
        self.confidence
            .is_none_or(|c| c[frame * joints + joint] > T::ZERO && c[(frame - 1) * joints + joint] > T::ZERO)
    }
}

fn bound(least: f64) -> f64 {
    Rotation::nearness_at(least) * (1.0 - SLACK)
}

/// The pairs of joints that cross between two poses, the closest first, each joint once.
fn crossing(before: &[Rotation], after: &[Rotation], jumping: &[usize]) -> Vec<[usize; 2]> {
    let mut pairs = Vec::new();
    for (i, &a) in jumping.iter().enumerate() {
        for &b in &jumping[i + 1..] {
            let moved = before[a].distance(after[a]).min(before[b].distance(after[b]));
            let apart = before[a].distance(after[b]).max(before[b].distance(after[a]));
            if moved > CLEAR * apart {
                pairs.push((apart, [a, b]));
            }
        }
    }
    pairs.sort_by(|x, y| x.0.partial_cmp(&y.0).unwrap_or(Ordering::Equal).then(x.1.cmp(&y.1)));
    let mut crossing: Vec<[usize; 2]> = Vec::new();
    for (_, pair) in pairs {
        if !crossing.iter().flatten().any(|joint| pair.contains(joint)) {
            crossing.push(pair);
        }
    }
    crossing
}
