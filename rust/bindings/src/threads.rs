//! Threads and SIMD level of the kernels.

use pyo3::prelude::*;
use quatfilt_core::{parallel, simd::Level};

/// Sets the number of threads; 0 returns to the default.
#[pyfunction]
#[pyo3(signature = (threads, /))]
pub(crate) fn set_num_threads(threads: usize) {
    parallel::set_num_threads(threads);
}

/// The number of threads that kernels use.
#[pyfunction]
pub(crate) fn get_num_threads() -> usize {
    parallel::num_threads()
}

/// The SIMD level that kernels run at.
#[pyfunction]
pub(crate) fn simd_level() -> &'static str {
    Level::current().name()
}

/// Whether this module was built without optimisation.
#[pyfunction]
pub(crate) const fn is_debug_build() -> bool {
    cfg!(debug_assertions)
}
