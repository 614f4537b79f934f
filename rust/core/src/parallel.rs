//! The thread pool: one per process, built on first use, and rebuilt in a child after `fork`.
//!
//! Rayon's global pool does not survive `fork()`: a child would wait for threads that do not exist. So the pool is
//! stored in a cell keyed by the process id; a child leaves the parent's pool alone and builds a new one.
//!
//! Work is split into tiles whose borders do not depend on the number of threads. Each tile writes its own slice, and
//! totals are summed in the order of the tiles: results are the same for every number of threads.

use crate::Error;
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, TryLockError};
use std::time::{Duration, Instant};

/// Estimated nanoseconds below which the calling thread does the work alone. Waking a pool costs ten microseconds on
/// a quiet machine and a hundred on a busy one, and two threads save at most half of the work.
const SERIAL_NANOSECONDS: usize = 200_000;

/// Time to wait for the pool's cell before working alone. A cell that stays locked was copied by a `fork` while
/// another thread held it, and will never be unlocked.
const LOCK_PATIENCE: Duration = Duration::from_millis(200);

struct Pool {
    process: u32,
    threads: usize,
    workers: Arc<rayon::ThreadPool>,
}

static POOL: Mutex<Option<Pool>> = Mutex::new(None);

/// Number of threads of the last [`set_num_threads`]; 0: never called.
static REQUESTED: AtomicUsize = AtomicUsize::new(0);

/// Sets the number of threads that kernels use from now on; 0 returns to the default.
pub fn set_num_threads(threads: usize) {
    REQUESTED.store(threads, Ordering::Relaxed);
}

/// The number of threads that kernels use: that of [`set_num_threads`], else `QUATFILT_NUM_THREADS`, else
/// `RAYON_NUM_THREADS`, else the number of processors available to this process.
#[must_use]
pub fn num_threads() -> usize {
    let requested = REQUESTED.load(Ordering::Relaxed);
    if requested > 0 {
        return requested;
    }
    ["QUATFILT_NUM_THREADS", "RAYON_NUM_THREADS"]
        .into_iter()
        .find_map(|name| std::env::var(name).ok()?.trim().parse().ok().filter(|&n: &usize| n > 0))
        .unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from))
}

/// The pool of this process with the requested number of threads, or `None` to work alone.
fn pool() -> Option<Arc<rayon::ThreadPool>> {
    let threads = num_threads();
    if threads < 2 {
        return None;
    }
    let process = std::process::id();
    let deadline = Instant::now() + LOCK_PATIENCE;
    let mut cell = loop {
        match POOL.try_lock() {
            Ok(cell) => break cell,
            Err(TryLockError::Poisoned(poisoned)) => break poisoned.into_inner(),
            Err(TryLockError::WouldBlock) if Instant::now() < deadline => std::thread::yield_now(),
            Err(TryLockError::WouldBlock) => return None,
        }
    };
    if let Some(held) = cell.as_ref()
        && held.process == process
        && held.threads == threads
    {
        return Some(Arc::clone(&held.workers));
    }
    let built = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .thread_name(|index| format!("quatfilt-{index}"))
        .build()
        .ok()?;
    let workers = Arc::new(built);
    let before = cell.replace(Pool { process, threads, workers: Arc::clone(&workers) });
    if let Some(before) = before
        && before.process != process
    {
        // Its threads exist in the parent only: dropping it would wait for them forever.
        std::mem::forget(before);
    }
    Some(workers)
}

/// An interrupt flag: kernels check it and stop.
#[derive(Debug, Default)]
pub struct Interrupt(AtomicBool);

impl Interrupt {
    /// A flag that is not set.
    #[must_use]
    pub const fn new() -> Self {
        Self(AtomicBool::new(false))
    }

    /// Sets the flag: the kernel stops at its next tile.
    pub fn set(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Checks the flag.
    ///
    /// # Errors
    /// [`Error::Interrupted`] if it is set.
    pub fn check(&self) -> Result<(), Error> {
        if self.0.load(Ordering::Relaxed) { Err(Error::Interrupted) } else { Ok(()) }
    }
}

/// Runs `work(tile, item)` for every item; on the pool unless the estimated time is too short.
///
/// `nanoseconds` is the estimate for all items together, on one thread.
///
/// # Errors
/// The first error in the order of the tiles; tiles after an error may not have run.
pub fn for_each<I: Send>(
    items: Vec<I>,
    nanoseconds: usize,
    work: impl Fn(usize, I) -> Result<(), Error> + Sync + Send,
) -> Result<(), Error> {
    map(items, nanoseconds, work).map(|_| ())
}

/// As [`for_each`]; returns the results of `work` in the order of the items.
///
/// # Errors
/// The first error in the order of the items.
pub fn map<I: Send, R: Send>(
    items: Vec<I>,
    nanoseconds: usize,
    work: impl Fn(usize, I) -> Result<R, Error> + Sync + Send,
) -> Result<Vec<R>, Error> {
    let alone = items.len() < 2 || nanoseconds < SERIAL_NANOSECONDS;
    match if alone { None } else { pool() } {
        Some(pool) => pool.install(|| {
            let results: Vec<Result<R, Error>> =
                items.into_par_iter().enumerate().with_max_len(1).map(|(i, item)| work(i, item)).collect();
            results.into_iter().collect()
        }),
        None => items.into_iter().enumerate().map(|(i, item)| work(i, item)).collect(),
    }
}

/// Runs `work` inside the pool of this process, so that its rayon calls use the pool's threads; runs it directly if
/// there is only one thread.
pub fn install<R: Send>(work: impl FnOnce() -> R + Send) -> R {
    match pool() {
        Some(pool) => pool.install(work),
        None => work(),
    }
}
