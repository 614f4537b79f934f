//! Poses as feature vectors.

use crate::array::{by_dtype, clip, input, numbers, output, run};
use numpy::PyArrayMethods;
use pyo3::prelude::*;
use quatfilt_core::reconstruction::features;

/// Weighted rotation vectors relative to the means, `(frames, joints, 4)`, `(joints, 4)`, `(joints)` → `(frames,
/// 3·joints)`.
#[pyfunction]
#[pyo3(signature = (q, means, weights, /))]
pub(crate) fn pose_features(
    py: Python<'_>,
    q: &Bound<'_, PyAny>,
    means: &Bound<'_, PyAny>,
    weights: &Bound<'_, PyAny>,
) -> PyResult<Py<PyAny>> {
    let (means, weights) = (numbers("means", means)?, numbers("weights", weights)?);
    by_dtype!(q, T => {
        let q = input::<T>("q", q)?;
        let q = clip("q", &q)?;
        let out = output::<T>(py, &[q.frames(), 3 * q.joints()]);
        {
            let mut out = out.readwrite();
            let out = out.as_slice_mut()?;
            run(py, || features::pose_features(q, &means, &weights, out))?;
        }
        Ok(out.into_any().unbind())
    })
}
