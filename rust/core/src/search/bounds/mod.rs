//! Lower bounds of patch distances that need no angles.
//!
//! For unit quaternions `a` and `b`, the rotation angle between them satisfies `θ ≥ 2 |a ∓ b|`, and `|a ∓ b|²` is
//! `|a|² + |b|² − 2 |a·b|`. So a squared patch distance is at least a sum of inner products along a diagonal, several
//! times as cheap as a sum of angles: the *chord bound*. The mean over the frames of a patch is a point in space, and
//! its projection on the few directions of largest variance is shorter still. Both give a weaker but cheaper bound,
//! one inner product for each pair of patches: the *point bound*.
//!
//! - `axes`: the coordinates of a frame;
//! - `points`: patches as points;
//! - `stage`: the coordinates of all candidates side by side, and the bounds from their inner products;
//! - `strip`: the coordinates of a few frames, compared with all candidates;
//! - `kernels`: the vectorised loops.

mod axes;
mod kernels;
mod points;
mod stage;
mod strip;

use super::diagonal::Measure;
use super::features::{Features, Kind, Side};
use crate::parallel::{self, Interrupt};
use crate::{Error, Real};
use axes::Axes;
use points::Points;
use stage::Stage;
pub(crate) use strip::Strip;

/// Frames of a strip.
pub(crate) const ROWS: usize = 128;

/// Candidates of a tile. The products of a tile with a strip fit in the second-level cache.
pub(crate) const COLUMNS: usize = 128;

/// Longest patch, in frames, for which the chord bound is used. For longer patches the border of a tile outweighs the
/// tile.
pub(crate) const LONGEST: usize = 64;

/// Consecutive patches per block.
const BLOCK: usize = 2;

/// Least number of coordinates per frame for which the point bound pays off.
const FEW_AXES: usize = 2 * points::WIDTH;

/// Least number of candidates for which it pays off to compute the directions of projection.
const FEW_CANDIDATES: usize = 2048;

/// Number of patches from which the directions of projection are computed.
const SAMPLE: usize = 256;

/// Frames per task.
const TASK: usize = 1024;

/// Bound data of consecutive candidates, ready to be compared with frames.
#[derive(Debug)]
pub(crate) struct Bounds<T> {
    kinds: Vec<Kind>,
    chords: Option<(Axes<T>, Stage<T>)>,
    points: Option<Points<T>>,
}

impl<T: Real> Bounds<T> {
    /// Reads the candidates of `side`, which must have no missing samples.
    ///
    /// The frames that are compared with them must have joints of the same kinds.
    pub(crate) fn new(
        measure: &Measure<T>,
        side: &Side<'_, T>,
        interrupt: &Interrupt,
    ) -> Result<Self, Error> {
        let features = &side.features;
        let kinds: Vec<Kind> = features.joints.iter().map(|joint| joint.kind).collect();
        let stride = side.count.div_ceil(SAMPLE).max(1);
        let sample: Vec<usize> = (side.at..side.at + side.count).step_by(stride).collect();
        let chords = if measure.window() <= LONGEST {
            let mut axes = Axes::chords(measure, &kinds);
            axes.centre(features, &sample);
            let stage = Self::chords(&axes, measure, side, interrupt)?;
            Some((axes, stage))
        } else {
            None
        };
        let mut axes = Axes::points(measure, &kinds);
        let points = if side.count >= FEW_CANDIDATES && axes.count() > FEW_AXES {
            axes.centre(features, &sample);
            Some(Points::new(axes, &sample, measure, side, interrupt)?)
        } else {
            None
        };
        Ok(Self { kinds, chords, points })
    }

    fn chords(
        axes: &Axes<T>,
        measure: &Measure<T>,
        side: &Side<'_, T>,
        interrupt: &Interrupt,
    ) -> Result<Stage<T>, Error> {
        let mut stage =
            Stage::new(measure, axes.count(), axes.signed, side.count, COLUMNS, measure.window() - 1);
        let columns = side.count + measure.window() - 1;
        let start = side.at - measure.before;
        let tasks = stage.tasks(TASK);
        let squares = parallel::map(tasks, columns * axes.count(), |task, mut panels| {
            interrupt.check()?;
            let first = task * TASK;
            let count = TASK.min(columns.saturating_sub(first));
            let (mut planes, mut squares) = (Vec::new(), vec![T::ZERO; count]);
            axes.each_group(
                &side.features,
                start + first..start + first + count,
                &mut planes,
                |axis, group| {
                    kernels::add_squares(&mut squares, group);
                    panels.write(axis, group);
                },
            );
            Ok(squares)
        })?;
        stage.add_up(&squares.concat(), measure.window());
        Ok(stage)
    }

    /// Whether the bounds hold for `features`: a bound exists and the kinds of all joints agree.
    pub(crate) fn apply_to(&self, features: &Features<'_, T>) -> bool {
        let any = self.chords.is_some() || self.points.is_some();
        any && self.kinds.iter().zip(features.joints).all(|(kind, joint)| *kind == joint.kind)
    }
}
