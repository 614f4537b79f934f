//! Low rank in bands of frequencies.

use crate::array::{by_dtype, clip, clip_mut, elements, input, output, run_interruptible};
use numpy::{PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use quatfilt_core::filters::smooth as core;
use quatfilt_core::filters::smooth::Noisy;

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
            run_interruptible(py, frames * joints * joints * NANOSECONDS, |interrupt| {
                core::smooth_rank(&noisy, out, interrupt)
            })?;
        }
        Ok(out.into_any().unbind())
    })
}

/// Estimated nanoseconds per frame, joint and joint.
const NANOSECONDS: usize = 60;
