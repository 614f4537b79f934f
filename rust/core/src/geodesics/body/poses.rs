//! Poses as lanes: planes of 64 poses per joint, read by every pass.

use crate::parallel::{self, Interrupt};
use crate::rotations::quaternion::{between, is_missing, product, unit};
use crate::simd::multiversion;
use crate::{ClipView, Error, Real};

/// Poses per tile: the planes of a body fit in the second-level cache for several passes.
pub(super) const TILE: usize = 64;

/// One value per pose of a tile, aligned to a cache line.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
pub(super) struct Lane(pub(super) [f64; TILE]);

impl Lane {
    pub(super) const ZERO: Self = Self([0.0; TILE]);
}

/// Samples of 64 poses: `w`, `x`, `y`, `z` for each joint. Missing samples and padding are four zeros.
pub(super) type Tile = Vec<[Lane; 4]>;

/// Poses relative to their centre, with `w ≥ 0`.
#[derive(Debug)]
pub(super) struct Poses {
    pub(super) tiles: Vec<Tile>,
    pub(super) count: usize,
    pub(super) joints: usize,
}

/// Part of a direction `v` for one joint.
#[derive(Debug, Clone, Copy)]
pub(super) struct Part {
    pub(super) joint: usize,
    /// Unit vector; 0 if the joint does not move.
    pub(super) axis: [f64; 3],
    /// Length of the joint's part of the direction.
    pub(super) length: f64,
}

/// Parts of a direction, three components for each joint in `which`.
pub(super) fn parts(v: &[f64], which: &[usize]) -> Vec<Part> {
    let (v, _) = v.as_chunks::<3>();
    let part = |(&joint, v): (&usize, &[f64; 3])| {
        let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
        let scale = if length > 0.0 { 1.0 / length } else { 0.0 };
        Part { joint, axis: v.map(|x| x * scale), length }
    };
    which.iter().zip(v).map(part).collect()
}

impl Poses {
    /// The given frames of a clip, relative to the means.
    pub(super) fn of_frames<T: Real>(
        clip: ClipView<'_, T>,
        frames: &[usize],
        means: &[[f64; 4]],
        interrupt: &Interrupt,
    ) -> Result<Self, Error> {
        let joints = clip.joints();
        let tiles = parallel::map(frames.chunks(TILE).collect(), frames.len() * joints * 10, |_, frames| {
            interrupt.check()?;
            let mut tile = vec![[Lane::ZERO; 4]; joints];
            for (i, &frame) in frames.iter().enumerate() {
                for (joint, lanes) in tile.iter_mut().enumerate() {
                    let q = clip.at(frame, joint);
                    if !is_missing(q) {
                        set(lanes, i, upper(between(unit(means[joint]), unit(q.map(T::to_f64)))));
                    }
                }
            }
            Ok(tile)
        })?;
        Ok(Self { tiles, count: frames.len(), joints })
    }

    /// At most about `most` of the poses, evenly spaced.
    pub(super) fn subset(&self, most: usize) -> Self {
        let stride = self.count.div_ceil(most).max(1);
        let chosen: Vec<usize> = (0..self.count).step_by(stride).collect();
        let tiles = chosen.chunks(TILE).map(|chosen| {
            let mut tile = vec![[Lane::ZERO; 4]; self.joints];
            for (i, &pose) in chosen.iter().enumerate() {
                for (joint, lanes) in tile.iter_mut().enumerate() {
                    set(lanes, i, self.at(pose, joint));
                }
            }
            tile
        });
        Self { tiles: tiles.collect(), count: chosen.len(), joints: self.joints }
    }

    /// One sample.
    pub(super) fn at(&self, pose: usize, joint: usize) -> [f64; 4] {
        sample(&self.tiles[pose / TILE][joint], pose % TILE)
    }

    /// The joints that are farther than `threshold` from 1 in at least one pose.
    pub(super) fn moving(&self, threshold: f64, interrupt: &Interrupt) -> Result<Vec<usize>, Error> {
        let most = parallel::map(self.tiles.iter().collect(), self.count * self.joints, |_, tile: &Tile| {
            interrupt.check()?;
            let squares = |[_, x, y, z]: &[Lane; 4]| {
                (0..TILE)
                    .fold(0.0, |most, i| f64::max(most, x.0[i] * x.0[i] + y.0[i] * y.0[i] + z.0[i] * z.0[i]))
            };
            Ok(tile.iter().map(squares).collect::<Vec<f64>>())
        })?;
        let moves = |joint: &usize| most.iter().any(|tile| tile[*joint].sqrt() > threshold);
        Ok((0..self.joints).filter(moves).collect())
    }
}

/// Reads a sample from its lanes.
pub(super) fn sample(lanes: &[Lane; 4], i: usize) -> [f64; 4] {
    std::array::from_fn(|c| lanes[c].0[i])
}

/// Writes a sample into its lanes.
pub(super) fn set(lanes: &mut [Lane; 4], i: usize, q: [f64; 4]) {
    for (lane, x) in lanes.iter_mut().zip(q) {
        lane.0[i] = x;
    }
}

/// `q` or `−q`, whichever has `w ≥ 0`.
#[inline(always)]
fn upper(q: [f64; 4]) -> [f64; 4] {
    q.map(|x| x * 1.0_f64.copysign(q[0]))
}

multiversion! {
    /// Replaces the samples by their residuals at the points `c_v(s)`: `c_v(s)⁻¹ x` with `w ≥ 0`; zeros stay zeros.
    pub(super) fn take_away(tile: &mut [[Lane; 4]], v: &[Part], s: &Lane) {
        for part in v {
            let [w, x, y, z] = &mut tile[part.joint];
            for i in 0..TILE {
                let (sin, cos) = Real::sin_cos(s.0[i] * part.length);
                let point = [cos, sin * part.axis[0], sin * part.axis[1], sin * part.axis[2]];
                let q = between(point, [w.0[i], x.0[i], y.0[i], z.0[i]]);
                let square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
                let scale = (if square > 0.0 { 1.0 / square.sqrt() } else { 0.0 }).copysign(q[0]);
                w.0[i] = q[0] * scale;
                x.0[i] = q[1] * scale;
                y.0[i] = q[2] * scale;
                z.0[i] = q[3] * scale;
            }
        }
    }
}

multiversion! {
    /// Moves rotations along a geodesic, `q ← q · c_v(s)`, for the part of one joint.
    pub(super) fn go_on(q: &mut [Lane; 4], part: Part, s: &Lane) {
        let [w, x, y, z] = q;
        for i in 0..TILE {
            let (sin, cos) = Real::sin_cos(s.0[i] * part.length);
            let point = [cos, sin * part.axis[0], sin * part.axis[1], sin * part.axis[2]];
            let q = product([w.0[i], x.0[i], y.0[i], z.0[i]], point);
            w.0[i] = q[0];
            x.0[i] = q[1];
            y.0[i] = q[2];
            z.0[i] = q[3];
        }
    }
}

multiversion! {
    /// Logarithms of a joint's samples; 0 where they are missing.
    pub(super) fn logarithms(samples: &[Lane; 4], out: &mut [Lane; 3]) {
        let [w, x, y, z] = samples;
        let [a, b, c] = out;
        for i in 0..TILE {
            let square = x.0[i] * x.0[i] + y.0[i] * y.0[i] + z.0[i] * z.0[i];
            let sine = (square + f64::TINY_SQUARE).sqrt();
            let factor = sine.atan2_nonnegative(w.0[i]) / sine;
            a.0[i] = x.0[i] * factor;
            b.0[i] = y.0[i] * factor;
            c.0[i] = z.0[i] * factor;
        }
    }
}
