//! The noise level of a clip, estimated from the clip.

use crate::array::{by_dtype, clip, elements, input, output, run};
use numpy::{PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use quatfilt_core::noise::noise;

/// Deviation of the noise per component of the rotation vector, in radians, `(frames, joints, 4)` → `(joints)`; of
/// positions `(frames, points, 3)`, in their unit.
#[pyfunction]
#[pyo3(signature = (q, /))]
pub(crate) fn noise_level(py: Python<'_>, q: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
    by_dtype!(q, T => {
        let q = input::<T>("q", q)?;
        let joints = q.shape().get(1).copied().unwrap_or_default();
        let out = output::<T>(py, &[joints]);
        {
            let mut out = out.readwrite();
            let out = out.as_slice_mut()?;
            if q.shape().last() == Some(&3) {
                let positions = elements("q", &q)?;
                run(py, || noise::noise_level_of_positions(positions, joints, out))?;
            } else {
                let q = clip("q", &q)?;
                run(py, || noise::noise_level(q, out))?;
            }
        }
        Ok(out.into_any().unbind())
    })
}
