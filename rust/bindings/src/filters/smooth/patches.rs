//! Groups of similar patches.

use crate::array::{by_dtype, clip, clip_mut, elements, input, output, run_interruptible};
use numpy::{PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use quatfilt_core::filters::smooth as core;
use quatfilt_core::filters::smooth::Noisy;

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
            run_interruptible(py, (frames * joints * NANOSECONDS).saturating_mul(rounds), |interrupt| {
                core::smooth_patches(&noisy, rounds, out, interrupt)
            })?;
        }
        Ok(out.into_any().unbind())
    })
}

/// Estimated nanoseconds per rotation of a round.
const NANOSECONDS: usize = 2500;
