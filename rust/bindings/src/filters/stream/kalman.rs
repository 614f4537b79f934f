//! The Kalman filter of a stream.

use super::PoseStream;
use crate::filters::kalman::parameters;
use pyo3::prelude::*;

/// A stream of poses with one joint per noise; the arguments are those of `kalman` after the arrays.
#[pyfunction]
#[pyo3(signature = (process_noise, measurement_noise, lookahead, /))]
pub(crate) fn kalman_stream(
    process_noise: &Bound<'_, PyAny>,
    measurement_noise: &Bound<'_, PyAny>,
    lookahead: isize,
) -> PyResult<PoseStream> {
    PoseStream::new(parameters(process_noise, measurement_noise, lookahead)?.stream())
}
