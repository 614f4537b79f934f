//! Names that stand for choices.

use pyo3::PyResult;
use pyo3::exceptions::PyValueError;

/// The value that a name stands for.
pub(crate) fn named<V: Copy>(argument: &str, name: &str, values: &[(&str, V)]) -> PyResult<V> {
    values
        .iter()
        .find(|(known, _)| *known == name)
        .map(|(_, value)| *value)
        .ok_or_else(|| PyValueError::new_err(format!("{argument}: unknown name {name:?}")))
}
