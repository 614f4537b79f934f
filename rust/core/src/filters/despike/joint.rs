//! One joint: its runs of samples, and which of them are spikes.

use super::jumps::Jumps;
use super::median::median;
use super::neighbours::{SURROUNDINGS, Sides};
use super::place::Place;
use crate::Error;
use crate::parallel::Interrupt;
use std::ops::Range;

/// A spike is farther away than the joint moves in so many frames.
const MOTION: f64 = 2.0;

/// How often the clip is looked at: for spikes, for those that they hid, and for what only seemed to be one beside them.
const LOOKS: usize = 3;

/// One joint, and what is a spike there.
pub(super) struct Joint<P> {
    pub(super) path: Vec<P>,
    pub(super) trust: Vec<f64>,
    pub(super) usual: f64,
    pub(super) smallest: f64,
    pub(super) radius: usize,
    pub(super) threshold: f64,
    pub(super) longest: usize,
}

impl<P: Place> Joint<P> {
    /// The frames of the spikes.
    pub(super) fn spikes(&self, interrupt: &Interrupt) -> Result<Vec<usize>, Error> {
        let mut found = Vec::new();
        for _ in 0..LOOKS {
            let seen = self.look(&found, interrupt)?;
            if seen == found {
                break;
            }
            found = seen;
        }
        Ok(found)
    }

    /// The frames of the spikes, given those that were found before; in order.
    fn look(&self, before: &[usize], interrupt: &Interrupt) -> Result<Vec<usize>, Error> {
        let mut trusted: Vec<bool> = self.trust.iter().map(|&trust| trust > 0.0).collect();
        for &frame in before {
            trusted[frame] = false;
        }
        let mut jumps = Jumps::of(self, &trusted);
        let mut found = Vec::new();
        if jumps.starts().is_empty() {
            return Ok(found);
        }
        let mut sides = Sides::default();
        for length in 1..self.radius.min(self.path.len()) {
            interrupt.check()?;
            for run in jumps.runs(length) {
                if let Some(doubt) = self.doubt(&run)
                    && self.is_spike(&run, doubt, &trusted, &mut sides, interrupt)?
                {
                    found.extend(run);
                }
            }
        }
        self.displaced(&mut jumps, &mut trusted, &mut found, interrupt)?;
        found.sort_unstable();
        found.dedup();
        Ok(found)
    }

    /// The largest confidence of a run; `None` if there is a sample of confidence 0.
    pub(super) fn doubt(&self, run: &Range<usize>) -> Option<f64> {
        let trust = &self.trust[run.clone()];
        trust.iter().all(|&trust| trust > 0.0).then(|| trust.iter().copied().fold(0.0, f64::max))
    }

    /// The least deviation of a spike, whatever is around it.
    pub(super) fn least(&self, doubt: f64) -> f64 {
        self.smallest.max(self.threshold * doubt * self.usual)
    }

    fn is_spike(
        &self,
        run: &Range<usize>,
        doubt: f64,
        trusted: &[bool],
        sides: &mut Sides,
        interrupt: &Interrupt,
    ) -> Result<bool, Error> {
        let Some(away) = self.deviation(run, trusted, sides) else { return Ok(false) };
        if away <= self.least(doubt) || away <= MOTION * self.pace(sides) {
            return Ok(false);
        }
        let reach = SURROUNDINGS * self.radius;
        let length = run.len();
        let before = run.start.saturating_sub(reach)..(run.start + 1).saturating_sub(length);
        let last = (run.start + reach + 1).min((self.path.len() + 1).saturating_sub(length));
        let mut around = Vec::with_capacity(2 * reach);
        for start in before.chain(run.end..last) {
            // With a radius of hundreds of frames the surroundings of one run take a second.
            interrupt.check()?;
            let other = start..start + length;
            if trusted[other.clone()].iter().all(|&trusted| trusted) {
                around.extend(self.deviation(&other, trusted, sides));
            }
        }
        Ok(away > self.threshold * doubt * median(&mut around))
    }
}
