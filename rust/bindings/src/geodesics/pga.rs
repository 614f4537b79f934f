//! Principal geodesic analysis.

use super::shared::{array, descents, params, product, scores};
use crate::array::{by_dtype, clip, elements, input, run_interruptible};
use numpy::{Element, PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use quatfilt_core::Real;
use quatfilt_core::geodesics::pga::{self, Geodesics, Params};

/// Estimated nanoseconds per sample: of the centre, of a fitted geodesic, and of a parameter.
const CENTRE_NANOSECONDS: usize = 40;
const FIT_NANOSECONDS: usize = 300;
const SCORE_NANOSECONDS: usize = 20;

/// Expected number of geodesics if it is not given.
const EXPECTED: usize = 8;

/// Means `(joints, 4)`, radii `(joints,)`, and whether the means are unique `(joints,)`.
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
    let params = params(components, most, objective, tolerance)?;
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
    let components = run_interruptible(py, nanoseconds, |interrupt| {
        pga::principal_geodesics(q, means, params, interrupt)
    })?;
    let (k, joints) = (components.len(), q.joints());
    let all = || components.iter().flatten();
    Ok((
        array::<T>(py, &[k, joints, 3], all().flat_map(|component| component.direction))?,
        array::<T>(py, &[k, joints], all().map(|component| component.residual))?,
        descents::<T>(py, &[k, joints], all().map(|component| &component.descent[..]))?,
    ))
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
    let shape = |frames, joints, k| vec![frames, joints, k];
    by_dtype!(q, T => {
        let arrays = (q, means, directions);
        scores::<T>(py, arrays, shape, SCORE_NANOSECONDS, |q, [means, directions], out, interrupt| {
            pga::geodesic_scores(q, Geodesics { means, directions }, out, interrupt)
        })
    })
}

/// Rotations `(frames, joints, 4)` from parameters `(frames, joints, k)`.
#[pyfunction]
#[pyo3(signature = (scores, means, directions, /))]
pub(crate) fn geodesic_product(
    py: Python<'_>,
    scores: &Bound<'_, PyAny>,
    means: &Bound<'_, PyAny>,
    directions: &Bound<'_, PyAny>,
) -> PyResult<Py<PyAny>> {
    by_dtype!(scores, T => {
        let arrays = (scores, means, directions);
        product::<T>(py, arrays, SCORE_NANOSECONDS, |scores, [means, directions], out, interrupt| {
            pga::geodesic_product(scores, means.len() / 4, Geodesics { means, directions }, out, interrupt)
        })
    })
}
