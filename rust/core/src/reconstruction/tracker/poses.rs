//! A database, as the tracker reads it.

use crate::Error;
use crate::error::check_length;
use crate::reconstruction::frame::HORIZONTAL;
use crate::reconstruction::kinematics::ROOT;
use crate::rotations::quaternion::{between, log_short, of_row};
use crate::search::poses::graph::Graph;

/// Poses of many clips, with the positions of the control points.
#[derive(Debug, Clone, Copy)]
pub struct Poses<'a> {
    /// Rotations, `(poses, joints, 4)`; the root's without heading.
    pub rotations: &'a [f32],
    /// Headings of the root, radians, `(poses)`.
    pub heading: &'a [f32],
    /// Positions of the root, scaled to the reconstructed body, `(poses, 3)`.
    pub translation: &'a [f32],
    /// Control-point trajectories, `(poses, points, 3)`.
    pub trajectories: &'a [f32],
    /// The first pose of each clip, followed by the number of poses.
    pub starts: &'a [i64],
    /// Feature vectors of the poses, `(poses, 3·joints)`.
    pub features: &'a [f32],
    /// Mean rotations to which the features are relative, `(joints, 4)`.
    pub mean_rotations: &'a [f64],
    /// Weight of each joint in the features, `(joints)`.
    pub joint_weights: &'a [f64],
    /// Graph of neighbours for the search of examples; `None`: every frame has a full search.
    pub graph: Option<Graph<'a>>,
}

impl Poses<'_> {
    pub(super) fn joints(&self) -> usize {
        self.joint_weights.len()
    }

    pub(super) fn count(&self) -> usize {
        self.heading.len()
    }

    pub(super) fn check(&self, joints: usize, points: usize) -> Result<(), Error> {
        let count = self.heading.len();
        check_length("joint_weights", joints, self.joint_weights.len())?;
        check_length("mean_rotations", 4 * joints, self.mean_rotations.len())?;
        check_length("rotations", 4 * count * joints, self.rotations.len())?;
        check_length("translation", 3 * count, self.translation.len())?;
        check_length("trajectories", 3 * count * points, self.trajectories.len())?;
        check_length("features", 3 * count * joints, self.features.len())?;
        let order = self.starts.first() == Some(&0)
            && self.starts.is_sorted()
            && self.starts.last().is_some_and(|&last| usize::try_from(last) == Ok(count));
        if order {
            Ok(())
        } else {
            Err(Error::Parameter { name: "starts", expected: "borders of the clips" })
        }
    }

    /// Ranges of poses with at least `frames` poses of their clip before them.
    pub(super) fn with_history(&self, frames: usize) -> impl Iterator<Item = std::ops::Range<usize>> {
        self.starts.windows(2).filter_map(move |ends| {
            let (start, stop) = (usize::try_from(ends[0]).ok()? + frames, usize::try_from(ends[1]).ok()?);
            (start < stop).then_some(start..stop)
        })
    }

    /// Whether a clip ends between two poses.
    pub(super) fn border(&self, first: usize, second: usize) -> bool {
        let before = |pose: usize| {
            self.starts.partition_point(|&start| usize::try_from(start).is_ok_and(|start| start <= pose))
        };
        before(first) != before(second)
    }

    /// Appends the feature vector of a pose.
    pub(super) fn feature(&self, pose: &[f64], out: &mut Vec<f64>) {
        let joints = pose.chunks_exact(4).zip(self.mean_rotations.chunks_exact(4)).zip(self.joint_weights);
        for ((q, mean), &weight) in joints {
            let vector = log_short(between(of_row(mean), of_row(q)));
            out.extend(vector.map(|v| weight.sqrt() * (2.0 * v)));
        }
    }

    /// The rotations of a range of poses.
    pub(super) fn segment(&self, poses: std::ops::Range<usize>) -> &[f32] {
        let width = 4 * self.joints();
        &self.rotations[poses.start * width..poses.end * width]
    }

    pub(super) fn place(&self, pose: usize) -> [f64; 3] {
        std::array::from_fn(|c| f64::from(self.translation[3 * pose + c]))
    }

    /// Root displacement of an example from its previous pose: step along the two axes of the previous heading,
    /// height, change of heading.
    pub(super) fn root_step(&self, example: usize, up: usize) -> [f64; ROOT] {
        let [first, second] = HORIZONTAL[up];
        let (here, before) = (self.place(example), self.place(example - 1));
        let angle = f64::from(self.heading[example - 1]);
        let step = [here[first] - before[first], here[second] - before[second]];
        let (s, c) = crate::Real::sin_cos(angle % std::f64::consts::TAU);
        [
            c * step[0] + s * step[1],
            c * step[1] - s * step[0],
            here[up],
            f64::from(self.heading[example]) - angle,
        ]
    }
}
