//! Recursive filters, forwards and backwards.

use super::development::{Arguments, filtered};
use crate::array::{elements, input};
use numpy::PyUntypedArrayMethods;
use pyo3::prelude::*;
use quatfilt_core::filters::butterworth::Butterworth;

/// Filters rotations `(frames, joints, 4)` and, like the first joint, a translation `(frames, 3)`.
#[pyfunction]
#[pyo3(signature = (q, translation, confidence, reference_sigma, sections, states, padding, /))]
#[allow(clippy::too_many_arguments, reason = "the reference's positional arguments")]
pub(crate) fn butterworth(
    py: Python<'_>,
    q: &Bound<'_, PyAny>,
    translation: Option<&Bound<'_, PyAny>>,
    confidence: Option<&Bound<'_, PyAny>>,
    reference_sigma: &Bound<'_, PyAny>,
    sections: &Bound<'_, PyAny>,
    states: &Bound<'_, PyAny>,
    padding: usize,
) -> PyResult<(Py<PyAny>, Option<Py<PyAny>>)> {
    let sections = input::<f64>("sections", sections)?;
    let states = input::<f64>("states", states)?;
    let filter = Butterworth {
        sections: elements("sections", &sections)?.to_vec(),
        states: elements("states", &states)?.to_vec(),
        count: sections.shape().get(1).copied().unwrap_or_default(),
        padding,
    };
    filtered(py, &filter, Arguments { q, translation, confidence, reference_sigma })
}
