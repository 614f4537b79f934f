//! Automatic smoothing.

pub(crate) mod body;
pub(crate) mod gains;
pub(crate) mod low_pass;
pub(crate) mod patches;
pub(crate) mod rank;
mod with_pilot;

use super::development::{Arguments, filtered};
use crate::array::{elements, input};
use numpy::PyUntypedArrayMethods;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use quatfilt_core::filters::smooth::{REFERENCE_SIGMA, Smoother};

/// Smooths rotations `(frames, joints, 4)` and a translation `(frames, 3)` by as much as their noise asks for.
#[pyfunction]
#[pyo3(signature = (q, translation, confidence, noise, translation_noise, /))]
pub(crate) fn smooth(
    py: Python<'_>,
    q: &Bound<'_, PyAny>,
    translation: Option<&Bound<'_, PyAny>>,
    confidence: Option<&Bound<'_, PyAny>>,
    noise: &Bound<'_, PyAny>,
    translation_noise: f64,
) -> PyResult<(Py<PyAny>, Option<Py<PyAny>>)> {
    let noise = input::<f64>("noise", noise)?;
    let noise = elements("noise", &noise)?.to_vec();
    let frames = q
        .cast::<numpy::PyUntypedArray>()?
        .shape()
        .first()
        .copied()
        .ok_or_else(|| PyValueError::new_err("q: expected shape (frames, joints, 4), got ()"))?;
    let reference_sigma = numpy::PyArray1::from_vec(py, vec![REFERENCE_SIGMA; noise.len()]);
    let filter = Smoother::new(frames, noise, translation_noise);
    let reference_sigma = reference_sigma.as_any();
    filtered(py, &filter, Arguments { q, translation, confidence, reference_sigma })
}
