//! The Gaussian filter.

use super::development::{Arguments, filtered};
use super::names;
use crate::array::{elements, input};
use pyo3::prelude::*;
use quatfilt_core::filters::gaussian::Gaussian;

/// Filters rotations `(frames, joints, 4)` and, like the first joint, a translation `(frames, 3)`.
#[pyfunction]
#[pyo3(signature = (q, translation, confidence, reference_sigma, sigma, boundary, /))]
pub(crate) fn gaussian(
    py: Python<'_>,
    q: &Bound<'_, PyAny>,
    translation: Option<&Bound<'_, PyAny>>,
    confidence: Option<&Bound<'_, PyAny>>,
    reference_sigma: &Bound<'_, PyAny>,
    sigma: &Bound<'_, PyAny>,
    boundary: &str,
) -> PyResult<(Py<PyAny>, Option<Py<PyAny>>)> {
    let sigma = input::<f64>("sigma", sigma)?;
    let filter =
        Gaussian { sigma: elements("sigma", &sigma)?.to_vec(), boundary: names::boundary(boundary)? };
    filtered(py, &filter, Arguments { q, translation, confidence, reference_sigma })
}
