//! The most probable pose given control points and a prior.

use crate::array::{elements, input, numbers, output, run};
use numpy::{PyArrayDyn, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use quatfilt_core::reconstruction::kinematics::{Base, Body};
use quatfilt_core::reconstruction::solver::{Prior, Solver, Targets};

type Solved = (Py<PyAny>, Py<PyAny>, Py<PyAny>, f64, f64, usize);

/// Coordinates, rotations, translation, the two parts of the energy and the number of steps of the most probable pose.
#[pyfunction]
#[pyo3(signature = (
    parents, offsets, points, up, centres, place, heading, mean, deviation, axes, positions, position_deviations,
    orientations, orientation_deviations, start, most, /
))]
#[allow(clippy::too_many_arguments, reason = "the reference's")]
pub(crate) fn solve_pose(
    py: Python<'_>,
    parents: &Bound<'_, PyAny>,
    offsets: &Bound<'_, PyAny>,
    points: &Bound<'_, PyAny>,
    up: usize,
    centres: &Bound<'_, PyAny>,
    place: [f64; 3],
    heading: f64,
    mean: &Bound<'_, PyAny>,
    deviation: &Bound<'_, PyAny>,
    axes: &Bound<'_, PyAny>,
    positions: &Bound<'_, PyAny>,
    position_deviations: &Bound<'_, PyAny>,
    orientations: &Bound<'_, PyAny>,
    orientation_deviations: &Bound<'_, PyAny>,
    start: &Bound<'_, PyAny>,
    most: usize,
) -> PyResult<Solved> {
    let body = body(parents, offsets, points, up)?;
    let base = Base { centres: numbers("centres", centres)?, place, heading };
    let (mean, deviation) = (numbers("mean", mean)?, numbers("deviation", deviation)?);
    let axes = numbers("axes", axes)?;
    let positions = numbers("positions", positions)?;
    let position_deviations = numbers("position_deviations", position_deviations)?;
    let orientations = numbers("orientations", orientations)?;
    let orientation_deviations = numbers("orientation_deviations", orientation_deviations)?;
    let mut x = numbers("start", start)?;
    let mut rotations = vec![0.0; body.joints() * 4];
    let (translation, solution) = run(py, || {
        let mut solver = Solver::new(body);
        let prior = Prior { mean: &mean, deviation: &deviation, axes: &axes };
        let targets = Targets {
            positions: &positions,
            position_deviations: &position_deviations,
            orientations: &orientations,
            orientation_deviations: &orientation_deviations,
        };
        let solution = solver.solve(&base, &prior, &targets, &mut x, most)?;
        Ok((base.pose(&x, solver.body().up, &mut rotations), solution))
    })?;
    let joints = rotations.len() / 4;
    Ok((
        array(py, &[x.len()], &x)?,
        array(py, &[joints, 4], &rotations)?,
        array(py, &[3], &translation)?,
        solution.likelihood,
        solution.prior,
        solution.steps,
    ))
}

/// The skeleton with its control points, from arrays of int64 and float64.
pub(super) fn body(
    parents: &Bound<'_, PyAny>,
    offsets: &Bound<'_, PyAny>,
    points: &Bound<'_, PyAny>,
    up: usize,
) -> PyResult<Body> {
    let parents = input::<i64>("parents", parents)?;
    let parents: Vec<Option<usize>> =
        elements("parents", &parents)?.iter().map(|&parent| usize::try_from(parent).ok()).collect();
    let points = input::<i64>("points", points)?;
    let points: Result<Vec<usize>, _> =
        elements("points", &points)?.iter().copied().map(usize::try_from).collect();
    let points = points.map_err(|_| PyValueError::new_err("points: expected joints"))?;
    Body::new(&parents, &numbers("offsets", offsets)?, &points, up).map_err(crate::array::to_python)
}

/// A fresh array with these values.
pub(super) fn array(py: Python<'_>, shape: &[usize], values: &[f64]) -> PyResult<Py<PyAny>> {
    let out: Bound<'_, PyArrayDyn<f64>> = output(py, shape);
    out.readwrite().as_slice_mut()?.copy_from_slice(values);
    Ok(out.into_any().unbind())
}
