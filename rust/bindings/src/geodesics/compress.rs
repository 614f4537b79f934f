//! Compression to a tolerance.

use crate::array::{by_dtype, clip, clip_mut, elements, input, numbers, output, run_interruptible};
use numpy::{Element, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use quatfilt_core::geodesics::compress::{self as core, Compress, Stored};

/// Frames of principal geodesic coordinates, `(joints, 2, 2, 4)`.
#[pyfunction]
#[pyo3(signature = (q, /))]
pub(crate) fn principal_frames(py: Python<'_>, q: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
    by_dtype!(q, T => typed_frames::<T>(py, q))
}

fn typed_frames<T: Stored + Element>(py: Python<'_>, q: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
    let q = input::<T>("q", q)?;
    let clip = clip("q", &q)?;
    let nanoseconds = clip.joints() * clip.frames().min(1024) * 300;
    let frames = run_interruptible(py, nanoseconds, |interrupt| core::principal_frames(clip, interrupt))?;
    let out = output::<f64>(py, &[clip.joints(), 2, 2, 4]);
    out.readwrite().as_slice_mut()?.copy_from_slice(frames.as_flattened().as_flattened().as_flattened());
    Ok(out.into_any().unbind())
}

/// The stream of a clip `(frames, joints, 4)`, and the largest error.
#[pyfunction]
#[pyo3(signature = (q, frames, tolerance, quantised, /))]
pub(crate) fn compress(
    py: Python<'_>,
    q: &Bound<'_, PyAny>,
    frames: &Bound<'_, PyAny>,
    tolerance: &Bound<'_, PyAny>,
    quantised: bool,
) -> PyResult<(Py<PyBytes>, f64)> {
    let frames = input::<f64>("frames", frames)?;
    let (quaternions, []) = elements("frames", &frames)?.as_chunks::<4>() else {
        return Err(PyValueError::new_err("frames: expected shape (joints, 2, 2, 4)"));
    };
    let (pairs, []) = quaternions.as_chunks::<2>() else {
        return Err(PyValueError::new_err("frames: expected shape (joints, 2, 2, 4)"));
    };
    let (frames, []) = pairs.as_chunks::<2>() else {
        return Err(PyValueError::new_err("frames: expected shape (joints, 2, 2, 4)"));
    };
    let compress =
        Compress { frames: frames.to_vec(), tolerance: numbers("tolerance", tolerance)?, quantised };
    by_dtype!(q, T => typed::<T>(py, &compress, q))
}

fn typed<T: Stored + Element>(
    py: Python<'_>,
    compress: &Compress,
    q: &Bound<'_, PyAny>,
) -> PyResult<(Py<PyBytes>, f64)> {
    let q = input::<T>("q", q)?;
    let clip = clip("q", &q)?;
    let nanoseconds = clip.joints() * clip.frames() * 500;
    let (bytes, error) = run_interruptible(py, nanoseconds, |interrupt| compress.compress(clip, interrupt))?;
    Ok((PyBytes::new(py, &bytes).unbind(), error))
}

/// The decoded clip `(frames, joints, 4)` of a stream, float64 or float32.
#[pyfunction]
#[pyo3(signature = (data, frames, joints, double, /))]
pub(crate) fn decompress(
    py: Python<'_>,
    data: &[u8],
    frames: usize,
    joints: usize,
    double: bool,
) -> PyResult<Py<PyAny>> {
    if double {
        typed_back::<f64>(py, data, frames, joints)
    } else {
        typed_back::<f32>(py, data, frames, joints)
    }
}

fn typed_back<T: Stored + Element>(
    py: Python<'_>,
    data: &[u8],
    frames: usize,
    joints: usize,
) -> PyResult<Py<PyAny>> {
    let out = output::<T>(py, &[frames, joints, 4]);
    {
        let mut out = out.readwrite();
        let clip = clip_mut(&mut out, frames, joints)?;
        run_interruptible(py, frames * joints * 300, |interrupt| core::decompress(data, clip, interrupt))?;
    }
    Ok(out.into_any().unbind())
}
