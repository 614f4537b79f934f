//! How fast a motion changes: how far the patches around a patch are from it.

use super::diagonal::{Diagonal, Measure};
use super::features::Side;
use super::kernels;
use crate::parallel::{self, Interrupt};
use crate::{Error, Real};

/// Half widths of the blocks of diagonals that are passed over together: blocks of 81 hold three of 27, and so on down to 3.
pub(crate) const HALVES: [usize; 4] = [40, 13, 4, 1];

/// Frames by which planes must reach beyond patches for [`Spreads::new`].
pub(crate) const MARGIN: usize = HALVES[0];

/// Frames per task.
const TASK_FRAMES: usize = 1024;

/// For every frame and each of the [`HALVES`], the largest distance to the patches at most so many frames away.
#[derive(Debug)]
pub(crate) struct Spreads<T> {
    levels: [Vec<T>; HALVES.len()],
}

impl<T: Real> Spreads<T> {
    /// Measures the middles of a side and [`MARGIN`] more at both ends, up to which its planes must hold whole patches.
    pub(crate) fn new(
        measure: &Measure<T>,
        side: &Side<'_, T>,
        interrupt: &Interrupt,
    ) -> Result<Self, Error> {
        let (start, count) = (side.at - MARGIN, side.count + 2 * MARGIN);
        let mut levels: [Vec<T>; HALVES.len()] = std::array::from_fn(|_| vec![T::ZERO; count]);
        let mut parts = levels.each_mut().map(|level| level.chunks_mut(TASK_FRAMES));
        let tasks: Vec<[&mut [T]; HALVES.len()]> = (0..count.div_ceil(TASK_FRAMES))
            .map(|_| parts.each_mut().map(|part| part.next().unwrap_or_default()))
            .collect();
        let work = count * MARGIN * measure.joints.len() * 4;
        parallel::for_each(tasks, work, |task, mut levels| {
            interrupt.check()?;
            let from = task * TASK_FRAMES;
            let to = from + levels[0].len();
            let (mut diagonal, mut distances) = (Diagonal::default(), Vec::new());
            for lag in 1..=MARGIN {
                // Pairs that begin or end in the task's frames.
                let first = from.saturating_sub(lag);
                let last = to.min(count.saturating_sub(lag)).max(first);
                distances.resize(last - first, T::ZERO);
                let at = [start + first, start + first + lag];
                diagonal.measure(measure, &side.features, &side.features, at, &mut distances);
                let own = &distances[(from - first).min(distances.len())..];
                let ending = to.saturating_sub(lag).saturating_sub(first).min(distances.len());
                let (later, shift) = (&distances[..ending], first + lag - from);
                for (half, level) in HALVES.iter().zip(&mut levels) {
                    if lag <= *half {
                        kernels::keep_largest(&mut level[..own.len()], own);
                        kernels::keep_largest(&mut level[shift..shift + later.len()], later);
                    }
                }
            }
            Ok(())
        })?;
        Ok(Self { levels })
    }

    /// The spreads at a level, of the middles from `first − MARGIN + index`.
    pub(crate) fn level(&self, level: usize) -> &[T] {
        &self.levels[level]
    }
}
