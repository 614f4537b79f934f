//! What steps that improve an estimate have in common.

use crate::array::{by_dtype, clip, clip_mut, elements, input, output, run_interruptible};
use numpy::{PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use quatfilt_core::filters::smooth::Noisy;
use quatfilt_core::parallel::Interrupt;
use quatfilt_core::{ClipMut, Error, Real};

/// A step from an estimate of the clean rotations to a better one.
pub(super) trait Step: Sync {
    /// Estimated nanoseconds of a clip of so many frames and joints.
    fn nanoseconds(&self, frames: usize, joints: usize) -> usize;

    /// Writes the better estimate.
    fn run<T: Real>(
        &self,
        noisy: &Noisy<'_, T>,
        out: ClipMut<'_, T>,
        interrupt: &Interrupt,
    ) -> Result<(), Error>;
}

/// What steps take.
#[derive(Debug, Clone, Copy)]
pub(super) struct Arguments<'a, 'py> {
    pub(super) q: &'a Bound<'py, PyAny>,
    pub(super) pilot: &'a Bound<'py, PyAny>,
    pub(super) confidence: Option<&'a Bound<'py, PyAny>>,
    pub(super) noise: &'a Bound<'py, PyAny>,
}

/// Rotations `(frames, joints, 4)`: the estimate, improved.
pub(super) fn improved(
    py: Python<'_>,
    step: &impl Step,
    arguments: Arguments<'_, '_>,
) -> PyResult<Py<PyAny>> {
    let Arguments { q, pilot, confidence, noise } = arguments;
    let noise = input::<f64>("noise", noise)?;
    let noise = elements("noise", &noise)?;
    by_dtype!(q, T => {
        let (q, pilot) = (input::<T>("q", q)?, input::<T>("pilot", pilot)?);
        let confidence = confidence.map(|array| input::<T>("confidence", array)).transpose()?;
        let confidence = confidence.as_ref().map(|array| elements("confidence", array)).transpose()?;
        let out = output::<T>(py, q.shape());
        {
            let noisy = Noisy { clip: clip("q", &q)?, pilot: clip("pilot", &pilot)?, confidence, noise };
            let (frames, joints) = (noisy.clip.frames(), noisy.clip.joints());
            let mut out = out.readwrite();
            let out = clip_mut(&mut out, frames, joints)?;
            run_interruptible(py, step.nanoseconds(frames, joints), |interrupt| step.run(&noisy, out, interrupt))?;
        }
        Ok(out.into_any().unbind())
    })
}
