//! Sign continuity.

use crate::array::{by_dtype, clip, clip_mut, input, output, run};
use numpy::{PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use quatfilt_core::rotations::continuity;

/// Signs flipped along time so that a path has no jumps between `q` and `−q`, `(frames, joints, 4)`.
#[pyfunction]
#[pyo3(signature = (q, /))]
pub(crate) fn continuous(py: Python<'_>, q: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
    by_dtype!(q, T => {
        let q = input::<T>("q", q)?;
        let out = output::<T>(py, q.shape());
        {
            let q = clip("q", &q)?;
            let mut out = out.readwrite();
            let out = clip_mut(&mut out, q.frames(), q.joints())?;
            run(py, || continuity::continuous(q, out))?;
        }
        Ok(out.into_any().unbind())
    })
}
