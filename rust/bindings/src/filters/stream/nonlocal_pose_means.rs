//! Non-local pose means of a stream.

use super::PoseStream;
use crate::filters::nonlocal_pose_means::filter;
use pyo3::prelude::*;

/// A stream of poses with one joint per bandwidth; the arguments are those of `nonlocal_pose_means` after the arrays.
#[pyfunction]
#[pyo3(signature = (bandwidth, search_radius, patch_radius, distance, weights, neighbors, chart, boundary, lookahead, /))]
#[allow(clippy::too_many_arguments, reason = "the filter's positional arguments")]
pub(crate) fn nonlocal_pose_means_stream(
    bandwidth: &Bound<'_, PyAny>,
    search_radius: i64,
    patch_radius: usize,
    distance: &str,
    weights: &str,
    neighbors: i64,
    chart: &str,
    boundary: &str,
    lookahead: i64,
) -> PyResult<PoseStream> {
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
    PoseStream::new(filter.stream())
}
