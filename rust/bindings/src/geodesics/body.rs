//! Principal geodesic analysis of whole poses.

use super::shared::{array, descents, params, product, scores};
use crate::array::{by_dtype, clip, elements, input, run_interruptible};
use numpy::Element;
use pyo3::prelude::*;
use quatfilt_core::Real;
use quatfilt_core::geodesics::body;
use quatfilt_core::geodesics::pga::Params;

/// Estimated nanoseconds per sample: of a fitted geodesic, of a parameter, and of a factor.
const FIT_NANOSECONDS: usize = 500;
const SCORE_NANOSECONDS: usize = 80;
const PRODUCT_NANOSECONDS: usize = 10;

/// Expected number of geodesics if it is not given.
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
    let components =
        run_interruptible(py, nanoseconds, |interrupt| body::body_geodesics(q, means, params, interrupt))?;
    let (k, all) = (components.len(), || components.iter());
    Ok((
        array::<T>(py, &[k, q.joints(), 3], all().flat_map(|component| component.direction.iter().copied()))?,
        array::<T>(py, &[k], all().map(|component| component.residual))?,
        descents::<T>(py, &[k], all().map(|component| &component.descent[..]))?,
    ))
}

/// Parameters `(frames, k)` of poses.
#[pyfunction]
#[pyo3(signature = (q, means, directions, /))]
pub(crate) fn body_scores(
    py: Python<'_>,
    q: &Bound<'_, PyAny>,
    means: &Bound<'_, PyAny>,
    directions: &Bound<'_, PyAny>,
) -> PyResult<Py<PyAny>> {
    let shape = |frames, _joints, k| vec![frames, k];
    by_dtype!(q, T => {
        let arrays = (q, means, directions);
        scores::<T>(py, arrays, shape, SCORE_NANOSECONDS, |q, [means, directions], out, interrupt| {
            body::body_scores(q, means, directions, out, interrupt)
        })
    })
}

/// Poses `(frames, joints, 4)` from parameters `(frames, k)`.
#[pyfunction]
#[pyo3(signature = (scores, means, directions, /))]
pub(crate) fn body_product(
    py: Python<'_>,
    scores: &Bound<'_, PyAny>,
    means: &Bound<'_, PyAny>,
    directions: &Bound<'_, PyAny>,
) -> PyResult<Py<PyAny>> {
    by_dtype!(scores, T => {
        let arrays = (scores, means, directions);
        product::<T>(py, arrays, PRODUCT_NANOSECONDS, |scores, [means, directions], out, interrupt| {
            body::body_product(scores, means, directions, out, interrupt)
        })
    })
}
