//! Orientation filters.

use super::names;
use crate::array::{by_dtype, clip, clip_mut, elements, input, output, run_interruptible};
use numpy::{Element, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use quatfilt_core::Real;
use quatfilt_core::filters::orientation_filter::{OrientationFilter, Translation};

/// Rotations `(frames, joints, 4)` and a translation `(frames, 3)` filtered with a mask `(2k + 1,)`.
#[pyfunction]
#[pyo3(signature = (q, translation, mask, iterations, boundary, /))]
pub(crate) fn orientation_filter(
    py: Python<'_>,
    q: &Bound<'_, PyAny>,
    translation: Option<&Bound<'_, PyAny>>,
    mask: &Bound<'_, PyAny>,
    iterations: usize,
    boundary: &str,
) -> PyResult<(Py<PyAny>, Option<Py<PyAny>>)> {
    let mask = input::<f64>("mask", mask)?;
    let filter = OrientationFilter {
        mask: elements("mask", &mask)?.to_vec(),
        iterations,
        boundary: names::boundary(boundary)?,
    };
    by_dtype!(q, T => typed::<T>(py, &filter, q, translation))
}

fn typed<T: Real + Element>(
    py: Python<'_>,
    filter: &OrientationFilter,
    q: &Bound<'_, PyAny>,
    translation: Option<&Bound<'_, PyAny>>,
) -> PyResult<(Py<PyAny>, Option<Py<PyAny>>)> {
    let q = input::<T>("q", q)?;
    let translation = translation.map(|array| input::<T>("translation", array)).transpose()?;
    let out = output::<T>(py, q.shape());
    let moved_out = translation.as_ref().map(|translation| output::<T>(py, translation.shape()));
    {
        let q = clip("q", &q)?;
        let values = translation.as_ref().map(|array| elements("translation", array)).transpose()?;
        let mut out = out.readwrite();
        let out = clip_mut(&mut out, q.frames(), q.joints())?;
        let mut moved_out = moved_out.as_ref().map(PyArrayMethods::readwrite);
        let moved_out = moved_out.as_mut().map(|array| array.as_slice_mut()).transpose()?;
        let nanoseconds = (q.data().len() * filter.mask.len()).saturating_mul(filter.iterations);
        run_interruptible(py, nanoseconds, |interrupt| {
            let translation = values.zip(moved_out).map(|(values, out)| Translation { values, out });
            filter.filter(q, translation, out, interrupt)
        })?;
    }
    Ok((out.into_any().unbind(), moved_out.map(|array| array.into_any().unbind())))
}
