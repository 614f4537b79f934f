//! Shared code of principal geodesics of joints and of whole poses.

use crate::array::{clip, elements, input, output, run_interruptible};
use crate::filters::names::named;
use numpy::{Element, PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use quatfilt_core::geodesics::pga::{Objective, Params};
use quatfilt_core::parallel::Interrupt;
use quatfilt_core::{ClipView, Error, Real};

/// The arguments of a fit after its arrays: components, most, objective and tolerance.
pub(super) fn params(components: usize, most: usize, objective: &str, tolerance: f64) -> PyResult<Params> {
    let objective = named(
        "objective",
        objective,
        &[
            ("geodesic", Objective::Geodesic),
            ("squared", Objective::Squared),
            ("chordal", Objective::Chordal),
        ],
    )?;
    Ok(Params { components, most, objective, tolerance })
}

/// An array of numbers, rounded to its dtype.
pub(super) fn array<T: Real + Element>(
    py: Python<'_>,
    shape: &[usize],
    numbers: impl Iterator<Item = f64>,
) -> PyResult<Py<PyAny>> {
    let out: Bound<'_, PyArrayDyn<T>> = output(py, shape);
    for (out, number) in out.readwrite().as_slice_mut()?.iter_mut().zip(numbers) {
        *out = T::from_f64(number);
    }
    Ok(out.into_any().unbind())
}

/// Descents `(…, steps)`, with the leading axes in `shape`; shorter ones are padded with NaN.
pub(super) fn descents<'a, T: Real + Element>(
    py: Python<'_>,
    shape: &[usize],
    descents: impl Iterator<Item = &'a [f64]> + Clone,
) -> PyResult<Py<PyAny>> {
    let steps = descents.clone().map(<[f64]>::len).max().unwrap_or(0);
    let padded = descents.flat_map(|descent| {
        descent.iter().copied().chain(std::iter::repeat_n(f64::NAN, steps - descent.len()))
    });
    array::<T>(py, &[shape, &[steps]].concat(), padded)
}

/// The parameters of rotations: the output of `kernel`, an array of the `shape` for frames, joints and `k`.
pub(super) fn scores<T: Real + Element>(
    py: Python<'_>,
    (q, means, directions): (&Bound<'_, PyAny>, &Bound<'_, PyAny>, &Bound<'_, PyAny>),
    shape: impl FnOnce(usize, usize, usize) -> Vec<usize>,
    nanoseconds: usize,
    kernel: impl FnOnce(ClipView<'_, T>, [&[T]; 2], &mut [T], &Interrupt) -> Result<(), Error> + Send,
) -> PyResult<Py<PyAny>> {
    let (q, means) = (input::<T>("q", q)?, input::<T>("means", means)?);
    let directions = input::<T>("directions", directions)?;
    let k = directions.shape().first().copied().unwrap_or(0);
    let q = clip("q", &q)?;
    let out = output::<T>(py, &shape(q.frames(), q.joints(), k));
    {
        let mut out = out.readwrite();
        let out = out.as_slice_mut()?;
        let geodesics = [elements("means", &means)?, elements("directions", &directions)?];
        let work = q.data().len() / 4 * k * nanoseconds;
        run_interruptible(py, work, |interrupt| kernel(q, geodesics, out, interrupt))?;
    }
    Ok(out.into_any().unbind())
}

/// Rotations `(frames, joints, 4)` from parameters whose first axis are frames: the output of `kernel`.
pub(super) fn product<T: Real + Element>(
    py: Python<'_>,
    (scores, means, directions): (&Bound<'_, PyAny>, &Bound<'_, PyAny>, &Bound<'_, PyAny>),
    nanoseconds: usize,
    kernel: impl FnOnce(&[T], [&[T]; 2], &mut [T], &Interrupt) -> Result<(), Error> + Send,
) -> PyResult<Py<PyAny>> {
    let (scores, means) = (input::<T>("scores", scores)?, input::<T>("means", means)?);
    let directions = input::<T>("directions", directions)?;
    let (Some(&frames), Some(&joints)) = (scores.shape().first(), means.shape().first()) else {
        return Err(PyValueError::new_err("scores, means: expected arrays with axes"));
    };
    let out = output::<T>(py, &[frames, joints, 4]);
    {
        let mut out = out.readwrite();
        let out = out.as_slice_mut()?;
        let scores = elements("scores", &scores)?;
        let geodesics = [elements("means", &means)?, elements("directions", &directions)?];
        let k = directions.shape().first().copied().unwrap_or(0);
        let work = (frames * joints).saturating_mul((k + 1) * nanoseconds);
        run_interruptible(py, work, |interrupt| kernel(scores, geodesics, out, interrupt))?;
    }
    Ok(out.into_any().unbind())
}
