//! Names that stand for choices.

use pyo3::PyResult;
use pyo3::exceptions::PyValueError;
use quatfilt_core::window::Boundary;

/// The value that a name stands for.
pub(crate) fn named<V: Copy>(argument: &str, name: &str, values: &[(&str, V)]) -> PyResult<V> {
    values
        .iter()
        .find(|(known, _)| *known == name)
        .map(|(_, value)| *value)
        .ok_or_else(|| PyValueError::new_err(format!("{argument}: unknown name {name:?}")))
}

/// How a clip goes on beyond its ends.
pub(super) fn boundary(name: &str) -> PyResult<Boundary> {
    named(
        "boundary",
        name,
        &[("mirror", Boundary::Mirror), ("linear", Boundary::Linear), ("nearest", Boundary::Nearest)],
    )
}
