//! Euler angles.

use crate::array::{elements, input, output, run};
use numpy::{PyArrayMethods, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use quatfilt_core::rotations::euler::{self, Axes};

fn named(axes: &str) -> PyResult<Axes> {
    Axes::named(axes).map_err(|error| PyValueError::new_err(error.to_string()))
}

/// Unit quaternions of Euler angles in radians, float64 `(n, 3)` → `(n, 4)`.
#[pyfunction]
#[pyo3(signature = (angles, axes, /))]
pub(crate) fn from_euler(py: Python<'_>, angles: &Bound<'_, PyAny>, axes: &str) -> PyResult<Py<PyAny>> {
    let axes = named(axes)?;
    let angles = input::<f64>("angles", angles)?;
    let out = output::<f64>(py, &[angles.shape()[0], 4]);
    {
        let angles = elements("angles", &angles)?;
        let mut out = out.readwrite();
        let out = out.as_slice_mut()?;
        run(py, || euler::from_euler(angles, axes, out))?;
    }
    Ok(out.into_any().unbind())
}

/// Euler angles of quaternions in radians, float64 `(n, 4)` → `(n, 3)`.
#[pyfunction]
#[pyo3(signature = (q, axes, /))]
pub(crate) fn to_euler(py: Python<'_>, q: &Bound<'_, PyAny>, axes: &str) -> PyResult<Py<PyAny>> {
    let axes = named(axes)?;
    let q = input::<f64>("q", q)?;
    let out = output::<f64>(py, &[q.shape()[0], 3]);
    {
        let q = elements("q", &q)?;
        let mut out = out.readwrite();
        let out = out.as_slice_mut()?;
        run(py, || euler::to_euler(q, axes, out))?;
    }
    Ok(out.into_any().unbind())
}

/// Euler angles made continuous along time, float64 `(frames, joints, 3)`, starting near `(joints, 3)`.
#[pyfunction]
#[pyo3(signature = (angles, start, axes, /))]
pub(crate) fn continuous_euler(
    py: Python<'_>,
    angles: &Bound<'_, PyAny>,
    start: &Bound<'_, PyAny>,
    axes: &str,
) -> PyResult<Py<PyAny>> {
    let axes = named(axes)?;
    let angles = input::<f64>("angles", angles)?;
    let start = input::<f64>("start", start)?;
    let out = output::<f64>(py, angles.shape());
    {
        let (angles, start) = (elements("angles", &angles)?, elements("start", &start)?);
        let mut out = out.readwrite();
        let out = out.as_slice_mut()?;
        run(py, || euler::continuous_euler(angles, start, axes, out))?;
    }
    Ok(out.into_any().unbind())
}
