//! Motion from trajectories of some joints.

use crate::array::{BUG, elements, input, numbers, run, run_interruptible, to_python};
use crate::reconstruction::local_models;
use crate::reconstruction::solver::{array, body};
use numpy::{PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyType;
use quatfilt_core::Error;
use quatfilt_core::parallel::Interrupt;
use quatfilt_core::reconstruction::kinematics::{Body, ROOT};
use quatfilt_core::reconstruction::solver::Targets;
use quatfilt_core::reconstruction::tracker::{Options, Poses, State, Tables, Tracker};
use quatfilt_core::search::poses::graph::Graph;
use quatfilt_core::search::poses::walk::Fallback;
use std::sync::{Arc, Mutex, TryLockError};

/// Nanoseconds that a frame takes beside the search, by which it is decided whether to listen for Ctrl-C.
const FRAME: usize = 500_000;

/// The arrays of a database: rotations, heading, translation, trajectories, starts, features, mean rotations, joint weights, the graph or
/// none, and the tables that trackers share, or none.
type Arrays<'py> = (
    Bound<'py, PyAny>,
    Bound<'py, PyAny>,
    Bound<'py, PyAny>,
    Bound<'py, PyAny>,
    Bound<'py, PyAny>,
    Bound<'py, PyAny>,
    Bound<'py, PyAny>,
    Bound<'py, PyAny>,
    Option<Bound<'py, PyAny>>,
    Option<Bound<'py, TrackerTables>>,
);

/// What trackers of the same arrays, options and control points share.
#[pyclass(frozen, module = "quatfilt._core")]
pub(crate) struct TrackerTables(Arc<Tables>);

#[pymethods]
impl TrackerTables {
    /// Empty ones, which the first frame of a tracker fills.
    #[new]
    fn new() -> Self {
        Self(Arc::default())
    }

    /// A copy is empty.
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> (Bound<'py, PyType>, ()) {
        (slf.get_type(), ())
    }
}

/// The tables that trackers share, or some of its own.
fn tables(poses: &Arrays<'_>) -> Arc<Tables> {
    poses.9.as_ref().map_or_else(Arc::default, |tables| Arc::clone(&tables.get().0))
}

/// Order, neighbors, stride, spacing, window, scale, patience, floor, steps, refresh and ratio.
type OptionsTuple = (usize, usize, usize, usize, Vec<usize>, f64, usize, [f64; 1 + ROOT], usize, usize, f64);

/// Model, target, deviation, bandwidth, ridge, share.
type Model = (String, String, String, f64, f64, f64);

/// Recent poses, place and heading.
type Initial<'py> = (Bound<'py, PyAny>, [f64; 3], f64);

type Tracked = (Py<PyAny>, Py<PyAny>, Py<PyAny>);

/// The borrowed arrays of a database.
struct Borrowed<'py> {
    small: [PyReadonlyArrayDyn<'py, f32>; 5],
    starts: PyReadonlyArrayDyn<'py, i64>,
    mean_rotations: PyReadonlyArrayDyn<'py, f64>,
    joint_weights: PyReadonlyArrayDyn<'py, f64>,
    graph: Option<PyReadonlyArrayDyn<'py, i32>>,
}

impl<'py> Borrowed<'py> {
    fn new(arrays: &Arrays<'py>) -> PyResult<Self> {
        let (
            rotations,
            heading,
            translation,
            trajectories,
            starts,
            features,
            mean_rotations,
            joint_weights,
            graph,
            _,
        ) = arrays;
        Ok(Self {
            small: [
                input("rotations", rotations)?,
                input("heading", heading)?,
                input("translation", translation)?,
                input("trajectories", trajectories)?,
                input("features", features)?,
            ],
            starts: input("starts", starts)?,
            mean_rotations: input("mean_rotations", mean_rotations)?,
            joint_weights: input("joint_weights", joint_weights)?,
            graph: graph.as_ref().map(|graph| input("graph", graph)).transpose()?,
        })
    }

    fn poses(&self) -> PyResult<Poses<'_>> {
        let [rotations, heading, translation, trajectories, features] = &self.small;
        Ok(Poses {
            rotations: elements("rotations", rotations)?,
            heading: elements("heading", heading)?,
            translation: elements("translation", translation)?,
            trajectories: elements("trajectories", trajectories)?,
            starts: elements("starts", &self.starts)?,
            features: elements("features", features)?,
            mean_rotations: elements("mean_rotations", &self.mean_rotations)?,
            joint_weights: elements("joint_weights", &self.joint_weights)?,
            graph: self.graph.as_ref().map(graph).transpose()?,
        })
    }
}

/// The neighbours `(poses, degree)` of all poses.
fn graph<'a>(array: &'a PyReadonlyArrayDyn<'_, i32>) -> PyResult<Graph<'a>> {
    let &[poses, degree] = array.shape() else {
        return Err(PyValueError::new_err(format!("graph: expected two axes, got {}", array.shape().len())));
    };
    Graph::new(elements("graph", array)?, poses, degree).map_err(to_python)
}

/// A tracker of a body, with its options.
fn tracker(
    body: Body,
    tuple: OptionsTuple,
    model: &Model,
    initial: Option<Initial<'_>>,
    tables: Arc<Tables>,
) -> PyResult<Tracker> {
    let (order, neighbors, stride, spacing, window, scale, patience, floor, steps, frames, ratio) = tuple;
    let (name, target, deviation, bandwidth, ridge, share) = model;
    let model = local_models::options(name, target, deviation, *bandwidth, *ridge, *share)?;
    let options = Options {
        order,
        neighbors,
        stride,
        spacing,
        window,
        scale,
        patience,
        model,
        floor,
        steps,
        fallback: Fallback { frames, ratio },
    };
    let state = initial
        .map(|(recent, place, heading)| {
            Ok::<_, PyErr>(State { recent: numbers("initial", &recent)?, place, heading })
        })
        .transpose()?;
    Tracker::new(body, options, state, tables).map_err(to_python)
}

/// Rotations `(frames, joints, 4)`, translation `(frames, 3)` and energies `(frames, 2)` of the motion that follows
/// trajectories `(frames, points, …)`.
#[pyfunction]
#[pyo3(signature = (
    parents, offsets, points, up, poses, options, model, initial, positions, position_deviations, orientations,
    orientation_deviations, /
))]
#[allow(
    clippy::too_many_arguments,
    clippy::needless_pass_by_value,
    reason = "the reference's, as Python hands them over"
)]
pub(crate) fn track<'py>(
    py: Python<'py>,
    parents: &Bound<'py, PyAny>,
    offsets: &Bound<'py, PyAny>,
    points: &Bound<'py, PyAny>,
    up: usize,
    poses: Arrays<'py>,
    options: OptionsTuple,
    model: Model,
    initial: Option<Initial<'py>>,
    positions: &Bound<'py, PyAny>,
    position_deviations: &Bound<'py, PyAny>,
    orientations: &Bound<'py, PyAny>,
    orientation_deviations: &Bound<'py, PyAny>,
) -> PyResult<Tracked> {
    let body = body(parents, offsets, points, up)?;
    let (joints, points) = (body.joints(), body.points());
    let mut tracker = tracker(body, options, &model, initial, tables(&poses))?;
    let borrowed = Borrowed::new(&poses)?;
    let poses = borrowed.poses()?;
    let positions = input::<f64>("positions", positions)?;
    let frames = positions.shape().first().copied().unwrap_or(0);
    let positions = elements("positions", &positions)?;
    let position_deviations = numbers("position_deviations", position_deviations)?;
    let orientations = numbers("orientations", orientations)?;
    let orientation_deviations = numbers("orientation_deviations", orientation_deviations)?;
    let (mut rotations, mut translation, mut energies) = (Vec::new(), Vec::new(), Vec::new());
    let work = frames.saturating_mul(FRAME + poses.features.len());
    run_interruptible(py, work, |interrupt| {
        for frame in 0..frames {
            interrupt.check()?;
            let row = |values: &'_ [f64], width: usize| -> Result<std::ops::Range<usize>, Error> {
                let range = frame * points * width..(frame + 1) * points * width;
                if range.end <= values.len() {
                    return Ok(range);
                }
                Err(Error::Length { name: "positions", expected: range.end, got: values.len() })
            };
            let seen = Targets {
                positions: &positions[row(positions, 3)?],
                position_deviations: &position_deviations[row(&position_deviations, 1)?],
                orientations: &orientations[row(&orientations, 4)?],
                orientation_deviations: &orientation_deviations[row(&orientation_deviations, 1)?],
            };
            let pose = tracker.push(&poses, &seen, interrupt)?;
            rotations.extend(pose.rotations);
            translation.extend(pose.translation);
            energies.extend(pose.energies);
        }
        Ok(())
    })?;
    Ok((
        array(py, &[frames, joints, 4], &rotations)?,
        array(py, &[frames, 3], &translation)?,
        array(py, &[frames, 2], &energies)?,
    ))
}

/// A tracker that takes control points frame by frame; the arguments are those of `track` before the trajectories.
#[pyfunction]
#[pyo3(signature = (parents, offsets, points, up, poses, options, model, initial, /))]
#[allow(
    clippy::too_many_arguments,
    clippy::needless_pass_by_value,
    reason = "the reference's, as Python hands them over"
)]
pub(crate) fn track_stream<'py>(
    parents: &Bound<'py, PyAny>,
    offsets: &Bound<'py, PyAny>,
    points: &Bound<'py, PyAny>,
    up: usize,
    poses: Arrays<'py>,
    options: OptionsTuple,
    model: Model,
    initial: Option<Initial<'py>>,
) -> PyResult<MotionTracker> {
    let body = body(parents, offsets, points, up)?;
    let tracker = tracker(body, options, &model, initial, tables(&poses))?;
    let (a, b, c, d, e, f, g, h, graph, _) = poses;
    let poses = [a, b, c, d, e, f, g, h].map(Bound::unbind);
    Ok(MotionTracker { poses, graph: graph.map(Bound::unbind), tracker: Mutex::new(tracker) })
}

/// A motion that follows control points as they come.
#[pyclass(frozen, module = "quatfilt._core")]
pub(crate) struct MotionTracker {
    poses: [Py<PyAny>; 8],
    graph: Option<Py<PyAny>>,
    tracker: Mutex<Tracker>,
}

#[pymethods]
impl MotionTracker {
    /// Takes the control points of a frame, `(points, 3)`, `(points)`, `(points, 4)` and `(points)`; returns rotations
    /// `(joints, 4)`, translation `(3)` and energies `(2)`.
    #[pyo3(signature = (positions, position_deviations, orientations, orientation_deviations, /))]
    fn push(
        &self,
        py: Python<'_>,
        positions: &Bound<'_, PyAny>,
        position_deviations: &Bound<'_, PyAny>,
        orientations: &Bound<'_, PyAny>,
        orientation_deviations: &Bound<'_, PyAny>,
    ) -> PyResult<Tracked> {
        let [a, b, c, d, e, f, g, h] = self.poses.each_ref().map(|array| array.bind(py).clone());
        let graph = self.graph.as_ref().map(|array| array.bind(py).clone());
        let borrowed = Borrowed::new(&(a, b, c, d, e, f, g, h, graph, None))?;
        let poses = borrowed.poses()?;
        let positions = numbers("positions", positions)?;
        let position_deviations = numbers("position_deviations", position_deviations)?;
        let orientations = numbers("orientations", orientations)?;
        let orientation_deviations = numbers("orientation_deviations", orientation_deviations)?;
        let mut tracker = match self.tracker.try_lock() {
            Ok(tracker) => tracker,
            Err(TryLockError::WouldBlock) => {
                return Err(PyRuntimeError::new_err(
                    "stream: expected one call at a time, got one during another",
                ));
            }
            Err(TryLockError::Poisoned(_)) => return Err(PyRuntimeError::new_err(BUG)),
        };
        let tracker = &mut *tracker;
        let pose = run(py, || {
            let seen = Targets {
                positions: &positions,
                position_deviations: &position_deviations,
                orientations: &orientations,
                orientation_deviations: &orientation_deviations,
            };
            tracker.push(&poses, &seen, &Interrupt::new())
        })?;
        let joints = pose.rotations.len() / 4;
        Ok((
            array(py, &[joints, 4], &pose.rotations)?,
            array(py, &[3], &pose.translation)?,
            array(py, &[2], &pose.energies)?,
        ))
    }
}
