//! The Kalman filter of constant velocity, its smoother, and their automatic process noise.

use crate::array::{by_dtype, clip, clip_mut, elements, input, numbers, output, run_interruptible};
use numpy::{Element, PyArray1, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use quatfilt_core::Real;
use quatfilt_core::filters::kalman::{self, Kalman};

/// Estimated nanoseconds per sample and frame of lookahead.
const NANOSECONDS: usize = 60;

/// Estimated nanoseconds per sample for all the candidates.
const CANDIDATES_NANOSECONDS: usize = 1500;

/// Filtered rotations `(frames, joints, 4)`.
#[pyfunction]
#[pyo3(name = "kalman", signature = (q, confidence, process_noise, measurement_noise, lookahead, /))]
pub(crate) fn filter(
    py: Python<'_>,
    q: &Bound<'_, PyAny>,
    confidence: Option<&Bound<'_, PyAny>>,
    process_noise: &Bound<'_, PyAny>,
    measurement_noise: &Bound<'_, PyAny>,
    lookahead: isize,
) -> PyResult<Py<PyAny>> {
    let filter = parameters(process_noise, measurement_noise, lookahead)?;
    by_dtype!(q, T => filtered::<T>(py, &filter, q, confidence))
}

/// The filter with these arguments.
pub(super) fn parameters(
    process_noise: &Bound<'_, PyAny>,
    measurement_noise: &Bound<'_, PyAny>,
    lookahead: isize,
) -> PyResult<Kalman> {
    Ok(Kalman {
        process_noise: numbers("process_noise", process_noise)?,
        measurement_noise: numbers("measurement_noise", measurement_noise)?,
        lookahead: usize::try_from(lookahead).ok(),
    })
}

fn filtered<T: Real + Element>(
    py: Python<'_>,
    filter: &Kalman,
    q: &Bound<'_, PyAny>,
    confidence: Option<&Bound<'_, PyAny>>,
) -> PyResult<Py<PyAny>> {
    let q = input::<T>("q", q)?;
    let confidence = confidence.map(|array| input::<T>("confidence", array)).transpose()?;
    let out = output::<T>(py, q.shape());
    {
        let q = clip("q", &q)?;
        let confidence = confidence.as_ref().map(|array| elements("confidence", array)).transpose()?;
        let mut out = out.readwrite();
        let out = clip_mut(&mut out, q.frames(), q.joints())?;
        let reach = filter.lookahead.map_or(0, |reach| reach.min(q.frames().saturating_sub(reach)));
        let nanoseconds = (q.data().len() / 4 * NANOSECONDS).saturating_mul(1 + reach);
        run_interruptible(py, nanoseconds, |interrupt| filter.filter(q, confidence, out, interrupt))?;
    }
    Ok(out.into_any().unbind())
}

/// The process noise chosen for a clip, `(joints,)`.
#[pyfunction]
#[pyo3(signature = (q, confidence, measurement_noise, block, lookahead, /))]
pub(crate) fn kalman_process_noise(
    py: Python<'_>,
    q: &Bound<'_, PyAny>,
    confidence: Option<&Bound<'_, PyAny>>,
    measurement_noise: &Bound<'_, PyAny>,
    block: usize,
    lookahead: isize,
) -> PyResult<Py<PyAny>> {
    let noise = numbers("measurement_noise", measurement_noise)?;
    let lookahead = usize::try_from(lookahead).ok();
    let result = by_dtype!(q, T => {
        let q = input::<T>("q", q)?;
        let confidence = confidence.map(|array| input::<T>("confidence", array)).transpose()?;
        let q = clip("q", &q)?;
        let confidence = confidence.as_ref().map(|array| elements("confidence", array)).transpose()?;
        run_interruptible(py, q.data().len() / 4 * CANDIDATES_NANOSECONDS, |interrupt| {
            kalman::process_noise(q, confidence, &noise, block, lookahead, interrupt)
        })?
    });
    Ok(PyArray1::from_vec(py, result).into_any().unbind())
}

/// Filtered columns of scalars, `(frames, columns)`.
#[pyfunction]
#[pyo3(signature = (x, ratio, lookahead, /))]
pub(crate) fn kalman_vectors(
    py: Python<'_>,
    x: &Bound<'_, PyAny>,
    ratio: &Bound<'_, PyAny>,
    lookahead: isize,
) -> PyResult<Py<PyAny>> {
    let ratios = numbers("ratio", ratio)?;
    let lookahead = usize::try_from(lookahead).ok();
    by_dtype!(x, T => {
        let x = input::<T>("x", x)?;
        let out = output::<T>(py, x.shape());
        {
            let values = elements("x", &x)?;
            let mut out = out.readwrite();
            let out = out.as_slice_mut()?;
            let nanoseconds = (values.len() * NANOSECONDS).saturating_mul(1 + lookahead.unwrap_or(0));
            run_interruptible(py, nanoseconds, |interrupt| {
                kalman::filter_vectors(values, &ratios, lookahead, out, interrupt)
            })?;
        }
        Ok(out.into_any().unbind())
    })
}

/// The ratio of process to measurement variance chosen for each column, `(columns,)`.
#[pyfunction]
#[pyo3(signature = (x, block, lookahead, /))]
pub(crate) fn kalman_vectors_ratio(
    py: Python<'_>,
    x: &Bound<'_, PyAny>,
    block: usize,
    lookahead: isize,
) -> PyResult<Py<PyAny>> {
    let lookahead = usize::try_from(lookahead).ok();
    let result = by_dtype!(x, T => {
        let x = input::<T>("x", x)?;
        let columns = x.shape().last().copied().unwrap_or(0);
        let values = elements("x", &x)?;
        run_interruptible(py, values.len() * CANDIDATES_NANOSECONDS, |interrupt| {
            kalman::vectors_ratio(values, columns, block, lookahead, interrupt)
        })?
    });
    Ok(PyArray1::from_vec(py, result).into_any().unbind())
}
