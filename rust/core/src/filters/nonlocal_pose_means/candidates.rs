//! The most similar candidates of each frame of a tile, from the clip and a library, by patch search.

use super::kernels::{FARTHEST, SHIFT};
use super::means::Means;
use super::path::JointChart;
use super::tile::Tile;
use super::{Distance, NonlocalPoseMeans, Reach};
use crate::parallel::Interrupt;
use crate::search::bounds::Bounds;
use crate::search::diagonal::Measure;
use crate::search::features::{Features, Joint, Kind, Side};
use crate::search::join::{Join, Lags, Scratch};
use crate::search::nearest::{Lists, Ties};
use crate::search::patch_neighbors::{Loaded, Poses};
use crate::{ClipView, Error, Real};
use std::ops::Range;

/// Largest factor of a squared difference: sums of such products stay finite in float32 too.
const LARGEST_FACTOR: f64 = 1e30;

/// Coordinates of a rotation: the weight of a pair of samples in the divisor of a mean.
const COORDINATES: f64 = 3.0;

/// Least number of frames for which bounds pay off.
const MANY_FRAMES: usize = 128;

/// Clips whose frames are candidates of every frame.
#[derive(Debug)]
pub(super) struct Library<T> {
    scenes: Vec<Scene<T>>,
    frames: usize,
}

/// A clip of the library.
#[derive(Debug)]
struct Scene<T> {
    loaded: Loaded<T>,
    frames: usize,
    /// Index of its first frame, counted through the library.
    first: usize,
    /// Bounds for each group of joints that share weights, if no sample is missing.
    bounds: Vec<Bounds<T>>,
}

impl<T: Real> Library<T> {
    /// Loads clips; `shared` is whether samples of the filtered clip have confidences.
    pub(super) fn new(
        filter: &NonlocalPoseMeans,
        clip: ClipView<'_, T>,
        clips: &[ClipView<'_, T>],
        shared: bool,
        reach: Reach,
        groups: &[Range<usize>],
        interrupt: &Interrupt,
    ) -> Result<Self, Error> {
        let poses = Poses::new(clip, clips, shared, interrupt)?;
        let pad = reach.before;
        let (mut scenes, mut frames) = (Vec::with_capacity(clips.len()), 0);
        for clip in clips.iter().filter(|clip| clip.frames() > 0) {
            let mut loaded = Loaded::default();
            poses.load(*clip, 0..clip.frames(), pad, &mut loaded);
            // The signs of the filtered clip do not apply to those of the library.
            let joints = loaded.features().joints.iter().map(|joint| Joint { kind: Kind::Wide, ..*joint });
            let joints: Vec<Joint> = joints.collect();
            let features = Features { joints: &joints, ..loaded.features() };
            let side = Side { features, at: pad, first: 0, count: clip.frames() };
            let bounds = if poses.complete() {
                groups
                    .iter()
                    .map(|group| Bounds::new(&filter.measure(group.clone(), reach), &side, interrupt))
                    .collect::<Result<_, _>>()?
            } else {
                Vec::new()
            };
            scenes.push(Scene { loaded, frames: clip.frames(), first: frames, bounds });
            frames += clip.frames();
        }
        Ok(Self { scenes, frames })
    }

    /// Planes of a joint of the clip that contains a frame, the frame's column, and the weight of the sample.
    pub(super) fn sample(&self, frame: usize, joint: usize, before: usize) -> ([T; 4], T) {
        let scene = &self.scenes[self.scenes.partition_point(|scene| scene.first <= frame) - 1];
        let column = before + frame - scene.first;
        let features = scene.loaded.features();
        let q = features.planes.rows_from::<4>(features.joints[joint].row).map(|q| q[column]);
        (q, features.shares.map_or(T::ONE, |shares| shares.row(joint)[column]))
    }
}

impl NonlocalPoseMeans {
    /// The patch distance of some joints: the square root of the exponent.
    pub(super) fn measure<T: Real>(&self, joints: Range<usize>, reach: Reach) -> Measure<T> {
        let factor = |bandwidth: &f64| T::from_f64((0.5 / bandwidth.powi(2)).min(LARGEST_FACTOR));
        Measure {
            before: reach.before,
            after: reach.after,
            factors: self.bandwidth.iter().map(factor).collect(),
            units: vec![T::from_f64(COORDINATES); self.bandwidth.len()],
            joints,
            averaged: self.distance == Distance::Mean,
        }
    }
}

impl<T: Real> Tile<'_, T> {
    /// The distance of each joint.
    fn kinds(&self) -> Vec<Joint> {
        let kind = |chart: &JointChart<T>| match chart {
            JointChart::Local => Kind::Wide,
            JointChart::Fixed(_) => Kind::Vector,
        };
        let charts = self.clip.paths.charts.iter();
        self.rows.iter().zip(charts).map(|(&row, chart)| Joint { row, kind: kind(chart) }).collect()
    }

    fn features<'a>(&'a self, kinds: &'a [Joint]) -> Features<'a, T> {
        Features { planes: &self.planes, joints: kinds, shares: self.confidence.as_ref() }
    }

    /// The candidates of the clip; their indices are their columns.
    fn own<'a>(&self, features: Features<'a, T>) -> Side<'a, T> {
        let Range { start, end } = self.candidates;
        Side { features, at: start, first: start, count: end - start }
    }

    /// Lower bounds of the candidates' distances for each group, if the search covers the whole clip and the bounds
    /// apply.
    pub(super) fn bounds(&self, interrupt: &Interrupt) -> Result<Vec<Bounds<T>>, Error> {
        let reach = self.clip.reach;
        let far = self.clip.filter.neighbors.is_some() && !reach.added && self.clip.frames >= MANY_FRAMES;
        if !far || self.confidence.is_some() || self.candidates.start < reach.before {
            return Ok(Vec::new());
        }
        let kinds = self.kinds();
        let side = self.own(self.features(&kinds));
        let groups = self.clip.filter.groups(self.rows.len()).into_iter();
        groups
            .map(|joints| {
                Bounds::new(&self.clip.filter.measure(joints, reach).halved(&kinds), &side, interrupt)
            })
            .collect()
    }

    /// Adds the `count` most similar candidates of the window and the library, for a group of joints.
    pub(super) fn add_nearest(
        &self,
        count: usize,
        group: usize,
        joints: Range<usize>,
        means: &mut Means<'_, T>,
        scratch: &mut Scratch<T>,
        interrupt: &Interrupt,
    ) -> Result<(), Error> {
        let reach = self.clip.reach;
        let kinds = self.kinds();
        let measure = self.clip.filter.measure(joints, reach).halved(&kinds);
        let features = self.features(&kinds);
        let library = self.clip.library.as_ref();
        let others = library.map_or(0, |library| library.frames);
        let count = count.min(reach.back + reach.ahead + others);
        let lists = Lists::new(self.at, self.frames, self.frames, count, Ties::Nearer);
        let frames = Side { features, at: self.at, first: self.at, count: self.frames };
        let candidates = self.own(features);
        let bounds = if self.frames >= MANY_FRAMES { self.clip.bounds.get(group) } else { None };
        let lags = Lags { within: -reach.back.cast_signed()..=reach.ahead.cast_signed(), without: 0..=0 };
        let window = Join { measure: &measure, frames, candidates, lags, bounds, mutual: false };
        window.run(&lists, scratch, interrupt)?;
        // Indices of library frames follow those of all columns.
        let beyond = self.planes.length();
        for scene in library.iter().flat_map(|library| &library.scenes) {
            let candidates = Side {
                features: scene.loaded.features(),
                at: reach.before,
                first: beyond + scene.first,
                count: scene.frames,
            };
            let bounds = if self.frames >= MANY_FRAMES { scene.bounds.get(group) } else { None };
            let join =
                Join { measure: &measure, frames, candidates, lags: Lags::all(), bounds, mutual: false };
            join.run(&lists, scratch, interrupt)?;
        }
        let Some(nearest) = lists.into_nearest().next() else { return Ok(()) };
        for frame in 0..self.frames {
            for (distance, number) in nearest.of(frame) {
                let exponent = distance * distance;
                if exponent > T::from_f64(FARTHEST) {
                    break;
                }
                let weight = (T::from_f64(SHIFT) - exponent).exp();
                match number.checked_sub(beyond) {
                    Some(other) => means.add_other(frame, other, weight),
                    None => means.add_one(frame, number, weight),
                }
            }
        }
        Ok(())
    }
}
