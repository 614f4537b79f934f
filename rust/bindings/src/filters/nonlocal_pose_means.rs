//! Non-local pose means.

use super::names::{self, named};
use crate::array::{by_dtype, elements, input, output, run_interruptible};
use crate::search::patch_neighbors::clips;
use numpy::{Element, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use quatfilt_core::filters::nonlocal_pose_means::{Chart, Distance, NonlocalPoseMeans, Translation, Weights};
use quatfilt_core::{ClipMut, ClipView, Real};

/// Filters rotations `(frames, joints, 4)` and, with the same weights, a translation `(frames, 3)`.
///
/// −1 means the whole clip (`search_radius`), all candidates (`neighbors`) and no limit (`lookahead`).
#[pyfunction]
#[pyo3(signature = (q, translation, confidence, bandwidth, search_radius, patch_radius, distance, weights, neighbors, chart, boundary, lookahead, library, lengths, /))]
#[allow(clippy::needless_pass_by_value, reason = "PyO3 makes a list into a vector")]
#[allow(clippy::too_many_arguments, reason = "the reference's positional arguments")]
pub(crate) fn nonlocal_pose_means(
    py: Python<'_>,
    q: &Bound<'_, PyAny>,
    translation: Option<&Bound<'_, PyAny>>,
    confidence: Option<&Bound<'_, PyAny>>,
    bandwidth: &Bound<'_, PyAny>,
    search_radius: i64,
    patch_radius: usize,
    distance: &str,
    weights: &str,
    neighbors: i64,
    chart: &str,
    boundary: &str,
    lookahead: i64,
    library: Option<&Bound<'_, PyAny>>,
    lengths: Vec<usize>,
) -> PyResult<(Py<PyAny>, Option<Py<PyAny>>)> {
    let filter = filter(
        bandwidth,
        search_radius,
        patch_radius,
        distance,
        weights,
        neighbors,
        chart,
        boundary,
        lookahead,
    )?;
    by_dtype!(q, T => typed::<T>(py, &filter, q, translation, confidence, library, &lengths))
}

/// The filter with these positional arguments.
#[allow(clippy::too_many_arguments, reason = "the reference's positional arguments")]
pub(super) fn filter(
    bandwidth: &Bound<'_, PyAny>,
    search_radius: i64,
    patch_radius: usize,
    distance: &str,
    weights: &str,
    neighbors: i64,
    chart: &str,
    boundary: &str,
    lookahead: i64,
) -> PyResult<NonlocalPoseMeans> {
    let bandwidth = input::<f64>("bandwidth", bandwidth)?;
    Ok(NonlocalPoseMeans {
        search_radius: usize::try_from(search_radius).ok(),
        patch_radius,
        bandwidth: elements("bandwidth", &bandwidth)?.to_vec(),
        distance: named("distance", distance, &[("mean", Distance::Mean), ("sum", Distance::Sum)])?,
        weights: named("weights", weights, &[("pose", Weights::Pose), ("joint", Weights::Joint)])?,
        neighbors: usize::try_from(neighbors).ok(),
        chart: named(
            "chart",
            chart,
            &[("mean", Chart::Mean), ("identity", Chart::Identity), ("local", Chart::Local)],
        )?,
        boundary: names::boundary(boundary)?,
        lookahead: usize::try_from(lookahead).ok(),
    })
}

fn typed<T: Real + Element>(
    py: Python<'_>,
    filter: &NonlocalPoseMeans,
    q: &Bound<'_, PyAny>,
    translation: Option<&Bound<'_, PyAny>>,
    confidence: Option<&Bound<'_, PyAny>>,
    library: Option<&Bound<'_, PyAny>>,
    lengths: &[usize],
) -> PyResult<(Py<PyAny>, Option<Py<PyAny>>)> {
    let q = input::<T>("q", q)?;
    let translation = translation.map(|array| input::<T>("translation", array)).transpose()?;
    let confidence = confidence.map(|array| input::<T>("confidence", array)).transpose()?;
    let library = library.map(|array| input::<T>("library", array)).transpose()?;
    let (frames, joints) = (q.shape()[0], q.shape()[1]);
    let out = output::<T>(py, q.shape());
    let moved_out = translation.as_ref().map(|translation| output::<T>(py, translation.shape()));
    {
        let q = elements("q", &q)?;
        let values = translation.as_ref().map(|array| elements("translation", array)).transpose()?;
        let confidence = confidence.as_ref().map(|array| elements("confidence", array)).transpose()?;
        let mut out = out.readwrite();
        let out = out.as_slice_mut()?;
        let mut moved_out = moved_out.as_ref().map(PyArrayMethods::readwrite);
        let moved_out = moved_out.as_mut().map(|array| array.as_slice_mut()).transpose()?;
        let scenes = library.as_ref().map(|array| clips("library", array, lengths)).transpose()?;
        let others: usize = lengths.iter().sum();
        let window = others / 8 + filter.search_radius.map_or(frames, |radius| radius.min(frames));
        run_interruptible(py, q.len() * window, |interrupt| {
            let translation = values.zip(moved_out).map(|(values, out)| Translation { values, out });
            let out = ClipMut::new(out, frames, joints)?;
            let clip = ClipView::new(q, frames, joints)?;
            filter.filter(clip, scenes.as_deref(), confidence, translation, out, interrupt)
        })?;
    }
    Ok((out.into_any().unbind(), moved_out.map(|array| array.into_any().unbind())))
}
