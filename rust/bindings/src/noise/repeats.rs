//! Exact repeats.

use crate::array::{by_dtype, clip, input, output, run};
use numpy::PyArrayMethods;
use pyo3::prelude::*;
use quatfilt_core::noise::repeats;

/// Where samples `(frames, joints, 4)` equal the latest one of their joint before them: `(frames, joints)`.
#[pyfunction]
#[pyo3(signature = (q, /))]
pub(crate) fn find_repeats(py: Python<'_>, q: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
    by_dtype!(q, T => {
        let q = input::<T>("q", q)?;
        let q = clip("q", &q)?;
        let found = output::<bool>(py, &[q.frames(), q.joints()]);
        {
            let mut found = found.readwrite();
            let found = found.as_slice_mut()?;
            run(py, || repeats::find_repeats(q, found))?;
        }
        Ok(found.into_any().unbind())
    })
}
