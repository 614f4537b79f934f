//! Principal geodesic analysis of whole poses.

use super::pga::{array, objective_named};
use crate::array::{by_dtype, clip, elements, input, output, run_interruptible};
use numpy::{Element, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use quatfilt_core::Real;
use quatfilt_core::geodesics::body;
use quatfilt_core::geodesics::pga::Params;

/// Estimated nanoseconds per sample: of a fitted geodesic, of a parameter, and of a factor.
const FIT_NANOSECONDS: usize = 500;
const SCORE_NANOSECONDS: usize = 80;
const PRODUCT_NANOSECONDS: usize = 10;

/// Geodesics that are expected where their number is not given.
const EXPECTED: usize = 30;

/// Directions `(k, joints, 3)`, residuals `(k,)` and descents `(k, steps)`.
#[pyfunction]
#[pyo3(signature = (q, means, components, most, objective, tolerance, /))]
pub(crate) fn body_geodesics(
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

fn fitted<T: Real + Element>(
    py: Python<'_>,
    q: &Bound<'_, PyAny>,
    means: &Bound<'_, PyAny>,
    params: Params,
) -> PyResult<(Py<PyAny>, Py<PyAny>, Py<PyAny>)> {
    let (q, means) = (input::<T>("q", q)?, input::<T>("means", means)?);
    let (q, means) = (clip("q", &q)?, elements("means", &means)?);
    let geodesics = if params.components == 0 { EXPECTED } else { params.components };
    let nanoseconds = (q.data().len() / 4 * FIT_NANOSECONDS).saturating_mul(geodesics);
    let components =
        run_interruptible(py, nanoseconds, |interrupt| body::body_geodesics(q, means, params, interrupt))?;
    let k = components.len();
    let steps = components.iter().map(|component| component.descent.len()).max().unwrap_or(0);
    let descents = components.iter().flat_map(|component| {
        let left = steps - component.descent.len();
        component.descent.iter().copied().chain(std::iter::repeat_n(f64::NAN, left))
    });
    let directions = components.iter().flat_map(|component| component.direction.iter().copied());
    Ok((
        array::<T>(py, &[k, q.joints(), 3], directions)?,
        array::<T>(py, &[k], components.iter().map(|component| component.residual))?,
        array::<T>(py, &[k, steps], descents)?,
    ))
}

/// Parameters `(frames, k)`.
#[pyfunction]
#[pyo3(signature = (q, means, directions, /))]
pub(crate) fn body_scores(
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
    let out = output::<T>(py, &[q.frames(), k]);
    {
        let mut out = out.readwrite();
        let out = out.as_slice_mut()?;
        let (means, directions) = (elements("means", &means)?, elements("directions", &directions)?);
        run_interruptible(py, q.data().len() / 4 * k * SCORE_NANOSECONDS, |interrupt| {
            body::body_scores(q, means, directions, out, interrupt)
        })?;
    }
    Ok(out.into_any().unbind())
}

/// Poses `(frames, joints, 4)` of parameters `(frames, k)`.
#[pyfunction]
#[pyo3(signature = (scores, means, directions, /))]
pub(crate) fn body_product(
    py: Python<'_>,
    scores: &Bound<'_, PyAny>,
    means: &Bound<'_, PyAny>,
    directions: &Bound<'_, PyAny>,
) -> PyResult<Py<PyAny>> {
    by_dtype!(scores, T => poses::<T>(py, scores, means, directions))
}

fn poses<T: Real + Element>(
    py: Python<'_>,
    scores: &Bound<'_, PyAny>,
    means: &Bound<'_, PyAny>,
    directions: &Bound<'_, PyAny>,
) -> PyResult<Py<PyAny>> {
    let (scores, means) = (input::<T>("scores", scores)?, input::<T>("means", means)?);
    let directions = input::<T>("directions", directions)?;
    let (frames, joints) = (scores.shape()[0], means.shape()[0]);
    let out = output::<T>(py, &[frames, joints, 4]);
    {
        let mut out = out.readwrite();
        let out = out.as_slice_mut()?;
        let (scores, means) = (elements("scores", &scores)?, elements("means", &means)?);
        let directions = elements("directions", &directions)?;
        run_interruptible(py, (scores.len() + 1) * joints * PRODUCT_NANOSECONDS, |interrupt| {
            body::body_product(scores, means, directions, out, interrupt)
        })?;
    }
    Ok(out.into_any().unbind())
}
