//! The Savitzky–Golay filter.

use super::development::{Arguments, NANOSECONDS, filtered};
use crate::array::{by_dtype, clip, elements, input, output, run_interruptible};
use numpy::{PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use quatfilt_core::filters::development::{Input, Smooth};
use quatfilt_core::filters::savgol::Savgol;

fn filter(fit: &Bound<'_, PyAny>, values: &Bound<'_, PyAny>) -> PyResult<Savgol> {
    let fit = input::<f64>("fit", fit)?;
    let values = input::<f64>("values", values)?;
    Ok(Savgol {
        window: fit.shape().get(1).copied().unwrap_or_default(),
        fit: elements("fit", &fit)?.to_vec(),
        values: elements("values", &values)?.to_vec(),
    })
}

/// Filters rotations `(frames, joints, 4)` and a translation `(frames, 3)`.
#[pyfunction]
#[pyo3(signature = (q, translation, confidence, reference_sigma, fit, values, /))]
pub(crate) fn savgol(
    py: Python<'_>,
    q: &Bound<'_, PyAny>,
    translation: Option<&Bound<'_, PyAny>>,
    confidence: Option<&Bound<'_, PyAny>>,
    reference_sigma: &Bound<'_, PyAny>,
    fit: &Bound<'_, PyAny>,
    values: &Bound<'_, PyAny>,
) -> PyResult<(Py<PyAny>, Option<Py<PyAny>>)> {
    let filter = filter(fit, values)?;
    filtered(py, &filter, Arguments { q, translation, confidence, reference_sigma })
}

/// Derivatives of rotations in body coordinates, `(frames, joints, 3)`.
#[pyfunction]
#[pyo3(signature = (q, confidence, reference_sigma, fit, values, derivatives, /))]
pub(crate) fn savgol_derivative(
    py: Python<'_>,
    q: &Bound<'_, PyAny>,
    confidence: Option<&Bound<'_, PyAny>>,
    reference_sigma: &Bound<'_, PyAny>,
    fit: &Bound<'_, PyAny>,
    values: &Bound<'_, PyAny>,
    derivatives: &Bound<'_, PyAny>,
) -> PyResult<Py<PyAny>> {
    let filter = filter(fit, values)?;
    let derivatives = input::<f64>("derivatives", derivatives)?;
    let derivatives = elements("derivatives", &derivatives)?.to_vec();
    let sigma = input::<f64>("reference_sigma", reference_sigma)?;
    let reference_sigma = elements("reference_sigma", &sigma)?;
    by_dtype!(q, T => {
        let q = input::<T>("q", q)?;
        let clip = clip("q", &q)?;
        let confidence = confidence.map(|array| input::<T>("confidence", array)).transpose()?;
        let confidence = confidence.as_ref().map(|array| elements("confidence", array)).transpose()?;
        let out = output::<T>(py, &[clip.frames(), clip.joints(), 3]);
        {
            let mut out = out.readwrite();
            let out = out.as_slice_mut()?;
            let input = Input { clip, confidence, reference_sigma };
            let nanoseconds = clip.frames() * clip.joints() * 2 * (NANOSECONDS + filter.nanoseconds());
            run_interruptible(py, nanoseconds, |interrupt| {
                filter.derivative(input, derivatives, out, interrupt)
            })?;
        }
        Ok(out.into_any().unbind())
    })
}
