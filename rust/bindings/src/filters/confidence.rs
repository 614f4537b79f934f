//! Confidence for filters that have no weights of their own.

use crate::array::{by_dtype, clip, clip_mut, elements, input, output, run};
use numpy::{PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use quatfilt_core::filters::confidence;

/// Rotations `(frames, joints, 4)` whose samples gave way as far as they are not trusted, by `(frames, joints)`.
#[pyfunction]
#[pyo3(signature = (q, confidence, /))]
pub(crate) fn pulled_by_confidence(
    py: Python<'_>,
    q: &Bound<'_, PyAny>,
    confidence: &Bound<'_, PyAny>,
) -> PyResult<Py<PyAny>> {
    by_dtype!(q, T => {
        let (q, trust) = (input::<T>("q", q)?, input::<T>("confidence", confidence)?);
        let out = output::<T>(py, q.shape());
        {
            let q = clip("q", &q)?;
            let trust = elements("confidence", &trust)?;
            let mut out = out.readwrite();
            let out = clip_mut(&mut out, q.frames(), q.joints())?;
            run(py, || confidence::pulled_by_confidence(q, trust, out))?;
        }
        Ok(out.into_any().unbind())
    })
}
