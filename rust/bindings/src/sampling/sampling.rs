//! Recognition of the source's clock.

use crate::array::{by_dtype, clip, input, run_interruptible};
use numpy::{Element, IntoPyArray, PyArray1};
use pyo3::prelude::*;
use quatfilt_core::Real;
use quatfilt_core::sampling::{self as core, Kind};

/// Estimated nanoseconds per rotation.
const NANOSECONDS: usize = 10;

type Found = (usize, Py<PyArray1<f64>>, Py<PyArray1<bool>>);

/// The kind of source, the times of its measurements `(n,)` in frames, and frozen frames `(frames,)`.
#[pyfunction]
#[pyo3(signature = (q, fps, /))]
pub(crate) fn sampling(py: Python<'_>, q: &Bound<'_, PyAny>, fps: f64) -> PyResult<Found> {
    by_dtype!(q, T => typed::<T>(py, q, fps))
}

fn typed<T: Real + Element>(py: Python<'_>, q: &Bound<'_, PyAny>, fps: f64) -> PyResult<Found> {
    let q = input::<T>("q", q)?;
    let q = clip("q", &q)?;
    let nanoseconds = q.frames() * q.joints() * NANOSECONDS;
    let found = run_interruptible(py, nanoseconds, |interrupt| core::sampling(q, fps, interrupt))?;
    let kind = match found.kind {
        Kind::Regular => 0,
        Kind::Held => 1,
        Kind::Repeated => 2,
        Kind::Interpolated => 3,
    };
    Ok((kind, found.times.into_pyarray(py).unbind(), found.frozen.into_pyarray(py).unbind()))
}
