//! The heading of a body.

use crate::array::{by_dtype, elements, input, output, run};
use numpy::{PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use quatfilt_core::reconstruction::heading;

/// Headings about the axis `up` and the remaining rotations, `(frames, 4)` → `(frames)`, `(frames, 4)`.
#[pyfunction]
#[pyo3(signature = (roots, up, /))]
pub(crate) fn split_heading(
    py: Python<'_>,
    roots: &Bound<'_, PyAny>,
    up: usize,
) -> PyResult<(Py<PyAny>, Py<PyAny>)> {
    by_dtype!(roots, T => {
        let roots = input::<T>("roots", roots)?;
        let angles = output::<T>(py, &roots.shape()[..1]);
        let rest = output::<T>(py, roots.shape());
        {
            let roots = elements("roots", &roots)?;
            let (mut angles, mut rest) = (angles.readwrite(), rest.readwrite());
            let (angles, rest) = (angles.as_slice_mut()?, rest.as_slice_mut()?);
            run(py, || heading::split_heading(roots, up, angles, rest))?;
        }
        Ok((angles.into_any().unbind(), rest.into_any().unbind()))
    })
}
