//! Spikes.

use crate::array::{by_dtype, clip, elements, input, output, run_interruptible};
use numpy::{Element, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use quatfilt_core::Real;
use quatfilt_core::filters::despike::Despike;

/// Where spikes are, `(frames, joints)`, in rotations `(frames, joints, 4)` or positions `(frames, points, 3)`.
#[pyfunction]
#[pyo3(signature = (x, confidence, noise, smallest, radius, threshold, /))]
pub(crate) fn find_spikes(
    py: Python<'_>,
    x: &Bound<'_, PyAny>,
    confidence: Option<&Bound<'_, PyAny>>,
    noise: &Bound<'_, PyAny>,
    smallest: &Bound<'_, PyAny>,
    radius: usize,
    threshold: f64,
) -> PyResult<Py<PyAny>> {
    let (noise, smallest) = (input::<f64>("noise", noise)?, input::<f64>("smallest", smallest)?);
    let despike = Despike {
        noise: elements("noise", &noise)?.to_vec(),
        smallest: elements("smallest", &smallest)?.to_vec(),
        radius,
        threshold,
    };
    by_dtype!(x, T => typed::<T>(py, &despike, x, confidence))
}

fn typed<T: Real + Element>(
    py: Python<'_>,
    despike: &Despike,
    x: &Bound<'_, PyAny>,
    confidence: Option<&Bound<'_, PyAny>>,
) -> PyResult<Py<PyAny>> {
    let x = input::<T>("x", x)?;
    let confidence = confidence.map(|array| input::<T>("confidence", array)).transpose()?;
    let &[frames, joints, columns] = x.shape() else {
        return Err(PyValueError::new_err(format!("x: expected three dimensions, got {:?}", x.shape())));
    };
    let found = output::<bool>(py, &[frames, joints]);
    {
        let confidence = confidence.as_ref().map(|array| elements("confidence", array)).transpose()?;
        let mut found = found.readwrite();
        let found = found.as_slice_mut()?;
        let nanoseconds = (frames * joints * 40).saturating_mul(despike.radius);
        if columns == 3 {
            let values = elements("x", &x)?;
            run_interruptible(py, nanoseconds, |interrupt| {
                despike.positions(values, (frames, joints), confidence, found, interrupt)
            })?;
        } else {
            let clip = clip("x", &x)?;
            run_interruptible(py, nanoseconds, |interrupt| {
                despike.rotations(clip, confidence, found, interrupt)
            })?;
        }
    }
    Ok(found.into_any().unbind())
}
