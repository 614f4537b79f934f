//! The bilateral orientation filter of a stream.

use super::PoseStream;
use crate::filters::bilateral::filter;
use pyo3::prelude::*;

/// A stream of poses with one joint per angle scale; the arguments are those of `bilateral` after the arrays.
#[pyfunction]
#[pyo3(signature = (radius, sigma_time, sigma_angle, kernel, iterations, boundary, lookahead, /))]
pub(crate) fn bilateral_stream(
    radius: usize,
    sigma_time: f64,
    sigma_angle: &Bound<'_, PyAny>,
    kernel: &str,
    iterations: usize,
    boundary: &str,
    lookahead: i64,
) -> PyResult<PoseStream> {
    let filter = filter(radius, sigma_time, sigma_angle, kernel, iterations, boundary, lookahead)?;
    PoseStream::new(filter.stream())
}
