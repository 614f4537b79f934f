//! Blender's weighted moving mean.

use super::development::{Arguments, filtered};
use pyo3::prelude::*;
use quatfilt_core::filters::weighted_moving_mean::WeightedMovingMean;

/// Filters rotations `(frames, joints, 4)` and a translation `(frames, 3)`.
#[pyfunction]
#[pyo3(signature = (q, translation, confidence, reference_sigma, iterations, /))]
pub(crate) fn weighted_moving_mean(
    py: Python<'_>,
    q: &Bound<'_, PyAny>,
    translation: Option<&Bound<'_, PyAny>>,
    confidence: Option<&Bound<'_, PyAny>>,
    reference_sigma: &Bound<'_, PyAny>,
    iterations: usize,
) -> PyResult<(Py<PyAny>, Option<Py<PyAny>>)> {
    let filter = WeightedMovingMean { iterations };
    filtered(py, &filter, Arguments { q, translation, confidence, reference_sigma })
}
