//! Motion-capture files: bytes as input and output. Python handles paths and the meaning of channels.

pub(crate) mod acclaim;
pub(crate) mod bvh;

use crate::array::BUG;
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use quatfilt_core::parallel;
use quatfilt_formats::{Error, Note};
use std::panic::{AssertUnwindSafe, catch_unwind};

pyo3::create_exception!(
    quatfilt._core,
    FormatError,
    PyValueError,
    "Why a file was refused: line (an integer or None) and reason."
);

/// Runs `work` in the pool, detached from the interpreter; errors and panics become Python exceptions.
fn run<R: Send>(py: Python<'_>, work: impl FnOnce() -> Result<R, Error> + Send) -> PyResult<R> {
    match py.detach(|| catch_unwind(AssertUnwindSafe(|| parallel::install(work)))) {
        Ok(result) => result.map_err(|error| FormatError::new_err((error.line, error.reason))),
        Err(_) => Err(PyRuntimeError::new_err(BUG)),
    }
}

fn texts(notes: &[Note]) -> Vec<String> {
    notes.iter().map(ToString::to_string).collect()
}
