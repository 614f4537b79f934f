//! The 1€ filter.

use crate::array::{by_dtype, clip, clip_mut, elements, input, numbers, output, run_interruptible};
use numpy::{Element, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use quatfilt_core::Real;
use quatfilt_core::filters::one_euro::{OneEuro, Translation};

/// Estimated nanoseconds per sample.
const NANOSECONDS: usize = 40;

/// Filters rotations `(frames, joints, 4)` and, with the smoothing factors of the first joint, a translation
/// `(frames, 3)`.
#[pyfunction]
#[pyo3(signature = (q, translation, confidence, min_cutoff, beta, derivative_cutoff, /))]
pub(crate) fn one_euro(
    py: Python<'_>,
    q: &Bound<'_, PyAny>,
    translation: Option<&Bound<'_, PyAny>>,
    confidence: Option<&Bound<'_, PyAny>>,
    min_cutoff: &Bound<'_, PyAny>,
    beta: &Bound<'_, PyAny>,
    derivative_cutoff: &Bound<'_, PyAny>,
) -> PyResult<(Py<PyAny>, Option<Py<PyAny>>)> {
    let filter = parameters(min_cutoff, beta, derivative_cutoff)?;
    by_dtype!(q, T => typed::<T>(py, &filter, q, translation, confidence))
}

/// The filter with these arguments.
pub(super) fn parameters(
    min_cutoff: &Bound<'_, PyAny>,
    beta: &Bound<'_, PyAny>,
    derivative_cutoff: &Bound<'_, PyAny>,
) -> PyResult<OneEuro> {
    Ok(OneEuro {
        min_cutoff: numbers("min_cutoff", min_cutoff)?,
        beta: numbers("beta", beta)?,
        derivative_cutoff: numbers("derivative_cutoff", derivative_cutoff)?,
    })
}

fn typed<T: Real + Element>(
    py: Python<'_>,
    filter: &OneEuro,
    q: &Bound<'_, PyAny>,
    translation: Option<&Bound<'_, PyAny>>,
    confidence: Option<&Bound<'_, PyAny>>,
) -> PyResult<(Py<PyAny>, Option<Py<PyAny>>)> {
    let q = input::<T>("q", q)?;
    let translation = translation.map(|array| input::<T>("translation", array)).transpose()?;
    let confidence = confidence.map(|array| input::<T>("confidence", array)).transpose()?;
    let out = output::<T>(py, q.shape());
    let moved_out = translation.as_ref().map(|translation| output::<T>(py, translation.shape()));
    {
        let q = clip("q", &q)?;
        let values = translation.as_ref().map(|array| elements("translation", array)).transpose()?;
        let confidence = confidence.as_ref().map(|array| elements("confidence", array)).transpose()?;
        let mut out = out.readwrite();
        let out = clip_mut(&mut out, q.frames(), q.joints())?;
        let mut moved_out = moved_out.as_ref().map(PyArrayMethods::readwrite);
        let moved_out = moved_out.as_mut().map(|array| array.as_slice_mut()).transpose()?;
        run_interruptible(py, q.data().len() / 4 * NANOSECONDS, |interrupt| {
            let translation = values.zip(moved_out).map(|(values, out)| Translation { values, out });
            filter.filter(q, translation, confidence, out, interrupt)
        })?;
    }
    Ok((out.into_any().unbind(), moved_out.map(|array| array.into_any().unbind())))
}
