//! Pose search.

use crate::array::{by_dtype, elements, input, output, run_interruptible, to_python};
use numpy::{Element, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use quatfilt_core::Real;
use quatfilt_core::search::poses::along::Along;
use quatfilt_core::search::poses::graph::{self, Apart, Graph, Neighbors};
use quatfilt_core::search::poses::walk::{Database, Fallback, Walk};
use quatfilt_core::search::poses::{self, Index, Layout, Nearest, Segments};
use std::ops::Range;
use std::sync::Arc;

/// The `k` segments of `features`, `(poses, dims)`, nearest to each of `queries`, `(queries, length, dims)`: numbers of their
/// last poses, and distances, `(queries, k)`. `excluded`, `(queries, 2)`, are first numbers that do not count, and first that do
/// again.
#[pyfunction]
#[pyo3(signature = (features, starts, queries, k, successors, excluded, /))]
pub(crate) fn nearest_segments(
    py: Python<'_>,
    features: &Bound<'_, PyAny>,
    starts: &Bound<'_, PyAny>,
    queries: &Bound<'_, PyAny>,
    k: usize,
    successors: usize,
    excluded: Option<&Bound<'_, PyAny>>,
) -> PyResult<(Py<PyAny>, Py<PyAny>)> {
    let starts = numbers("starts", starts)?;
    let excluded = excluded.map(|pairs| numbers("excluded", pairs)).transpose()?;
    let excluded: Option<Vec<Range<usize>>> =
        excluded.map(|pairs| pairs.chunks_exact(2).map(|pair| pair[0]..pair[1]).collect());
    by_dtype!(features, T => {
        let features = input::<T>("features", features)?;
        let queries = input::<T>("queries", queries)?;
        let &[number, length, dims] = queries.shape() else {
            return Err(PyValueError::new_err("queries: expected shape (queries, length, dims)"));
        };
        let segments = segments(&features, &starts, length, successors)?;
        if segments.dims() != dims {
            return Err(PyValueError::new_err("queries: expected poses as in features"));
        }
        let queries = elements("queries", &queries)?;
        let (indices, distances) = (output::<i64>(py, &[number, k]), output::<T>(py, &[number, k]));
        {
            let (mut indices, mut distances) = (indices.readwrite(), distances.readwrite());
            let out = Nearest {
                count: k,
                indices: indices.as_slice_mut()?,
                distances: distances.as_slice_mut()?,
            };
            let work = segments.candidates().saturating_mul(number).saturating_mul(length * dims) / 16;
            run_interruptible(py, work, |interrupt| {
                poses::nearest(&segments, None, queries, excluded.as_deref(), out, interrupt)
            })?;
        }
        Ok((indices.into_any().unbind(), distances.into_any().unbind()))
    })
}

/// The `degree` segments of `length` poses nearest to each segment, and their distances, `(poses, degree)`.
#[pyfunction]
#[pyo3(signature = (features, starts, degree, length, successors, exclusion, spacing, /))]
#[allow(clippy::too_many_arguments, reason = "the reference's positional arguments")]
pub(crate) fn neighbor_graph(
    py: Python<'_>,
    features: &Bound<'_, PyAny>,
    starts: &Bound<'_, PyAny>,
    degree: usize,
    length: usize,
    successors: usize,
    exclusion: usize,
    spacing: usize,
) -> PyResult<(Py<PyAny>, Py<PyAny>)> {
    let starts = numbers("starts", starts)?;
    by_dtype!(features, T => {
        let features = input::<T>("features", features)?;
        let segments = segments(&features, &starts, length, successors)?;
        let shape = [segments.poses(), degree];
        let (indices, distances) = (output::<i32>(py, &shape), output::<T>(py, &shape));
        {
            let (mut indices, mut distances) = (indices.readwrite(), distances.readwrite());
            let out = Neighbors {
                degree,
                indices: indices.as_slice_mut()?,
                distances: distances.as_slice_mut()?,
            };
            let work = segments.candidates().saturating_mul(segments.candidates());
            run_interruptible(py, work, |interrupt| {
                let index = Index::new(&segments, interrupt)?;
                graph::neighbors(&segments, &index, Apart { exclusion, spacing }, out, interrupt)
            })?;
        }
        Ok((indices.into_any().unbind(), distances.into_any().unbind()))
    })
}

/// A search along a motion, with what it keeps from frame to frame.
#[pyclass(module = "quatfilt._core")]
pub(crate) struct SegmentWalk {
    inner: Inner,
    features: Py<PyAny>,
    graph: Option<Py<PyArrayDyn<i32>>>,
}

enum Inner {
    Float32(State<f32>),
    Float64(State<f64>),
}

struct State<T> {
    layout: Arc<Layout>,
    index: Index<T>,
    search: Search<T>,
    count: usize,
}

enum Search<T> {
    /// Along a graph.
    Walk(Walk<T>),
    /// Exact.
    Along(Along<T>),
}

/// A search along a motion for the `k` nearest segments, that starts with the next frame that is asked for; exact without a graph.
#[pyfunction]
#[pyo3(signature = (features, starts, graph, k, length, successors, breadth, refresh, ratio, /))]
#[allow(clippy::too_many_arguments, reason = "the reference's positional arguments")]
pub(crate) fn segment_walk(
    py: Python<'_>,
    features: &Bound<'_, PyAny>,
    starts: &Bound<'_, PyAny>,
    graph: Option<&Bound<'_, PyAny>>,
    k: usize,
    length: usize,
    successors: usize,
    breadth: usize,
    refresh: usize,
    ratio: f64,
) -> PyResult<SegmentWalk> {
    let starts = numbers("starts", starts)?;
    let along = graph.map(|_| (breadth, Fallback { frames: refresh, ratio }));
    let inner = if crate::array::is_float32(features)? {
        Inner::Float32(state(py, features, &starts, k, length, successors, along)?)
    } else {
        Inner::Float64(state(py, features, &starts, k, length, successors, along)?)
    };
    let graph = graph.map(Bound::cast::<PyArrayDyn<i32>>).transpose();
    let graph = graph.map_err(|_| PyValueError::new_err("graph: expected int32"))?;
    Ok(SegmentWalk {
        inner,
        features: features.clone().unbind(),
        graph: graph.map(|graph| graph.clone().unbind()),
    })
}

fn state<T: Real + Element>(
    py: Python<'_>,
    features: &Bound<'_, PyAny>,
    starts: &[usize],
    count: usize,
    length: usize,
    successors: usize,
    along: Option<(usize, Fallback)>,
) -> PyResult<State<T>> {
    let features = input::<T>("features", features)?;
    let segments = segments(&features, starts, length, successors)?;
    let work = segments.poses().saturating_mul(segments.dims());
    let index = run_interruptible(py, work, |interrupt| Index::new(&segments, interrupt))?;
    let search = match along {
        Some((breadth, fallback)) => Search::Walk(Walk::new(count, breadth, fallback)),
        None => Search::Along(Along::new(count)),
    };
    Ok(State { layout: Arc::clone(segments.layout()), index, search, count })
}

#[pymethods]
impl SegmentWalk {
    /// The segments nearest to `query`, `(length, dims)`, but for those from `first` to before `last`; and whether all were
    /// looked at.
    #[pyo3(signature = (query, first, last, /))]
    fn next(
        &mut self,
        py: Python<'_>,
        query: &Bound<'_, PyAny>,
        first: usize,
        last: usize,
    ) -> PyResult<(Py<PyAny>, Py<PyAny>, bool)> {
        let (features, graph) = (self.features.bind(py), self.graph.as_ref().map(|graph| graph.bind(py)));
        match &mut self.inner {
            Inner::Float32(state) => next(py, state, features, graph, query, &(first..last)),
            Inner::Float64(state) => next(py, state, features, graph, query, &(first..last)),
        }
    }

    /// Forgets the frames before.
    fn reset(&mut self) {
        match &mut self.inner {
            Inner::Float32(state) => state.search.reset(),
            Inner::Float64(state) => state.search.reset(),
        }
    }
}

impl<T: Real> Search<T> {
    fn reset(&mut self) {
        match self {
            Self::Walk(walk) => walk.reset(),
            Self::Along(along) => along.reset(),
        }
    }
}

fn next<T: Real + Element>(
    py: Python<'_>,
    state: &mut State<T>,
    features: &Bound<'_, PyAny>,
    graph: Option<&Bound<'_, PyArrayDyn<i32>>>,
    query: &Bound<'_, PyAny>,
    excluded: &Range<usize>,
) -> PyResult<(Py<PyAny>, Py<PyAny>, bool)> {
    let features = input::<T>("features", features)?;
    let query = input::<T>("query", query)?;
    let query = elements("query", &query)?;
    let segments = Segments::again(elements("features", &features)?, &state.layout).map_err(to_python)?;
    let index = &state.index;
    let (best, all) = match (&mut state.search, graph) {
        (Search::Along(along), _) => {
            let best = along.next(&segments, index, query, excluded).map_err(to_python)?;
            (best, query.iter().all(|x| x.is_finite()))
        }
        (Search::Walk(walk), Some(graph)) => {
            let neighbors = input::<i32>("graph", graph)?;
            let degree = neighbors.shape().last().copied().unwrap_or_default();
            let graph =
                Graph::new(elements("graph", &neighbors)?, segments.poses(), degree).map_err(to_python)?;
            let database = Database { segments: &segments, index, graph };
            walk.next(database, query, excluded).map_err(to_python)?
        }
        (Search::Walk(_), None) => return Err(PyValueError::new_err("graph: expected int32, got none")),
    };
    let (indices, distances) = (output::<i64>(py, &[state.count]), output::<T>(py, &[state.count]));
    best.write(indices.readwrite().as_slice_mut()?, distances.readwrite().as_slice_mut()?);
    Ok((indices.into_any().unbind(), distances.into_any().unbind(), all))
}

/// The segments of a borrowed matrix.
fn segments<'a, T: Real + Element>(
    features: &'a PyReadonlyArrayDyn<'_, T>,
    starts: &[usize],
    length: usize,
    successors: usize,
) -> PyResult<Segments<'a, T>> {
    let &[_, dims] = features.shape() else {
        return Err(PyValueError::new_err("features: expected shape (poses, dims)"));
    };
    Segments::new(elements("features", features)?, dims, starts, length, successors).map_err(to_python)
}

/// A copy of an array of int64, as numbers of poses.
fn numbers(name: &str, array: &Bound<'_, PyAny>) -> PyResult<Vec<usize>> {
    let array = input::<i64>(name, array)?;
    let numbers = elements(name, &array)?.iter().map(|&number| usize::try_from(number));
    numbers
        .collect::<Result<_, _>>()
        .map_err(|_| PyValueError::new_err(format!("{name}: expected numbers of at least 0")))
}
