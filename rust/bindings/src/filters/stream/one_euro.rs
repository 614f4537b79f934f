//! The 1€ filter of a stream.

use super::PoseStream;
use crate::filters::one_euro::parameters;
use pyo3::prelude::*;

/// A stream of poses with one joint per cutoff; the arguments are those of `one_euro` after the arrays.
#[pyfunction]
#[pyo3(signature = (min_cutoff, beta, derivative_cutoff, /))]
pub(crate) fn one_euro_stream(
    min_cutoff: &Bound<'_, PyAny>,
    beta: &Bound<'_, PyAny>,
    derivative_cutoff: &Bound<'_, PyAny>,
) -> PyResult<PoseStream> {
    PoseStream::new(parameters(min_cutoff, beta, derivative_cutoff)?.stream())
}
