//! The noise level of a clip, estimated from the clip.

use crate::array::{by_dtype, clip, input, output, run};
use numpy::PyArrayMethods;
use pyo3::prelude::*;
use quatfilt_core::noise::noise;

/// Deviation of the noise per component of the rotation vector, in radians, `(frames, joints, 4)` → `(joints)`.
#[pyfunction]
#[pyo3(signature = (q, /))]
pub(crate) fn noise_level(py: Python<'_>, q: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
    by_dtype!(q, T => {
        let q = input::<T>("q", q)?;
        let q = clip("q", &q)?;
        let out = output::<T>(py, &[q.joints()]);
        {
            let mut out = out.readwrite();
            let out = out.as_slice_mut()?;
            run(py, || noise::noise_level(q, out))?;
        }
        Ok(out.into_any().unbind())
    })
}
