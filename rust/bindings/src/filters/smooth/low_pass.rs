//! A low pass by third differences.

use crate::filters::development::{Arguments, filtered};
use pyo3::prelude::*;
use quatfilt_core::filters::smooth::LowPass;

/// Filters rotations `(frames, joints, 4)` and, as the first joint, a translation `(frames, 3)`.
#[pyfunction]
#[pyo3(signature = (q, translation, confidence, reference_sigma, softness, /))]
pub(crate) fn low_pass(
    py: Python<'_>,
    q: &Bound<'_, PyAny>,
    translation: Option<&Bound<'_, PyAny>>,
    confidence: Option<&Bound<'_, PyAny>>,
    reference_sigma: &Bound<'_, PyAny>,
    softness: f64,
) -> PyResult<(Py<PyAny>, Option<Py<PyAny>>)> {
    filtered(py, &LowPass { softness }, Arguments { q, translation, confidence, reference_sigma })
}
