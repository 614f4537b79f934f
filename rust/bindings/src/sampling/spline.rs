//! Values at the source's measurements, and back to all frames.

use crate::array::{by_dtype, elements, input, output, run, run_interruptible};
use numpy::{PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use quatfilt_core::Real;
use quatfilt_core::sampling::spline::{self as core, Series};

/// Estimated nanoseconds per rotation.
const NANOSECONDS: usize = 300;

/// Rotations `(n, joints, 4)`, or positions `(n, points, 3)`, at times `(n,)` in frames.
#[pyfunction]
#[pyo3(signature = (q, times, /))]
pub(crate) fn knots(py: Python<'_>, q: &Bound<'_, PyAny>, times: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
    let times = input::<f64>("times", times)?;
    let times = elements("times", &times)?;
    by_dtype!(q, T => {
        let q = input::<T>("q", q)?;
        let q = series::<T>(&q)?;
        let out = output::<T>(py, &[times.len(), q.joints, q.width]);
        {
            let mut out = out.readwrite();
            let out = out.as_slice_mut()?;
            run(py, || core::knots(q, times, out))?;
        }
        Ok(out.into_any().unbind())
    })
}

/// Rotations `(m, joints, 4)`, or positions `(m, points, 3)`, at new times `(m,)` along a spline.
#[pyfunction]
#[pyo3(signature = (q, times, new_times, cutoff, /))]
pub(crate) fn spline(
    py: Python<'_>,
    q: &Bound<'_, PyAny>,
    times: &Bound<'_, PyAny>,
    new_times: &Bound<'_, PyAny>,
    cutoff: f64,
) -> PyResult<Py<PyAny>> {
    let (times, new_times) = (input::<f64>("times", times)?, input::<f64>("new_times", new_times)?);
    let (times, new_times) = (elements("times", &times)?, elements("new_times", &new_times)?);
    by_dtype!(q, T => {
        let q = input::<T>("q", q)?;
        let q = series::<T>(&q)?;
        let out = output::<T>(py, &[new_times.len(), q.joints, q.width]);
        {
            let mut out = out.readwrite();
            let out = out.as_slice_mut()?;
            let nanoseconds = (times.len() + new_times.len()) * q.joints * NANOSECONDS;
            run_interruptible(py, nanoseconds, |interrupt| {
                core::spline(q, times, new_times, cutoff, out, interrupt)
            })?;
        }
        Ok(out.into_any().unbind())
    })
}

fn series<'a, T: Real + numpy::Element>(array: &'a PyReadonlyArrayDyn<'_, T>) -> PyResult<Series<'a, T>> {
    let &[_, joints, width @ (3 | 4)] = array.shape() else {
        return Err(PyValueError::new_err(format!(
            "q: expected shape (frames, joints, 4) or (frames, points, 3), got {:?}",
            array.shape()
        )));
    };
    Ok(Series { values: elements("q", array)?, joints, width })
}
