//! NumPy arrays as input and output, and calls of the core.

use numpy::{
    Element, PyArrayDescrMethods, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyReadwriteArrayDyn,
    PyUntypedArray, PyUntypedArrayMethods,
};
use pyo3::exceptions::{PyKeyboardInterrupt, PyRuntimeError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use quatfilt_core::parallel::Interrupt;
use quatfilt_core::{ClipMut, ClipView, Error, Real};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::RecvTimeoutError;
use std::time::Duration;

/// Calls `$body` with `$T` standing for the dtype of the array `$array`, float32 or float64.
macro_rules! by_dtype {
    ($array:expr, $T:ident => $body:expr) => {
        if $crate::array::is_float32($array)? {
            type $T = f32;
            $body
        } else {
            type $T = f64;
            $body
        }
    };
}
pub(crate) use by_dtype;

/// Whether `array` is float32; [`input`] rejects dtypes other than the two floats.
pub(crate) fn is_float32(array: &Bound<'_, PyAny>) -> PyResult<bool> {
    let array = array.cast::<PyUntypedArray>()?;
    Ok(array.dtype().is_equiv_to(&numpy::dtype::<f32>(array.py())))
}

/// Borrows an array; validation in Python has made it C-contiguous, aligned and native.
pub(crate) fn input<'py, T: Element>(
    name: &str,
    array: &Bound<'py, PyAny>,
) -> PyResult<PyReadonlyArrayDyn<'py, T>> {
    let array = array.cast::<PyArrayDyn<T>>().map_err(|_| {
        PyTypeError::new_err(format!("{name}: the dtype differs from that of the other arrays"))
    })?;
    array
        .try_readonly()
        .map_err(|_| PyValueError::new_err(format!("{name}: the array is being written elsewhere")))
}

/// The elements of a borrowed array.
pub(crate) fn elements<'a, T: Element>(
    name: &str,
    array: &'a PyReadonlyArrayDyn<'_, T>,
) -> PyResult<&'a [T]> {
    // `as_slice` would accept a column-major array too.
    let slice = if array.is_c_contiguous() { array.as_slice().ok() } else { None };
    slice.ok_or_else(|| PyValueError::new_err(format!("{name}: expected a C-contiguous array")))
}

/// A copy of an array of float64.
pub(crate) fn numbers(name: &str, array: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    let array = input::<f64>(name, array)?;
    Ok(elements(name, &array)?.to_vec())
}

/// A borrowed clip `(frames, joints, 4)`.
pub(crate) fn clip<'a, T: Real + Element>(
    name: &str,
    array: &'a PyReadonlyArrayDyn<'_, T>,
) -> PyResult<ClipView<'a, T>> {
    let &[frames, joints, 4] = array.shape() else {
        return Err(PyValueError::new_err(format!(
            "{name}: expected shape (frames, joints, 4), got {:?}",
            array.shape()
        )));
    };
    ClipView::new(elements(name, array)?, frames, joints).map_err(to_python)
}

/// A borrowed clip `(frames, joints, 4)` to be written.
pub(crate) fn clip_mut<'a, T: Real + Element>(
    array: &'a mut PyReadwriteArrayDyn<'_, T>,
    frames: usize,
    joints: usize,
) -> PyResult<ClipMut<'a, T>> {
    ClipMut::new(array.as_slice_mut()?, frames, joints).map_err(to_python)
}

/// A fresh array, owned by NumPy.
pub(crate) fn output<'py, T: Element>(py: Python<'py>, shape: &[usize]) -> Bound<'py, PyArrayDyn<T>> {
    PyArrayDyn::zeros(py, shape, false)
}

/// Message of the exception after a panic in a kernel.
pub(crate) const BUG: &str = "quatfilt: a kernel failed; please report this as a bug";

/// Runs `work` detached from the interpreter; errors and panics become Python exceptions.
pub(crate) fn run<R: Send>(py: Python<'_>, work: impl FnOnce() -> Result<R, Error> + Send) -> PyResult<R> {
    match py.detach(|| catch_unwind(AssertUnwindSafe(work))) {
        Ok(result) => result.map_err(to_python),
        Err(_) => Err(PyRuntimeError::new_err(BUG)),
    }
}

/// The Python exception for an error of the core.
pub(crate) fn to_python(error: Error) -> PyErr {
    match error {
        Error::Interrupted => PyKeyboardInterrupt::new_err(()),
        other => PyValueError::new_err(other.to_string()),
    }
}

/// Estimated nanoseconds from which a call checks for Ctrl-C: the thread for it costs some 50 microseconds.
const PATIENCE: usize = 200_000_000;

/// Interval of the checks for Ctrl-C in a long call.
const POLL: Duration = Duration::from_millis(50);

/// Runs `work` as [`run`] does; work with a long estimated time stops at its next tile after Ctrl-C.
pub(crate) fn run_interruptible<R: Send>(
    py: Python<'_>,
    nanoseconds: usize,
    work: impl FnOnce(&Interrupt) -> Result<R, Error> + Send,
) -> PyResult<R> {
    let interrupt = Interrupt::new();
    if nanoseconds < PATIENCE {
        return run(py, || work(&interrupt));
    }
    let mut signal = Ok(());
    let result = py.detach(|| {
        std::thread::scope(|scope| {
            let (done, finished) = std::sync::mpsc::channel();
            let interrupt = &interrupt;
            let worker = scope.spawn(move || {
                let result = catch_unwind(AssertUnwindSafe(|| work(interrupt)));
                // The receiver lives until the scope ends.
                let _ = done.send(());
                result
            });
            while let Err(RecvTimeoutError::Timeout) = finished.recv_timeout(POLL) {
                if signal.is_ok() {
                    signal = Python::attach(|py: Python<'_>| py.check_signals());
                    if signal.is_err() {
                        interrupt.set();
                    }
                }
            }
            worker.join()
        })
    });
    signal?;
    match result {
        Ok(Ok(result)) => result.map_err(to_python),
        _ => Err(PyRuntimeError::new_err(BUG)),
    }
}
