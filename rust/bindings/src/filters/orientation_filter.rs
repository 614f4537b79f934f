//! Orientation filters.

use super::names;
use crate::array::{by_dtype, clip, clip_mut, elements, input, output, run_interruptible};
use numpy::{PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use quatfilt_core::filters::orientation_filter::OrientationFilter;

/// Rotations `(frames, joints, 4)` filtered with a mask `(2k + 1,)`.
#[pyfunction]
#[pyo3(signature = (q, mask, iterations, boundary, /))]
pub(crate) fn orientation_filter(
    py: Python<'_>,
    q: &Bound<'_, PyAny>,
    mask: &Bound<'_, PyAny>,
    iterations: usize,
    boundary: &str,
) -> PyResult<Py<PyAny>> {
    let mask = input::<f64>("mask", mask)?;
    let filter = OrientationFilter {
        mask: elements("mask", &mask)?.to_vec(),
        iterations,
        boundary: names::boundary(boundary)?,
    };
    by_dtype!(q, T => {
        let q = input::<T>("q", q)?;
        let out = output::<T>(py, q.shape());
        let q = clip("q", &q)?;
        {
            let mut out = out.readwrite();
            let out = clip_mut(&mut out, q.frames(), q.joints())?;
            let nanoseconds = (q.data().len() * filter.mask.len()).saturating_mul(iterations);
            run_interruptible(py, nanoseconds, |interrupt| filter.filter(q, out, interrupt))?;
        }
        Ok(out.into_any().unbind())
    })
}
