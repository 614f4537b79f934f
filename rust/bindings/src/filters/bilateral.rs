//! The bilateral orientation filter.

use super::names::{self, named};
use crate::array::{by_dtype, clip, clip_mut, elements, input, output, run_interruptible};
use numpy::{Element, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use quatfilt_core::Real;
use quatfilt_core::filters::bilateral::{Bilateral, Kernel, Translation};

/// Filters rotations `(frames, joints, 4)` and, with the weights of the first joint, a translation `(frames, 3)`.
///
/// A `lookahead` of −1 means no limit.
#[pyfunction]
#[pyo3(signature = (q, translation, radius, sigma_time, sigma_angle, kernel, iterations, boundary, lookahead, /))]
#[allow(clippy::too_many_arguments, reason = "the reference's positional arguments")]
pub(crate) fn bilateral(
    py: Python<'_>,
    q: &Bound<'_, PyAny>,
    translation: Option<&Bound<'_, PyAny>>,
    radius: usize,
    sigma_time: f64,
    sigma_angle: &Bound<'_, PyAny>,
    kernel: &str,
    iterations: usize,
    boundary: &str,
    lookahead: i64,
) -> PyResult<(Py<PyAny>, Option<Py<PyAny>>)> {
    let filter = filter(radius, sigma_time, sigma_angle, kernel, iterations, boundary, lookahead)?;
    by_dtype!(q, T => typed::<T>(py, &filter, q, translation))
}

/// The filter with these positional arguments.
pub(super) fn filter(
    radius: usize,
    sigma_time: f64,
    sigma_angle: &Bound<'_, PyAny>,
    kernel: &str,
    iterations: usize,
    boundary: &str,
    lookahead: i64,
) -> PyResult<Bilateral> {
    let sigma_angle = input::<f64>("sigma_angle", sigma_angle)?;
    let kernels =
        [("gaussian", Kernel::Gaussian), ("printed", Kernel::Printed), ("classic", Kernel::Classic)];
    Ok(Bilateral {
        radius,
        sigma_time,
        sigma_angle: elements("sigma_angle", &sigma_angle)?.to_vec(),
        kernel: named("kernel", kernel, &kernels)?,
        iterations,
        boundary: names::boundary(boundary)?,
        lookahead: usize::try_from(lookahead).ok(),
    })
}

fn typed<T: Real + Element>(
    py: Python<'_>,
    filter: &Bilateral,
    q: &Bound<'_, PyAny>,
    translation: Option<&Bound<'_, PyAny>>,
) -> PyResult<(Py<PyAny>, Option<Py<PyAny>>)> {
    let q = input::<T>("q", q)?;
    let translation = translation.map(|array| input::<T>("translation", array)).transpose()?;
    let out = output::<T>(py, q.shape());
    let moved_out = translation.as_ref().map(|translation| output::<T>(py, translation.shape()));
    {
        let q = clip("q", &q)?;
        let values = translation.as_ref().map(|array| elements("translation", array)).transpose()?;
        let mut out = out.readwrite();
        let out = clip_mut(&mut out, q.frames(), q.joints())?;
        let mut moved_out = moved_out.as_ref().map(PyArrayMethods::readwrite);
        let moved_out = moved_out.as_mut().map(|array| array.as_slice_mut()).transpose()?;
        let nanoseconds = (q.data().len() * 5 * (1 + filter.radius)).saturating_mul(filter.iterations);
        run_interruptible(py, nanoseconds, |interrupt| {
            let translation = values.zip(moved_out).map(|(values, out)| Translation { values, out });
            filter.filter(q, translation, out, interrupt)
        })?;
    }
    Ok((out.into_any().unbind(), moved_out.map(|array| array.into_any().unbind())))
}
