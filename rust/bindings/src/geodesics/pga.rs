//! Principal geodesic analysis.

use crate::array::{by_dtype, clip, elements, input, output, run_interruptible};
use crate::filters::names::named;
use numpy::{Element, PyArray1, PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use quatfilt_core::Real;
use quatfilt_core::geodesics::pga::{self, Component, Geodesics, Objective, Params};

/// Estimated nanoseconds per sample: of the centre, of a fitted geodesic, and of a parameter.
const CENTRE_NANOSECONDS: usize = 40;
const FIT_NANOSECONDS: usize = 300;
const SCORE_NANOSECONDS: usize = 20;

/// Geodesics that are expected where their number is not given.
const EXPECTED: usize = 8;

/// Means `(joints, 4)`, radii `(joints,)`, and whether there is no other mean `(joints,)`.
#[pyfunction]
#[pyo3(signature = (q, /))]
pub(crate) fn geodesic_centre(
    py: Python<'_>,
    q: &Bound<'_, PyAny>,
) -> PyResult<(Py<PyAny>, Py<PyAny>, Py<PyAny>)> {
    let centres = by_dtype!(q, T => {
        let q = input::<T>("q", q)?;
        let q = clip("q", &q)?;
        run_interruptible(py, q.data().len() / 4 * CENTRE_NANOSECONDS, |interrupt| {
            pga::geodesic_centre(q, interrupt)
        })?
    });
    let means: Vec<f64> = centres.iter().flat_map(|centre| centre.mean).collect();
    let means = PyArray1::from_vec(py, means).reshape([centres.len(), 4])?;
    let radii = PyArray1::from_iter(py, centres.iter().map(|centre| centre.radius));
    let unique = PyArray1::from_iter(py, centres.iter().map(|centre| centre.unique));
    Ok((means.into_any().unbind(), radii.into_any().unbind(), unique.into_any().unbind()))
}

/// Directions `(k, joints, 3)`, residuals `(k, joints)` and descents `(k, joints, steps)`.
#[pyfunction]
#[pyo3(signature = (q, means, components, most, objective, tolerance, /))]
pub(crate) fn principal_geodesics(
    py: Python<'_>,
    q: &Bound<'_, PyAny>,
    means: &Bound<'_, PyAny>,
    components: usize,
    most: usize,
    objective: &str,
    tolerance: f64,
) -> PyResult<(Py<PyAny>, Py<PyAny>, Py<PyAny>)> {
    let params = Params { components, most, objective: objective_named(objective)?, tolerance };
    by_dtype!(q, T => fitted::<T>(py, q, means, params))
}

/// The objective of a name.
pub(super) fn objective_named(name: &str) -> PyResult<Objective> {
    named(
        "objective",
        name,
        &[
            ("geodesic", Objective::Geodesic),
            ("squared", Objective::Squared),
            ("chordal", Objective::Chordal),
        ],
    )
}

fn fitted<T: Real + Element>(
    py: Python<'_>,
    q: &Bound<'_, PyAny>,
    means: &Bound<'_, PyAny>,
    params: Params,
) -> PyResult<(Py<PyAny>, Py<PyAny>, Py<PyAny>)> {
    let (q, means) = (input::<T>("q", q)?, input::<T>("means", means)?);
    let joints = q.shape().get(1).copied().unwrap_or(0);
    let components = {
        let (q, means) = (clip("q", &q)?, elements("means", &means)?);
        let geodesics = if params.components == 0 { EXPECTED } else { params.components };
        let nanoseconds = (q.data().len() / 4 * FIT_NANOSECONDS).saturating_mul(geodesics);
        run_interruptible(py, nanoseconds, |interrupt| pga::principal_geodesics(q, means, params, interrupt))?
    };
    let k = components.len();
    let all = || components.iter().flatten();
    let steps = all().map(|component| component.descent.len()).max().unwrap_or(0);
    let steps_of = |component: &Component| {
        let left = steps - component.descent.len();
        component.descent.clone().into_iter().chain(std::iter::repeat_n(f64::NAN, left)).collect::<Vec<_>>()
    };
    let directions = array::<T>(py, &[k, joints, 3], all().flat_map(|component| component.direction))?;
    let residuals = array::<T>(py, &[k, joints], all().map(|component| component.residual))?;
    let descents = array::<T>(py, &[k, joints, steps], all().flat_map(steps_of))?;
    Ok((directions, residuals, descents))
}

/// An array of numbers, rounded to its dtype.
pub(super) fn array<T: Real + Element>(
    py: Python<'_>,
    shape: &[usize],
    numbers: impl Iterator<Item = f64>,
) -> PyResult<Py<PyAny>> {
    let out: Bound<'_, PyArrayDyn<T>> = output(py, shape);
    for (out, number) in out.readwrite().as_slice_mut()?.iter_mut().zip(numbers) {
        *out = T::from_f64(number);
    }
    Ok(out.into_any().unbind())
}

/// Parameters `(frames, joints, k)`.
#[pyfunction]
#[pyo3(signature = (q, means, directions, /))]
pub(crate) fn geodesic_scores(
    py: Python<'_>,
    q: &Bound<'_, PyAny>,
    means: &Bound<'_, PyAny>,
    directions: &Bound<'_, PyAny>,
) -> PyResult<Py<PyAny>> {
    by_dtype!(q, T => scores::<T>(py, q, means, directions))
}

fn scores<T: Real + Element>(
    py: Python<'_>,
    q: &Bound<'_, PyAny>,
    means: &Bound<'_, PyAny>,
    directions: &Bound<'_, PyAny>,
) -> PyResult<Py<PyAny>> {
    let (q, means) = (input::<T>("q", q)?, input::<T>("means", means)?);
    let directions = input::<T>("directions", directions)?;
    let k = directions.shape().first().copied().unwrap_or(0);
    let q = clip("q", &q)?;
    let out = output::<T>(py, &[q.frames(), q.joints(), k]);
    {
        let mut out = out.readwrite();
        let out = out.as_slice_mut()?;
        let geodesics =
            Geodesics { means: elements("means", &means)?, directions: elements("directions", &directions)? };
        run_interruptible(py, out.len() * SCORE_NANOSECONDS, |interrupt| {
            pga::geodesic_scores(q, geodesics, out, interrupt)
        })?;
    }
    Ok(out.into_any().unbind())
}

/// Rotations `(frames, joints, 4)` of parameters `(frames, joints, k)`.
#[pyfunction]
#[pyo3(signature = (scores, means, directions, /))]
pub(crate) fn geodesic_product(
    py: Python<'_>,
    scores: &Bound<'_, PyAny>,
    means: &Bound<'_, PyAny>,
    directions: &Bound<'_, PyAny>,
) -> PyResult<Py<PyAny>> {
    by_dtype!(scores, T => rotations::<T>(py, scores, means, directions))
}

fn rotations<T: Real + Element>(
    py: Python<'_>,
    scores: &Bound<'_, PyAny>,
    means: &Bound<'_, PyAny>,
    directions: &Bound<'_, PyAny>,
) -> PyResult<Py<PyAny>> {
    let (scores, means) = (input::<T>("scores", scores)?, input::<T>("means", means)?);
    let directions = input::<T>("directions", directions)?;
    let &[frames, joints, _] = scores.shape() else {
        return Err(PyValueError::new_err(format!(
            "scores: expected shape (frames, joints, k), got {:?}",
            scores.shape()
        )));
    };
    let out = output::<T>(py, &[frames, joints, 4]);
    {
        let mut out = out.readwrite();
        let out = out.as_slice_mut()?;
        let scores = elements("scores", &scores)?;
        let geodesics =
            Geodesics { means: elements("means", &means)?, directions: elements("directions", &directions)? };
        run_interruptible(py, (scores.len() + out.len()) * SCORE_NANOSECONDS, |interrupt| {
            pga::geodesic_product(scores, joints, geodesics, out, interrupt)
        })?;
    }
    Ok(out.into_any().unbind())
}
