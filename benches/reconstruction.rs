//! Motion from a few trajectories: the models of the next pose, and a tracker that follows control points.

use quatfilt_benches::clips;
use quatfilt_benches::timer::Timer;
use quatfilt_core::motion::skeleton::{Tree, forward_kinematics};
use quatfilt_core::parallel::Interrupt;
use quatfilt_core::reconstruction::features::pose_features;
use quatfilt_core::reconstruction::kinematics::Body;
use quatfilt_core::reconstruction::local_models::{Model, Neighbors, Options, predict_pose};
use quatfilt_core::reconstruction::solver::Targets;
use quatfilt_core::reconstruction::tracker::{self, Poses, Tables, Tracker};
use quatfilt_core::search::poses::graph::{self, Apart, Graph};
use quatfilt_core::search::poses::walk::Fallback;
use quatfilt_core::search::poses::{Index, Segments};
use quatfilt_core::{ClipView, Error, Real};
use std::sync::Arc;

/// Poses before the next one.
const ORDER: usize = 3;

/// Frames of the clip from one example to the next.
const APART: usize = 8;

fn main() -> Result<(), Error> {
    let mut timer = Timer::new();
    let models = [
        ("local_regression", Model::LocalRegression),
        ("local_pcr", Model::LocalPcr),
        ("local_pca", Model::LocalPca),
        ("mean_pose", Model::MeanPose),
    ];
    for (name, model) in models {
        for size in timer.sizes(&[64]) {
            predictions::<f32>(&mut timer, name, model, size)?;
        }
    }
    for size in timer.sizes(&[10_000]) {
        tracker(&mut timer, size)?;
    }
    Ok(())
}

/// One prediction from as many neighbours as `size` has frames.
fn predictions<T: Real>(
    timer: &mut Timer,
    name: &str,
    model: Model,
    size: (usize, usize),
) -> Result<(), Error> {
    let (count, joints) = size;
    let clip = clips::rotations::<T>(count * APART, joints, 1)?;
    let pose = joints * 4;
    let segment = |start: usize, frames: usize| &clip[start * pose..(start + frames) * pose];
    let segments: Vec<T> = (0..count).flat_map(|k| segment(k * APART, ORDER + 1)).copied().collect();
    let root_steps = vec![T::ONE; count * 4];
    let neighbors = Neighbors {
        segments: &segments,
        root_steps: &root_steps,
        differences: &[],
        count,
        frames: ORDER + 1,
        joints,
        roots: 4,
        signals: 0,
    };
    let options = Options { model, ..Options::default() };
    let weights = vec![1.0; joints];
    let interrupt = Interrupt::new();
    let recent = segment(APART / 2, ORDER);
    timer.levels::<T, _, _>(&format!("reconstruction/{name}"), size, || {
        predict_pose(&neighbors, recent, &weights, &options, &interrupt)
    })
}

/// Joints that are control points: the ends of limbs.
const POINTS: [usize; 4] = [6, 12, 18, 24];

/// The axis that points up.
const UP: usize = 1;

/// Neighbours of a pose.
const DEGREE: usize = 16;

/// A frame of a motion of the database itself, there and back again, with all poses looked at and along a graph.
fn tracker(timer: &mut Timer, size: (usize, usize)) -> Result<(), Error> {
    let (count, joints) = size;
    let parents = clips::parents(joints);
    let (weights, starts, interrupt) = (vec![1.0; joints], [0, count], Interrupt::new());
    let offsets: Vec<f64> =
        (0..joints).flat_map(|joint| [0.0, if joint == 0 { 0.0 } else { 20.0 }, 0.0]).collect();
    let means = [1.0, 0.0, 0.0, 0.0].repeat(joints);
    let mut rotations = clips::rotations::<f32>(count, joints, 1)?;
    for pose in rotations.chunks_exact_mut(4 * joints) {
        pose[..4].copy_from_slice(&[1.0, 0.0, 0.0, 0.0]);
    }
    let clip = ClipView::new(&rotations, count, joints)?;
    let (heading, translation) = (vec![0.0; count], [0.0, 90.0, 0.0].repeat(count));
    let mut features = vec![0.0; count * 3 * joints];
    pose_features(clip, &means, &weights, &mut features)?;
    let mut places = vec![0.0; count * 3 * joints];
    let short: Vec<f32> = offsets.iter().map(|&x| Real::from_f64(x)).collect();
    forward_kinematics(clip, &translation, Tree { parents: &parents, offsets: &short }, &mut places)?;
    let trajectories: Vec<f32> = places
        .chunks_exact(3 * joints)
        .flat_map(|pose| POINTS.iter().flat_map(|&point| pose[3 * point..3 * point + 3].to_vec()))
        .collect();
    let segments = Segments::new(&features, 3 * joints, &starts, 1, 1)?;
    let (mut indices, mut distances) = (vec![0; count * DEGREE], vec![0.0; count * DEGREE]);
    let out = graph::Neighbors { degree: DEGREE, indices: &mut indices, distances: &mut distances };
    let apart = Apart { exclusion: 15, spacing: 8 };
    graph::neighbors(&segments, &Index::new(&segments, &interrupt)?, apart, out, &interrupt)?;
    let borders = [0, i64::try_from(count).unwrap_or(i64::MAX)];
    for (name, graph) in [("track", None), ("track_along_graph", Some(Graph::new(&indices, count, DEGREE)?))]
    {
        let poses = Poses {
            rotations: &rotations,
            heading: &heading,
            translation: &translation,
            trajectories: &trajectories,
            starts: &borders,
            features: &features,
            mean_rotations: &means,
            joint_weights: &weights,
            graph,
        };
        let body = Body::new(&parents, &offsets, &POINTS, UP)?;
        let mut tracker = Tracker::new(body, options(), None, Arc::<Tables>::default())?;
        let mut frame = 0;
        timer.levels::<f32, _, _>(&format!("reconstruction/{name}"), size, || {
            frame = (frame + 1) % (2 * count);
            let at = frame.min(2 * count - 1 - frame) * 3 * POINTS.len();
            let positions: Vec<f64> =
                trajectories[at..at + 3 * POINTS.len()].iter().map(|&x| f64::from(x)).collect();
            let seen = Targets {
                positions: &positions,
                position_deviations: &[1.0; POINTS.len()],
                orientations: &[1.0, 0.0, 0.0, 0.0].repeat(POINTS.len()),
                orientation_deviations: &[f64::INFINITY; POINTS.len()],
            };
            tracker.push(&poses, &seen, &interrupt)
        })?;
    }
    Ok(())
}

/// Those of a reconstructor at 60 frames per second, for a body of two metres.
fn options() -> tracker::Options {
    tracker::Options {
        order: ORDER,
        neighbors: 64,
        stride: 4,
        spacing: APART,
        window: vec![0, 5, 10, 15],
        scale: 6.0,
        patience: 15,
        model: Options { ridge: 0.1, share: 0.95, ..Options::default() },
        floor: [0.045, 2.5, 2.5, 0.5, 0.05],
        steps: 12,
        fallback: Fallback { frames: 60, ratio: 1.5 },
    }
}
