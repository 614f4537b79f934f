//! Automatic smoothing.

pub(crate) mod patches;
pub(crate) mod rank;

use super::development::{Arguments, filtered};
use crate::array::{by_dtype, clip, clip_mut, elements, input, output, run_interruptible};
use numpy::{PyArrayMethods, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use quatfilt_core::filters::smooth as core;
use quatfilt_core::filters::smooth::{Noisy, REFERENCE_SIGMA, Smoother};

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

/// Rotations `(frames, joints, 4)` smoothed along the principal axes of the whole body, and their mean with the pilot.
#[pyfunction]
#[pyo3(signature = (q, pilot, confidence, noise, /))]
pub(crate) fn smooth_body(
    py: Python<'_>,
    q: &Bound<'_, PyAny>,
    pilot: &Bound<'_, PyAny>,
    confidence: Option<&Bound<'_, PyAny>>,
    noise: &Bound<'_, PyAny>,
) -> PyResult<Py<PyAny>> {
    let noise = input::<f64>("noise", noise)?;
    let noise = elements("noise", &noise)?;
    by_dtype!(q, T => {
        let (q, pilot) = (input::<T>("q", q)?, input::<T>("pilot", pilot)?);
        let confidence = confidence.map(|array| input::<T>("confidence", array)).transpose()?;
        let confidence = confidence.as_ref().map(|array| elements("confidence", array)).transpose()?;
        let out = output::<T>(py, q.shape());
        {
            let noisy = Noisy { clip: clip("q", &q)?, pilot: clip("pilot", &pilot)?, confidence, noise };
            let (frames, joints) = (noisy.clip.frames(), noisy.clip.joints());
            let mut out = out.readwrite();
            let out = clip_mut(&mut out, frames, joints)?;
            run_interruptible(py, frames * joints * joints * 40, |interrupt| {
                core::smooth_body(&noisy, out, interrupt)
            })?;
        }
        Ok(out.into_any().unbind())
    })
}
