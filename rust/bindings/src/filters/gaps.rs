//! Gaps: runs of missing samples.

use super::names::named;
use crate::array::{by_dtype, clip, clip_mut, input, output, run};
use numpy::{PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use quatfilt_core::filters::gaps::{self, Method};

/// Filled runs of missing samples, `(frames, joints, 4)`, and the mask of filled samples, `(frames, joints)`.
#[pyfunction]
#[pyo3(signature = (q, max_gap, method, /))]
pub(crate) fn fill_gaps(
    py: Python<'_>,
    q: &Bound<'_, PyAny>,
    max_gap: isize,
    method: &str,
) -> PyResult<(Py<PyAny>, Py<PyAny>)> {
    let max_gap = usize::try_from(max_gap).ok();
    let method = named("method", method, &[("slerp", Method::Slerp), ("squad", Method::Squad)])?;
    by_dtype!(q, T => {
        let q = input::<T>("q", q)?;
        let out = output::<T>(py, q.shape());
        let q = clip("q", &q)?;
        let filled = output::<bool>(py, &[q.frames(), q.joints()]);
        {
            let (mut out, mut filled) = (out.readwrite(), filled.readwrite());
            let out = clip_mut(&mut out, q.frames(), q.joints())?;
            let filled = filled.as_slice_mut()?;
            run(py, || gaps::fill_gaps(q, max_gap, method, out, filled))?;
        }
        Ok((out.into_any().unbind(), filled.into_any().unbind()))
    })
}
