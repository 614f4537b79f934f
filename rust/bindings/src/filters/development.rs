//! Rotations as vectors about a reference path, and the shared code of linear filters on them.

use crate::array::{by_dtype, clip, clip_mut, elements, input, output, run, run_interruptible};
use numpy::{Element, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use quatfilt_core::Real;
use quatfilt_core::filters::development::{self, Developed, Input, Smooth, Translation};

/// The reference path `(frames, joints, 4)`, its development and the vectors, `(frames, joints, 3)`, all float64.
#[pyfunction]
#[pyo3(signature = (q, confidence, reference_sigma, /))]
pub(crate) fn develop(
    py: Python<'_>,
    q: &Bound<'_, PyAny>,
    confidence: Option<&Bound<'_, PyAny>>,
    reference_sigma: &Bound<'_, PyAny>,
) -> PyResult<(Py<PyAny>, Py<PyAny>, Py<PyAny>)> {
    let sigma = input::<f64>("reference_sigma", reference_sigma)?;
    let sigma = elements("reference_sigma", &sigma)?;
    by_dtype!(q, T => {
        let q = input::<T>("q", q)?;
        let clip = clip("q", &q)?;
        let confidence = confidence.map(|array| input::<T>("confidence", array)).transpose()?;
        let confidence = confidence.as_ref().map(|array| elements("confidence", array)).transpose()?;
        let [reference, development, vectors] =
            [4, 3, 3].map(|width| output::<f64>(py, &[clip.frames(), clip.joints(), width]));
        {
            let (mut a, mut b, mut c) =
                (reference.readwrite(), development.readwrite(), vectors.readwrite());
            let out = Developed {
                reference: a.as_slice_mut()?,
                development: b.as_slice_mut()?,
                vectors: c.as_slice_mut()?,
            };
            let input = Input { clip, confidence, reference_sigma: sigma };
            run_interruptible(py, clip.frames() * clip.joints() * NANOSECONDS, |interrupt| {
                development::develop(input, out, interrupt)
            })?;
        }
        Ok((reference.into_any().unbind(), development.into_any().unbind(), vectors.into_any().unbind()))
    })
}

/// Rotations `(frames, joints, 4)` from vectors about a reference path.
#[pyfunction]
#[pyo3(signature = (q, reference, development, vectors, /))]
pub(crate) fn undevelop(
    py: Python<'_>,
    q: &Bound<'_, PyAny>,
    reference: &Bound<'_, PyAny>,
    development: &Bound<'_, PyAny>,
    vectors: &Bound<'_, PyAny>,
) -> PyResult<Py<PyAny>> {
    let [reference, development, vectors] =
        [("reference", reference), ("development", development), ("vectors", vectors)]
            .map(|(name, array)| input::<f64>(name, array));
    let (reference, development, vectors) = (reference?, development?, vectors?);
    let reference = elements("reference", &reference)?;
    let development = elements("development", &development)?;
    let vectors = elements("vectors", &vectors)?;
    by_dtype!(q, T => {
        let q = input::<T>("q", q)?;
        let out = output::<T>(py, q.shape());
        let q = clip("q", &q)?;
        {
            let mut out = out.readwrite();
            let out = clip_mut(&mut out, q.frames(), q.joints())?;
            run(py, || development::undevelop(q, reference, development, vectors, out))?;
        }
        Ok(out.into_any().unbind())
    })
}

/// Estimated nanoseconds per rotation for the development and its inverse.
pub(super) const NANOSECONDS: usize = 60;

/// Arguments of linear filters on vectors about a reference path.
#[derive(Debug, Clone, Copy)]
pub(super) struct Arguments<'a, 'py> {
    pub(super) q: &'a Bound<'py, PyAny>,
    pub(super) translation: Option<&'a Bound<'py, PyAny>>,
    pub(super) confidence: Option<&'a Bound<'py, PyAny>>,
    pub(super) reference_sigma: &'a Bound<'py, PyAny>,
}

/// Rotations `(frames, joints, 4)` and a translation `(frames, 3)`, filtered.
pub(super) fn filtered(
    py: Python<'_>,
    filter: &impl Smooth,
    arguments: Arguments<'_, '_>,
) -> PyResult<(Py<PyAny>, Option<Py<PyAny>>)> {
    by_dtype!(arguments.q, T => typed::<T>(py, filter, arguments))
}

fn typed<T: Real + Element>(
    py: Python<'_>,
    filter: &impl Smooth,
    arguments: Arguments<'_, '_>,
) -> PyResult<(Py<PyAny>, Option<Py<PyAny>>)> {
    let q = input::<T>("q", arguments.q)?;
    let translation = arguments.translation.map(|array| input::<T>("translation", array)).transpose()?;
    let confidence = arguments.confidence.map(|array| input::<T>("confidence", array)).transpose()?;
    let sigma = input::<f64>("reference_sigma", arguments.reference_sigma)?;
    let out = output::<T>(py, q.shape());
    let moved_out = translation.as_ref().map(|translation| output::<T>(py, translation.shape()));
    {
        let clip = clip("q", &q)?;
        let values = translation.as_ref().map(|array| elements("translation", array)).transpose()?;
        let confidence = confidence.as_ref().map(|array| elements("confidence", array)).transpose()?;
        let reference_sigma = elements("reference_sigma", &sigma)?;
        let mut out = out.readwrite();
        let out = clip_mut(&mut out, clip.frames(), clip.joints())?;
        let mut moved_out = moved_out.as_ref().map(PyArrayMethods::readwrite);
        let moved_out = moved_out.as_mut().map(|array| array.as_slice_mut()).transpose()?;
        let samples = clip.frames() * clip.joints();
        let nanoseconds = samples.saturating_mul(NANOSECONDS.saturating_add(filter.nanoseconds()));
        let input = Input { clip, confidence, reference_sigma };
        run_interruptible(py, nanoseconds, |interrupt| {
            let translation = values.zip(moved_out).map(|(values, out)| Translation { values, out });
            input.filter(filter, translation, out, interrupt)
        })?;
    }
    Ok((out.into_any().unbind(), moved_out.map(|array| array.into_any().unbind())))
}
