//! Rotations whose noise is white, and back; samples drawn towards an estimate.

use crate::array::{by_dtype, clip, clip_mut, elements, input, output, run, run_interruptible};
use numpy::{PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use quatfilt_core::noise::outliers;
use quatfilt_core::noise::whiten::{Shape, Whitened};

/// Estimated nanoseconds per component of a rotation.
const NANOSECONDS: usize = 20;

/// A reference path, its development and the vectors, with noise that is alike in time and direction.
#[pyfunction]
#[pyo3(signature = (reference, development, vectors, colour, spread, axes, /))]
pub(crate) fn whiten(
    py: Python<'_>,
    reference: &Bound<'_, PyAny>,
    development: &Bound<'_, PyAny>,
    vectors: &Bound<'_, PyAny>,
    colour: f64,
    spread: &Bound<'_, PyAny>,
    axes: &Bound<'_, PyAny>,
) -> PyResult<(Py<PyAny>, Py<PyAny>, Py<PyAny>)> {
    let (reference, development) =
        (input::<f64>("reference", reference)?, input::<f64>("development", development)?);
    let vectors = input::<f64>("vectors", vectors)?;
    let (spread, axes) = (input::<f64>("spread", spread)?, input::<f64>("axes", axes)?);
    let shape = Shape { colour, spread: elements("spread", &spread)?, axes: elements("axes", &axes)? };
    let developed = (
        elements("reference", &reference)?,
        elements("development", &development)?,
        elements("vectors", &vectors)?,
    );
    let path = output::<f64>(py, reference.shape());
    let [flat, white] = [(), ()].map(|()| output::<f64>(py, vectors.shape()));
    {
        let (mut a, mut b, mut c) = (path.readwrite(), flat.readwrite(), white.readwrite());
        let out = Whitened {
            reference: a.as_slice_mut()?,
            development: b.as_slice_mut()?,
            vectors: c.as_slice_mut()?,
        };
        run_interruptible(py, developed.0.len() * NANOSECONDS, |interrupt| {
            shape.whiten(developed, out, interrupt)
        })?;
    }
    Ok((path.into_any().unbind(), flat.into_any().unbind(), white.into_any().unbind()))
}

/// Vectors about the first reference path of filtered white ones.
#[pyfunction]
#[pyo3(signature = (q, reference, development, colour, spread, axes, /))]
pub(crate) fn unwhiten(
    py: Python<'_>,
    q: &Bound<'_, PyAny>,
    reference: &Bound<'_, PyAny>,
    development: &Bound<'_, PyAny>,
    colour: f64,
    spread: &Bound<'_, PyAny>,
    axes: &Bound<'_, PyAny>,
) -> PyResult<Py<PyAny>> {
    let (reference, development) =
        (input::<f64>("reference", reference)?, input::<f64>("development", development)?);
    let (spread, axes) = (input::<f64>("spread", spread)?, input::<f64>("axes", axes)?);
    let shape = Shape { colour, spread: elements("spread", &spread)?, axes: elements("axes", &axes)? };
    let about = (elements("reference", &reference)?, elements("development", &development)?);
    by_dtype!(q, T => {
        let q = input::<T>("q", q)?;
        let q = clip("q", &q)?;
        let out = output::<f64>(py, &[q.frames(), q.joints(), 3]);
        {
            let mut out = out.readwrite();
            let out = out.as_slice_mut()?;
            run_interruptible(py, q.data().len() * NANOSECONDS, |interrupt| shape.unwhiten(q, about, out, interrupt))?;
        }
        Ok(out.into_any().unbind())
    })
}

/// Rotations that keep a share `(frames)` of their displacement from an estimate.
#[pyfunction]
#[pyo3(signature = (q, estimate, share, /))]
pub(crate) fn drawn_towards(
    py: Python<'_>,
    q: &Bound<'_, PyAny>,
    estimate: &Bound<'_, PyAny>,
    share: &Bound<'_, PyAny>,
) -> PyResult<Py<PyAny>> {
    let share = input::<f64>("share", share)?;
    let share = elements("share", &share)?;
    by_dtype!(q, T => {
        let (q, estimate) = (input::<T>("q", q)?, input::<T>("estimate", estimate)?);
        let (q, estimate) = (clip("q", &q)?, clip("estimate", &estimate)?);
        let out = output::<T>(py, &[q.frames(), q.joints(), 4]);
        {
            let mut out = out.readwrite();
            let out = clip_mut(&mut out, q.frames(), q.joints())?;
            run(py, || outliers::drawn_towards(q, estimate, share, out))?;
        }
        Ok(out.into_any().unbind())
    })
}
