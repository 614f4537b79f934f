//! Noise that looks like motion.

use crate::array::{by_dtype, clip, input, run_interruptible};
use numpy::{Element, IntoPyArray, PyArray1};
use pyo3::prelude::*;
use quatfilt_core::Real;
use quatfilt_core::sampling::tracker_noise as core;

/// Estimated nanoseconds per rotation.
const NANOSECONDS: usize = 150;

/// Gate, cut-off, acceleration, excess, shape and whiteness, `(6,)`.
#[pyfunction]
#[pyo3(signature = (q, fps, /))]
pub(crate) fn tracker_noise(py: Python<'_>, q: &Bound<'_, PyAny>, fps: f64) -> PyResult<Py<PyArray1<f64>>> {
    by_dtype!(q, T => typed::<T>(py, q, fps))
}

fn typed<T: Real + Element>(py: Python<'_>, q: &Bound<'_, PyAny>, fps: f64) -> PyResult<Py<PyArray1<f64>>> {
    let q = input::<T>("q", q)?;
    let q = clip("q", &q)?;
    let nanoseconds = q.frames() * q.joints() * NANOSECONDS;
    let found = run_interruptible(py, nanoseconds, |interrupt| core::tracker_noise(q, fps, interrupt))?;
    Ok(found.to_vec().into_pyarray(py).unbind())
}
