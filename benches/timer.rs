//! Criterion, at every SIMD level and with one thread and all.

use crate::clips::JOINTS;
use criterion::{Criterion, Throughput};
use quatfilt_core::parallel;
use quatfilt_core::simd::Level;
use std::time::Duration;

/// What a kernel runs on.
#[derive(Debug, Clone, Copy)]
struct Condition {
    level: Level,
    threads: usize,
}

impl Condition {
    fn best(threads: usize) -> Self {
        Self { level: Level::detected(), threads }
    }

    /// Each level with one thread, then the highest with all.
    fn all() -> Vec<Self> {
        let levels = Level::ALL.into_iter().filter(|&level| level <= Level::detected());
        levels.map(|level| Self { level, threads: 1 }).chain(Self::threads().into_iter().skip(1)).collect()
    }

    /// The highest level with one thread, and with all where there are more.
    fn threads() -> Vec<Self> {
        parallel::set_num_threads(0);
        let most = parallel::num_threads();
        if most > 1 { vec![Self::best(1), Self::best(most)] } else { vec![Self::best(1)] }
    }
}

/// Runs kernels under criterion; the throughput is in joint-frames.
pub struct Timer {
    criterion: Criterion,
    /// Whether to prove only that the benchmarks run.
    proving: bool,
}

impl Timer {
    /// A timer that obeys the command line of `cargo bench`.
    #[must_use]
    pub fn new() -> Self {
        let criterion = Criterion::default()
            .warm_up_time(Duration::from_millis(300))
            .measurement_time(Duration::from_secs(1))
            .sample_size(10)
            .configure_from_args();
        // Criterion's own rule: `cargo bench` passes --bench, `cargo test` does not.
        let given = |option| std::env::args().any(|argument| argument == option);
        Self { criterion, proving: given("--test") || !given("--bench") }
    }

    /// The sizes of clips `(frames, joints)`; one small size where the benchmarks are only proved to run.
    #[must_use]
    pub fn sizes(&self, frames: &[usize]) -> Vec<(usize, usize)> {
        let frames = if self.proving { &[100] } else { frames };
        frames.iter().map(|&frames| (frames, JOINTS)).collect()
    }

    /// Times `work` at every level with one thread, and at the highest with all threads.
    ///
    /// # Errors
    /// Those of `work`.
    pub fn levels<T, R, E>(
        &mut self,
        group: &str,
        size: (usize, usize),
        work: impl FnMut() -> Result<R, E>,
    ) -> Result<(), E> {
        self.run::<T, R, E>(group, size, &Condition::all(), work)
    }

    /// Times `work` at the highest level, with one thread and with all.
    ///
    /// # Errors
    /// Those of `work`.
    pub fn threads<T, R, E>(
        &mut self,
        group: &str,
        size: (usize, usize),
        work: impl FnMut() -> Result<R, E>,
    ) -> Result<(), E> {
        self.run::<T, R, E>(group, size, &Condition::threads(), work)
    }

    fn run<T, R, E>(
        &mut self,
        group: &str,
        (frames, joints): (usize, usize),
        conditions: &[Condition],
        mut work: impl FnMut() -> Result<R, E>,
    ) -> Result<(), E> {
        let mut group = self.criterion.benchmark_group(group);
        group.throughput(Throughput::Elements((frames * joints) as u64));
        for Condition { level, threads } in conditions {
            level.set();
            parallel::set_num_threads(*threads);
            // A kernel that refuses its input would be timed as a fast one.
            work()?;
            let dtype = std::any::type_name::<T>();
            let id = format!("{dtype}/{frames}x{joints}/{}/{threads}", level.name());
            group.bench_function(id, |bencher| bencher.iter(&mut work));
        }
        group.finish();
        Ok(())
    }
}

impl Default for Timer {
    fn default() -> Self {
        Self::new()
    }
}

impl Drop for Timer {
    fn drop(&mut self) {
        self.criterion.final_summary();
    }
}
