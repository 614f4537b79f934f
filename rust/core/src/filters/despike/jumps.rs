//! Jumps: where runs can start and end.

use super::joint::Joint;
use super::place::{Place, SLACK};
use std::ops::Range;

/// The frames of one joint at which a run can start or end: those farther than the least deviation of a spike from the nearest
/// trusted sample beyond.
pub(super) struct Jumps {
    into: Vec<bool>,
    out: Vec<bool>,
    starts: Vec<usize>,
    bound: f64,
}

impl Jumps {
    pub(super) fn of<P: Place>(joint: &Joint<P>, trusted: &[bool]) -> Self {
        let frames = joint.path.len();
        let doubt = joint.trust.iter().copied().filter(|&trust| trust > 0.0).fold(1.0, f64::min);
        let bound = P::nearness_at(joint.least(doubt)) * (1.0 - SLACK);
        let mut jumps =
            Self { into: vec![false; frames], out: vec![false; frames], starts: Vec::new(), bound };
        jumps.update(joint, trusted, 0..frames);
        jumps
    }

    /// The frames at which runs start, each once.
    pub(super) fn starts(&self) -> &[usize] {
        &self.starts
    }

    /// The runs of a length that a jump leads into and another one out of.
    pub(super) fn runs(&self, length: usize) -> impl Iterator<Item = Range<usize>> {
        let ends = move |&start: &usize| self.out.get(start + length) == Some(&true);
        self.starts.iter().copied().filter(ends).map(move |start| start..start + length)
    }

    /// Looks again for jumps where the given frames, or untrusted ones beside them, are neighbours.
    pub(super) fn update<P: Place>(&mut self, joint: &Joint<P>, trusted: &[bool], frames: Range<usize>) {
        let path = &joint.path;
        let mut frames = frames.start.max(1)..frames.end.min(path.len());
        if frames.is_empty() {
            return;
        }
        while frames.start > 1 && !trusted[frames.start] {
            frames.start -= 1;
        }
        while frames.end < path.len() && !trusted[frames.end - 1] {
            frames.end += 1;
        }
        let mut before = (0..frames.start).rev().find(|&frame| trusted[frame]);
        for t in frames.clone() {
            if trusted[t - 1] {
                before = Some(t - 1);
            }
            let jump = before.is_some_and(|before| path[before].nearness(path[t]) > self.bound);
            self.into[t] = jump && joint.trust[t] > 0.0;
        }
        let mut after = (frames.end..path.len()).find(|&frame| trusted[frame]);
        for t in frames.clone().rev() {
            if trusted[t] {
                after = Some(t);
            }
            // Most often both neighbours are trusted, and it is the jump that was just measured.
            let jump = if trusted[t - 1] && trusted[t] {
                self.into[t]
            } else {
                after.is_some_and(|after| path[t - 1].nearness(path[after]) > self.bound)
            };
            self.out[t] = jump && joint.trust[t - 1] > 0.0;
        }
        self.starts.retain(|start| !frames.contains(start));
        self.starts.extend(frames.filter(|&t| self.into[t]));
    }
}
