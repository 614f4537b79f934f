//! Streams: the class of all streams, created by one function per filter.
//!
//! A push takes some ten microseconds. It does not detach: releasing and reacquiring the interpreter may take longer
//! than that, and another thread could push in between.

pub(crate) mod bilateral;
pub(crate) mod kalman;
pub(crate) mod nonlocal_pose_means;
pub(crate) mod one_euro;

use crate::array::{BUG, elements, input, output, to_python};
use numpy::PyArrayMethods;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use quatfilt_core::Error;
use quatfilt_core::filters::stream::PoseStream as Stream;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Mutex, MutexGuard, TryLockError};

/// A filter that processes poses one by one.
#[pyclass(frozen, module = "quatfilt._core")]
pub(crate) struct PoseStream(Mutex<Stream>);

impl PoseStream {
    fn new(stream: Result<Stream, Error>) -> PyResult<Self> {
        Ok(Self(Mutex::new(stream.map_err(to_python)?)))
    }

    /// The stream, unless it is in use: a signal handler during [`PoseStream::flush`] may call it again.
    fn lock(&self) -> PyResult<MutexGuard<'_, Stream>> {
        match self.0.try_lock() {
            Ok(stream) => Ok(stream),
            Err(TryLockError::WouldBlock) => {
                Err(PyRuntimeError::new_err("stream: expected one call at a time, got one during another"))
            }
            Err(TryLockError::Poisoned(_)) => Err(PyRuntimeError::new_err(BUG)),
        }
    }
}

#[pymethods]
impl PoseStream {
    /// Number of frames between a pose and its result.
    #[getter]
    fn latency(&self) -> PyResult<usize> {
        Ok(self.lock()?.latency())
    }

    /// Processes a pose `(joints, 4)` with confidences `(joints,)`; returns the pose of `latency` frames ago.
    #[pyo3(signature = (pose, confidence, /))]
    fn push(
        &self,
        py: Python<'_>,
        pose: &Bound<'_, PyAny>,
        confidence: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Option<Py<PyAny>>> {
        let pose = input::<f64>("pose", pose)?;
        let confidence = confidence.map(|array| input::<f64>("confidence", array)).transpose()?;
        let pose = elements("pose", &pose)?;
        let confidence = confidence.as_ref().map(|array| elements("confidence", array)).transpose()?;
        let mut stream = self.lock()?;
        let shape = [stream.joints(), 4];
        let Some(pose) = guarded(|| stream.push(pose, confidence))?.map_err(to_python)? else {
            return Ok(None);
        };
        let out = output::<f64>(py, &shape);
        out.readwrite().as_slice_mut()?.copy_from_slice(pose);
        Ok(Some(out.into_any().unbind()))
    }

    /// Ends the clip; returns the pending poses, `(n, joints, 4)`.
    #[pyo3(signature = (/))]
    fn flush(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        let mut stream = self.lock()?;
        let out = output::<f64>(py, &[stream.pending(), stream.joints(), 4]);
        {
            let mut out = out.readwrite();
            let mut rest = out.as_slice_mut()?;
            while let Some(pose) = guarded(|| stream.finish())? {
                let (row, after) = rest.split_at_mut(pose.len());
                row.copy_from_slice(pose);
                rest = after;
                py.check_signals()?;
            }
        }
        Ok(out.into_any().unbind())
    }
}

/// Runs `work`; a panic becomes a Python exception.
fn guarded<R>(work: impl FnOnce() -> R) -> PyResult<R> {
    catch_unwind(AssertUnwindSafe(work)).map_err(|_| PyRuntimeError::new_err(BUG))
}
