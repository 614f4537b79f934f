//! Groups of similar patches.

use super::with_pilot::{Arguments, Step, improved};
use pyo3::prelude::*;
use quatfilt_core::filters::smooth::{self as core, Noisy};
use quatfilt_core::parallel::Interrupt;
use quatfilt_core::{ClipMut, Error, Real};

/// Estimated nanoseconds per rotation of a round.
const NANOSECONDS: usize = 800;

struct Patches {
    rounds: usize,
}

impl Step for Patches {
    fn nanoseconds(&self, frames: usize, joints: usize) -> usize {
        (frames * joints * NANOSECONDS).saturating_mul(self.rounds)
    }

    fn run<T: Real>(
        &self,
        noisy: &Noisy<'_, T>,
        out: ClipMut<'_, T>,
        interrupt: &Interrupt,
    ) -> Result<(), Error> {
        core::smooth_patches(noisy, self.rounds, out, interrupt)
    }
}

/// Improves an estimate of the clean rotations, `(frames, joints, 4)`.
#[pyfunction]
#[pyo3(signature = (q, pilot, confidence, noise, rounds, /))]
pub(crate) fn smooth_patches(
    py: Python<'_>,
    q: &Bound<'_, PyAny>,
    pilot: &Bound<'_, PyAny>,
    confidence: Option<&Bound<'_, PyAny>>,
    noise: &Bound<'_, PyAny>,
    rounds: usize,
) -> PyResult<Py<PyAny>> {
    improved(py, &Patches { rounds }, Arguments { q, pilot, confidence, noise })
}
