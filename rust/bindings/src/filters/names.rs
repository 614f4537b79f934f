//! Options by name.

use pyo3::PyResult;
use pyo3::exceptions::PyValueError;
use quatfilt_core::window::Boundary;

/// The value of a named option.
pub(crate) fn named<V: Copy>(argument: &str, name: &str, values: &[(&str, V)]) -> PyResult<V> {
    values
        .iter()
        .find(|(known, _)| *known == name)
        .map(|(_, value)| *value)
        .ok_or_else(|| PyValueError::new_err(format!("{argument}: unknown name {name:?}")))
}

/// Continuation of a clip beyond its ends.
pub(super) fn boundary(name: &str) -> PyResult<Boundary> {
    named(
        "boundary",
        name,
        &[("mirror", Boundary::Mirror), ("linear", Boundary::Linear), ("nearest", Boundary::Nearest)],
    )
}
