//! What patches are never nearer than, told without angles.
//!
//! Two unit quaternions `a` and `b` are turned by `θ ≥ 2 |a ∓ b|` against each other, and `|a ∓ b|²` is `|a|² + |b|² − 2 |a·b|`. So
//! squared distances of patches are at least sums of inner products along diagonals, which are several times as cheap as sums
//! of angles: the *chords*. The mean over the frames of a patch, as a point in space, and of that the few coordinates in which
//! means differ most, tell less and cost less still: the *points*, one inner product for a pair of patches.
//!
//! - `axes`: the numbers of a frame;
//! - `points`: patches as points;
//! - `stage`: the numbers of many frames side by side, and what they tell;
//! - `strip`: the numbers of a few frames, which are compared with all of those;
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

/// Candidates of a tile: its products with a strip stay within the second-level cache.
pub(crate) const COLUMNS: usize = 128;

/// Frames of the longest patch whose chords are added up: of longer ones, tiles would be little beside their borders.
pub(crate) const LONGEST: usize = 64;

/// Patches of a block.
const BLOCK: usize = 2;

/// Fewer numbers of a frame are not worth points.
const FEW_AXES: usize = 2 * points::WIDTH;

/// Fewer candidates are not worth finding the directions of points.
const FEW_CANDIDATES: usize = 2048;

/// Patches from which the directions are learnt.
const SAMPLE: usize = 256;

/// Frames per task.
const TASK: usize = 1024;

/// Candidates in sequence, ready to be compared with frames.
#[derive(Debug)]
pub(crate) struct Bounds<T> {
    kinds: Vec<Kind>,
    chords: Option<(Axes<T>, Stage<T>)>,
    points: Option<Points<T>>,
}

impl<T: Real> Bounds<T> {
    /// Reads the candidates of a side, all of whose samples must be there.
    ///
    /// What they are compared with must have joints of the same kinds.
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

    /// Whether they tell anything about frames, which have to be compared as the candidates are.
    pub(crate) fn apply_to(&self, features: &Features<'_, T>) -> bool {
        let any = self.chords.is_some() || self.points.is_some();
        any && self.kinds.iter().zip(features.joints).all(|(kind, joint)| *kind == joint.kind)
    }
}
