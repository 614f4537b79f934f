//! Low rank in bands of frequencies.

use super::with_pilot::{Arguments, Step, improved};
use pyo3::prelude::*;
use quatfilt_core::filters::smooth::{self as core, Noisy};
use quatfilt_core::parallel::Interrupt;
use quatfilt_core::{ClipMut, Error, Real};

/// Estimated nanoseconds per frame, joint and joint.
const NANOSECONDS: usize = 20;

struct Rank;

impl Step for Rank {
    fn nanoseconds(&self, frames: usize, joints: usize) -> usize {
        frames * joints * joints * NANOSECONDS
    }

    fn run<T: Real>(
        &self,
        noisy: &Noisy<'_, T>,
        out: ClipMut<'_, T>,
        interrupt: &Interrupt,
    ) -> Result<(), Error> {
        core::smooth_rank(noisy, out, interrupt)
    }
}

/// The mean of an estimate of the clean rotations, `(frames, joints, 4)`, and of one that has low rank.
#[pyfunction]
#[pyo3(signature = (q, pilot, confidence, noise, /))]
pub(crate) fn smooth_rank(
    py: Python<'_>,
    q: &Bound<'_, PyAny>,
    pilot: &Bound<'_, PyAny>,
    confidence: Option<&Bound<'_, PyAny>>,
    noise: &Bound<'_, PyAny>,
) -> PyResult<Py<PyAny>> {
    improved(py, &Rank, Arguments { q, pilot, confidence, noise })
}
