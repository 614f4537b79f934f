//! Segmentation into behaviours.

use crate::array::{by_dtype, clip, input, run_interruptible};
use numpy::{Element, IntoPyArray, PyArray1};
use pyo3::prelude::*;
use quatfilt_core::Real;
use quatfilt_core::geodesics::segment::Segment;

type Found = (Py<PyArray1<isize>>, Py<PyArray1<f64>>, Py<PyArray1<f64>>);

/// Cuts `(n,)`, growth of the error and its limit `(frames,)`.
#[pyfunction]
#[pyo3(signature = (q, components, window, min_length, lag, threshold, /))]
pub(crate) fn segment(
    py: Python<'_>,
    q: &Bound<'_, PyAny>,
    components: usize,
    window: usize,
    min_length: usize,
    lag: usize,
    threshold: f64,
) -> PyResult<Found> {
    let segment = Segment { components, window, min_length, lag, threshold };
    by_dtype!(q, T => typed::<T>(py, segment, q))
}

fn typed<T: Real + Element>(py: Python<'_>, segment: Segment, q: &Bound<'_, PyAny>) -> PyResult<Found> {
    let q = input::<T>("q", q)?;
    let clip = clip("q", &q)?;
    let nanoseconds = clip.frames() * clip.joints() * 1500;
    let found = run_interruptible(py, nanoseconds, |interrupt| segment.segment(clip, interrupt))?;
    let cuts: Vec<isize> = found.cuts.into_iter().map(usize::cast_signed).collect();
    Ok((
        cuts.into_pyarray(py).unbind(),
        found.growth.into_pyarray(py).unbind(),
        found.limit.into_pyarray(py).unbind(),
    ))
}
