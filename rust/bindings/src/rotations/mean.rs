//! Karcher mean.

use crate::array::{by_dtype, elements, input, output, run_interruptible};
use numpy::{Element, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use quatfilt_core::{ClipView, Real, rotations};

/// Karcher mean of each joint, `(frames, joints, 4)` → `(joints, 4)`.
#[pyfunction]
#[pyo3(signature = (q, weights, /))]
pub(crate) fn mean(
    py: Python<'_>,
    q: &Bound<'_, PyAny>,
    weights: Option<&Bound<'_, PyAny>>,
) -> PyResult<Py<PyAny>> {
    by_dtype!(q, T => typed::<T>(py, q, weights))
}

fn typed<T: Real + Element>(
    py: Python<'_>,
    q: &Bound<'_, PyAny>,
    weights: Option<&Bound<'_, PyAny>>,
) -> PyResult<Py<PyAny>> {
    let q = input::<T>("q", q)?;
    let weights = weights.map(|weights| input::<T>("weights", weights)).transpose()?;
    let (frames, joints) = (q.shape()[0], q.shape()[1]);
    let out = output::<T>(py, &[joints, 4]);
    {
        let q = elements("q", &q)?;
        let weights = weights.as_ref().map(|weights| elements("weights", weights)).transpose()?;
        let mut out = out.readwrite();
        let out = out.as_slice_mut()?;
        run_interruptible(py, q.len() * 10, |interrupt| {
            let means = rotations::mean::mean(ClipView::new(q, frames, joints)?, weights, interrupt)?;
            for (out, mean) in out.chunks_exact_mut(4).zip(means) {
                out.copy_from_slice(&mean.map(T::from_f64));
            }
            Ok(())
        })?;
    }
    Ok(out.into_any().unbind())
}
