//! The learned last step.

use crate::array::{by_dtype, clip, clip_mut, elements, input, output, run_interruptible, to_python};
use numpy::{PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use quatfilt_core::filters::smooth::{Network, Noisy, smooth_gains as corrected};

/// Estimated nanoseconds per rotation.
const NANOSECONDS: usize = 600;

/// Rotations `(frames, joints, 4)`: the pilot, corrected by vectors of several scales with gains from a network.
#[pyfunction]
#[pyo3(signature = (q, patches, pilot, confidence, noise, share, first, second, last, /))]
#[expect(clippy::too_many_arguments, reason = "the positional arguments of the reference")]
pub(crate) fn smooth_gains(
    py: Python<'_>,
    q: &Bound<'_, PyAny>,
    patches: &Bound<'_, PyAny>,
    pilot: &Bound<'_, PyAny>,
    confidence: Option<&Bound<'_, PyAny>>,
    noise: &Bound<'_, PyAny>,
    share: f64,
    first: &Bound<'_, PyAny>,
    second: &Bound<'_, PyAny>,
    last: &Bound<'_, PyAny>,
) -> PyResult<Py<PyAny>> {
    let noise = input::<f64>("noise", noise)?;
    let noise = elements("noise", &noise)?;
    let layers =
        [input::<f32>("first", first)?, input::<f32>("second", second)?, input::<f32>("last", last)?];
    let network = Network::new(
        elements("first", &layers[0])?,
        elements("second", &layers[1])?,
        elements("last", &layers[2])?,
    )
    .map_err(to_python)?;
    by_dtype!(q, T => {
        let (q, patches, pilot) =
            (input::<T>("q", q)?, input::<T>("patches", patches)?, input::<T>("pilot", pilot)?);
        let confidence = confidence.map(|array| input::<T>("confidence", array)).transpose()?;
        let confidence = confidence.as_ref().map(|array| elements("confidence", array)).transpose()?;
        let out = output::<T>(py, q.shape());
        {
            let noisy = Noisy { clip: clip("q", &q)?, pilot: clip("pilot", &pilot)?, confidence, noise };
            let patches = clip("patches", &patches)?;
            let (frames, joints) = (noisy.clip.frames(), noisy.clip.joints());
            let mut out = out.readwrite();
            let out = clip_mut(&mut out, frames, joints)?;
            run_interruptible(py, frames * joints * NANOSECONDS, |interrupt| {
                corrected(&noisy, patches, share, &network, out, interrupt)
            })?;
        }
        Ok(out.into_any().unbind())
    })
}
