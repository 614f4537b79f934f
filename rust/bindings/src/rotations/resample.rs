//! Interpolation of rotations in time.

use crate::array::{by_dtype, clip, clip_mut, elements, input, output, run};
use numpy::PyArrayMethods;
use pyo3::prelude::*;
use quatfilt_core::rotations::resample;

/// Rotations at new times, `(frames, joints, 4)`, `(frames)`, `(n)` → `(n, joints, 4)`.
#[pyfunction]
#[pyo3(signature = (q, times, new_times, /))]
pub(crate) fn slerp(
    py: Python<'_>,
    q: &Bound<'_, PyAny>,
    times: &Bound<'_, PyAny>,
    new_times: &Bound<'_, PyAny>,
) -> PyResult<Py<PyAny>> {
    let (times, new_times) = (input::<f64>("times", times)?, input::<f64>("new_times", new_times)?);
    let (times, new_times) = (elements("times", &times)?, elements("new_times", &new_times)?);
    by_dtype!(q, T => {
        let q = input::<T>("q", q)?;
        let q = clip("q", &q)?;
        let out = output::<T>(py, &[new_times.len(), q.joints(), 4]);
        {
            let mut out = out.readwrite();
            let out = clip_mut(&mut out, new_times.len(), q.joints())?;
            run(py, || resample::slerp(q, times, new_times, out))?;
        }
        Ok(out.into_any().unbind())
    })
}
