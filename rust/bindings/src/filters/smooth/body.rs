//! All joints along the axes of the whole body.

use super::with_pilot::{Arguments, Step, improved};
use pyo3::prelude::*;
use quatfilt_core::filters::smooth::{self as core, Noisy};
use quatfilt_core::parallel::Interrupt;
use quatfilt_core::{ClipMut, Error, Real};

/// Estimated nanoseconds per frame, joint and joint.
const NANOSECONDS: usize = 15;

struct Body;

impl Step for Body {
    fn nanoseconds(&self, frames: usize, joints: usize) -> usize {
        frames * joints * joints * NANOSECONDS
    }

    fn run<T: Real>(
        &self,
        noisy: &Noisy<'_, T>,
        out: ClipMut<'_, T>,
        interrupt: &Interrupt,
    ) -> Result<(), Error> {
        core::smooth_body(noisy, out, interrupt)
    }
}

/// Rotations `(frames, joints, 4)` smoothed along the principal axes of the whole body, and their mean with the pilot.
#[pyfunction]
#[pyo3(signature = (q, pilot, confidence, noise, /))]
pub(crate) fn smooth_body(
    py: Python<'_>,
    q: &Bound<'_, PyAny>,
    pilot: &Bound<'_, PyAny>,
    confidence: Option<&Bound<'_, PyAny>>,
    noise: &Bound<'_, PyAny>,
) -> PyResult<Py<PyAny>> {
    improved(py, &Body, Arguments { q, pilot, confidence, noise })
}
