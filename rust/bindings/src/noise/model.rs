//! What is known of noise besides its level.

use crate::array::{by_dtype, clip, elements, input, output, run, run_interruptible};
use numpy::PyArrayMethods;
use pyo3::prelude::*;
use quatfilt_core::noise::{along_time, axes as of_noise, colour, motion};

/// The noise level beside the speed of the motion, the median over the joints.
#[pyfunction]
#[pyo3(signature = (q, level, /))]
pub(crate) fn noise_over_motion(
    py: Python<'_>,
    q: &Bound<'_, PyAny>,
    level: &Bound<'_, PyAny>,
) -> PyResult<f64> {
    by_dtype!(q, T => {
        let (q, level) = (input::<T>("q", q)?, input::<T>("level", level)?);
        let (q, level) = (clip("q", &q)?, elements("level", &level)?);
        run(py, || motion::noise_over_motion(q, level))
    })
}

/// The variance of the noise of all joints at each frame, in units of its quiet part, `(frames)`.
#[pyfunction]
#[pyo3(signature = (q, level, /))]
pub(crate) fn noise_along_time(
    py: Python<'_>,
    q: &Bound<'_, PyAny>,
    level: &Bound<'_, PyAny>,
) -> PyResult<Py<PyAny>> {
    by_dtype!(q, T => {
        let (q, level) = (input::<T>("q", q)?, input::<T>("level", level)?);
        let (q, level) = (clip("q", &q)?, elements("level", &level)?);
        let out = output::<f64>(py, &[q.frames()]);
        {
            let mut out = out.readwrite();
            let out = out.as_slice_mut()?;
            run(py, || along_time::noise_along_time(q, level, out))?;
        }
        Ok(out.into_any().unbind())
    })
}

/// `ρ` of coloured noise, the same for all joints; 0 for white noise.
#[pyfunction]
#[pyo3(signature = (q, /))]
pub(crate) fn noise_colour(py: Python<'_>, q: &Bound<'_, PyAny>) -> PyResult<f64> {
    by_dtype!(q, T => {
        let q = input::<T>("q", q)?;
        let q = clip("q", &q)?;
        run(py, || colour::noise_colour(q))
    })
}

/// How large the noise is along its axes, `(joints, 3)`, and the axes, `(joints, 3, 3)`.
#[pyfunction]
#[pyo3(signature = (q, /))]
pub(crate) fn noise_axes(py: Python<'_>, q: &Bound<'_, PyAny>) -> PyResult<(Py<PyAny>, Py<PyAny>)> {
    by_dtype!(q, T => {
        let q = input::<T>("q", q)?;
        let q = clip("q", &q)?;
        let (spread, axes) = (output::<f64>(py, &[q.joints(), 3]), output::<f64>(py, &[q.joints(), 3, 3]));
        {
            let (mut a, mut b) = (spread.readwrite(), axes.readwrite());
            let (a, b) = (a.as_slice_mut()?, b.as_slice_mut()?);
            run_interruptible(py, q.data().len() * 100, |interrupt| of_noise::noise_axes(q, a, b, interrupt))?;
        }
        Ok((spread.into_any().unbind(), axes.into_any().unbind()))
    })
}
