//! The algebra of unit quaternions, on arrays of rows.

use crate::array::{by_dtype, clip, elements, input, output, run};
use numpy::{Element, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use quatfilt_core::rotations::quaternion;
use quatfilt_core::{Error, Real};

type Map<T> = fn(&[T], &mut [T]) -> Result<(), Error>;
type Zip<T> = fn(&[T], &[T], &mut [T]) -> Result<(), Error>;

/// Applies a kernel to rows; the result has rows of `columns`.
fn map<T: Real + Element>(
    py: Python<'_>,
    name: &str,
    a: &Bound<'_, PyAny>,
    columns: usize,
    f: Map<T>,
) -> PyResult<Py<PyAny>> {
    let a = input::<T>(name, a)?;
    let out = output::<T>(py, &[a.shape()[0], columns]);
    {
        let a = elements(name, &a)?;
        let mut out = out.readwrite();
        let out = out.as_slice_mut()?;
        run(py, || f(a, out))?;
    }
    Ok(out.into_any().unbind())
}

/// Applies a kernel to pairs of rows; the result has rows of `shape`.
fn zip<T: Real + Element>(
    py: Python<'_>,
    a: &Bound<'_, PyAny>,
    b: &Bound<'_, PyAny>,
    columns: Option<usize>,
    f: Zip<T>,
) -> PyResult<Py<PyAny>> {
    let a = input::<T>("a", a)?;
    let b = input::<T>("b", b)?;
    let shape: Vec<usize> = std::iter::once(a.shape()[0]).chain(columns).collect();
    let out = output::<T>(py, &shape);
    {
        let (a, b) = (elements("a", &a)?, elements("b", &b)?);
        let mut out = out.readwrite();
        let out = out.as_slice_mut()?;
        run(py, || f(a, b, out))?;
    }
    Ok(out.into_any().unbind())
}

/// Quaternion logarithm, `(n, 4)` → `(n, 3)`.
#[pyfunction]
#[pyo3(signature = (q, /))]
pub(crate) fn log(py: Python<'_>, q: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
    by_dtype!(q, T => map::<T>(py, "q", q, 3, quaternion::log))
}

/// Quaternion exponential, `(n, 3)` → `(n, 4)`.
#[pyfunction]
#[pyo3(signature = (v, /))]
pub(crate) fn exp(py: Python<'_>, v: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
    by_dtype!(v, T => map::<T>(py, "v", v, 4, quaternion::exp))
}

/// Conjugate, `(n, 4)` → `(n, 4)`.
#[pyfunction]
#[pyo3(signature = (q, /))]
pub(crate) fn conjugate(py: Python<'_>, q: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
    by_dtype!(q, T => map::<T>(py, "q", q, 4, quaternion::conjugate))
}

/// Scaling to length 1, `(n, 4)` → `(n, 4)`.
#[pyfunction]
#[pyo3(signature = (q, /))]
pub(crate) fn normalize(py: Python<'_>, q: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
    by_dtype!(q, T => map::<T>(py, "q", q, 4, quaternion::normalize))
}

/// Hamilton product, `(n, 4)`, `(n, 4)` → `(n, 4)`.
#[pyfunction]
#[pyo3(signature = (a, b, /))]
pub(crate) fn multiply(py: Python<'_>, a: &Bound<'_, PyAny>, b: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
    by_dtype!(a, T => zip::<T>(py, a, b, Some(4), quaternion::multiply))
}

/// Rotation angle between rotations, `(n, 4)`, `(n, 4)` → `(n)`.
#[pyfunction]
#[pyo3(signature = (a, b, /))]
pub(crate) fn geodesic_distance(
    py: Python<'_>,
    a: &Bound<'_, PyAny>,
    b: &Bound<'_, PyAny>,
) -> PyResult<Py<PyAny>> {
    by_dtype!(a, T => zip::<T>(py, a, b, None, quaternion::geodesic_distance))
}

/// Number of missing samples, largest deviation from unit length, and its index: `(frames, joints, 4)` → three
/// numbers.
#[pyfunction]
#[pyo3(signature = (q, /))]
pub(crate) fn scan(py: Python<'_>, q: &Bound<'_, PyAny>) -> PyResult<(usize, f64, usize)> {
    by_dtype!(q, T => {
        let q = input::<T>("q", q)?;
        let q = clip("q", &q)?;
        let found = run(py, || quaternion::scan(q))?;
        Ok((found.missing, found.worst, found.index))
    })
}
