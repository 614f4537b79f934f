//! Patch search.

use crate::array::{by_dtype, clip, input, numbers, output, run_interruptible};
use numpy::{Element, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use quatfilt_core::search::patch_neighbors::PatchNeighbors;
use quatfilt_core::{ClipView, Real};

/// The `k` nearest patches of every frame of `q`, in `q` itself or in `library`, whose clips have `lengths` frames:
/// indices and distances, `(frames, k)`.
#[pyfunction]
#[pyo3(signature = (q, library, lengths, patch_radius, k, exclusion, weights, /))]
#[allow(clippy::needless_pass_by_value, reason = "PyO3 makes a list into a vector")]
#[allow(clippy::too_many_arguments, reason = "the reference's positional arguments")]
pub(crate) fn patch_neighbors(
    py: Python<'_>,
    q: &Bound<'_, PyAny>,
    library: Option<&Bound<'_, PyAny>>,
    lengths: Vec<usize>,
    patch_radius: usize,
    k: usize,
    exclusion: usize,
    weights: &Bound<'_, PyAny>,
) -> PyResult<(Py<PyAny>, Py<PyAny>)> {
    let search = PatchNeighbors { patch_radius, count: k, exclusion, weights: numbers("weights", weights)? };
    by_dtype!(q, T => typed::<T>(py, &search, q, library, &lengths))
}

fn typed<T: Real + Element>(
    py: Python<'_>,
    search: &PatchNeighbors,
    q: &Bound<'_, PyAny>,
    library: Option<&Bound<'_, PyAny>>,
    lengths: &[usize],
) -> PyResult<(Py<PyAny>, Py<PyAny>)> {
    let q = input::<T>("q", q)?;
    let library = library.map(|array| input::<T>("library", array)).transpose()?;
    let frames = q.shape()[0];
    let indices = output::<i64>(py, &[frames, search.count]);
    let distances = output::<T>(py, &[frames, search.count]);
    {
        let q = clip("q", &q)?;
        let scenes = library.as_ref().map(|array| clips("library", array, lengths)).transpose()?;
        let (mut indices, mut distances) = (indices.readwrite(), distances.readwrite());
        let (indices, distances) = (indices.as_slice_mut()?, distances.as_slice_mut()?);
        let candidates = scenes.as_ref().map_or(frames, |scenes| scenes.iter().map(ClipView::frames).sum());
        // A nanosecond for a pair of frames of eight joints.
        let work = (q.frames() * q.joints()).saturating_mul(candidates) / 8;
        run_interruptible(py, work, |interrupt| {
            search.search(q, scenes.as_deref(), indices, distances, interrupt)
        })?;
    }
    Ok((indices.into_any().unbind(), distances.into_any().unbind()))
}

/// Views of concatenated clips.
pub(crate) fn clips<'a, T: Real + Element>(
    name: &str,
    array: &'a PyReadonlyArrayDyn<'_, T>,
    lengths: &[usize],
) -> PyResult<Vec<ClipView<'a, T>>> {
    let all = clip(name, array)?;
    if lengths.iter().sum::<usize>() != all.frames() {
        return Err(PyValueError::new_err(format!("{name}: the lengths do not add up to the frames")));
    }
    let mut first = 0;
    Ok(lengths
        .iter()
        .map(|length| {
            first += length;
            all.slice(first - length, first)
        })
        .collect())
}
