//! Displaced runs: samples that jump away and jump back, beside calm motion.

use super::joint::Joint;
use super::jumps::Jumps;
use super::place::Place;
use crate::Error;
use crate::parallel::Interrupt;
use std::ops::Range;

/// A jump is longer than so many of the steps beside it. No body starts and stops within one frame.
const SHARP: f64 = 3.0;

/// Steps on either side of a run that are compared with its jumps, at least.
const CALM: usize = 4;

/// Neighbours are looked for among so many lengths of a run on either side, or of `CALM` frames.
const SURROUNDINGS: usize = 3;

impl<P: Place> Joint<P> {
    /// Adds the frames of displaced runs to `found`, which are not trusted.
    pub(super) fn displaced(
        &self,
        jumps: &mut Jumps,
        trusted: &mut [bool],
        found: &mut Vec<usize>,
        interrupt: &Interrupt,
    ) -> Result<(), Error> {
        if self.radius > self.longest {
            return Ok(());
        }
        if !found.is_empty() {
            for &frame in &*found {
                trusted[frame] = false;
            }
            for &frame in &*found {
                jumps.update(self, trusted, frame..frame + 2);
            }
        }
        let mut sides = (Vec::new(), Vec::new());
        for length in self.radius..=self.longest.min(self.path.len()) {
            interrupt.check()?;
            let displaced = |run: &Range<usize>| {
                self.doubt(run)
                    .is_some_and(|doubt| self.is_displaced(run, self.least(doubt), trusted, &mut sides))
            };
            let runs: Vec<Range<usize>> = jumps.runs(length).filter(displaced).collect();
            for run in &runs {
                trusted[run.clone()].fill(false);
            }
            for run in runs {
                jumps.update(self, trusted, run.start..run.end + 1);
                found.extend(run);
            }
        }
        Ok(())
    }

    /// Whether a run is displaced: its jumps are longer than `least`, than the steps beside it, and than the way across.
    fn is_displaced(
        &self,
        run: &Range<usize>,
        least: f64,
        trusted: &[bool],
        (earlier, later): &mut (Vec<usize>, Vec<usize>),
    ) -> bool {
        let path = &self.path;
        let steps = run.len().max(CALM);
        let reach = SURROUNDINGS * steps;
        earlier.clear();
        earlier.extend(
            (run.start.saturating_sub(reach)..run.start).rev().filter(|&t| trusted[t]).take(steps + 1),
        );
        later.clear();
        later.extend((run.end..(run.end + reach).min(path.len())).filter(|&t| trusted[t]).take(steps + 1));
        if earlier.len().min(later.len()) <= steps {
            return false;
        }
        let (before, after) = (earlier[0], later[0]);
        let jump = path[before].distance(path[run.start]).min(path[run.end - 1].distance(path[after]));
        let gap = (run.start - before).max(after + 1 - run.end) as f64;
        if jump <= least || jump <= path[before].distance(path[after]) {
            return false;
        }
        let step = |a: usize, b: usize| path[a].distance(path[b]) / a.abs_diff(b) as f64;
        let outside = earlier.windows(2).chain(later.windows(2)).map(|pair| step(pair[0], pair[1]));
        let inside = (run.start + 1..run.end).map(|t| step(t - 1, t));
        let pace = outside.chain(inside).fold(0.0, f64::max);
        let held = earlier.iter().all(|&t| path[t] == path[before])
            && later.iter().all(|&t| path[t] == path[after])
            && run.clone().all(|t| path[t] == path[run.start]);
        jump > SHARP * gap * pace && !(held && path[before] != path[after])
    }
}
