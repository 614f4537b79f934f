//! Spikes.

use crate::array::{by_dtype, clip, elements, input, numbers, output, run_interruptible};
use numpy::{Element, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use quatfilt_core::Real;
use quatfilt_core::filters::despike::Despike;

/// Where spikes are, `(frames, joints)`, in rotations `(frames, joints, 4)` or positions `(frames, points, 3)`.
#[pyfunction]
#[pyo3(signature = (x, confidence, noise, smallest, radius, threshold, longest, /))]
#[expect(clippy::too_many_arguments, reason = "those of the reference")]
pub(crate) fn find_spikes(
    py: Python<'_>,
    x: &Bound<'_, PyAny>,
    confidence: Option<&Bound<'_, PyAny>>,
    noise: &Bound<'_, PyAny>,
    smallest: &Bound<'_, PyAny>,
    radius: usize,
    threshold: f64,
    longest: usize,
) -> PyResult<Py<PyAny>> {
    let (noise, smallest) = (numbers("noise", noise)?, numbers("smallest", smallest)?);
    let despike = Despike { noise, smallest, radius, threshold, longest };
    by_dtype!(x, T => typed::<T>(py, &despike, x, confidence))
}

/// Frames in which two joints of rotations `(frames, joints, 4)` have changed places, `(swaps, 4)`.
#[pyfunction]
#[pyo3(signature = (q, confidence, noise, smallest, threshold, longest, /))]
pub(crate) fn find_swaps(
    py: Python<'_>,
    q: &Bound<'_, PyAny>,
    confidence: Option<&Bound<'_, PyAny>>,
    noise: &Bound<'_, PyAny>,
    smallest: &Bound<'_, PyAny>,
    threshold: f64,
    longest: usize,
) -> PyResult<Py<PyAny>> {
    let (noise, smallest) = (numbers("noise", noise)?, numbers("smallest", smallest)?);
    let despike = Despike { noise, smallest, radius: 0, threshold, longest };
    by_dtype!(q, T => swaps_typed::<T>(py, &despike, q, confidence))
}

fn swaps_typed<T: Real + Element>(
    py: Python<'_>,
    despike: &Despike,
    q: &Bound<'_, PyAny>,
    confidence: Option<&Bound<'_, PyAny>>,
) -> PyResult<Py<PyAny>> {
    let q = input::<T>("q", q)?;
    let confidence = confidence.map(|array| input::<T>("confidence", array)).transpose()?;
    let confidence = confidence.as_ref().map(|array| elements("confidence", array)).transpose()?;
    let clip = clip("q", &q)?;
    let nanoseconds = clip.frames() * clip.joints() * 30;
    let swaps = run_interruptible(py, nanoseconds, |interrupt| despike.swaps(clip, confidence, interrupt))?;
    let found = output::<i64>(py, &[swaps.len(), 4]);
    let rows = swaps.iter().flat_map(|swap| [swap.joints[0], swap.joints[1], swap.start, swap.end]);
    for (cell, value) in found.readwrite().as_slice_mut()?.iter_mut().zip(rows) {
        *cell = i64::try_from(value)?;
    }
    Ok(found.into_any().unbind())
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
