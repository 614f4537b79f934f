//! Filters with a window in time, and their boundary conditions.

use super::Causal;
use super::pose::Pose;
use crate::Error;
use crate::window::{Boundary, continued};

/// One filter's work on the latest frames.
pub(super) trait Window: Send {
    /// Numbers of frames of the window before and after a frame.
    fn reach(&self) -> (usize, usize);

    /// Adds a frame.
    fn admit(&mut self, pose: &Pose);

    /// Filters the newest frame whose window is complete: `reach().1` frames before the last.
    fn settle(&mut self, out: &mut Pose);

    /// Sets a joint to `q` in all frames.
    fn appear(&mut self, joint: usize, q: [f64; 4]);
}

/// A window that moves over a clip and over its continuation at both ends.
pub(super) struct Ends<W> {
    window: W,
    boundary: Boundary,
    /// The first pose, the last but one and the last.
    first: Pose,
    inner: Pose,
    last: Pose,
    scratch: Pose,
    /// Whether the frames before the first have been added.
    begun: bool,
    taken: usize,
    given: usize,
    /// Number of frames added after the last.
    beyond: usize,
}

impl<W: Window> Ends<W> {
    /// A window over poses of `joints` joints.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a boundary condition that needs frames beyond the window of the first pose.
    pub(super) fn new(window: W, boundary: Boundary, joints: usize) -> Result<Self, Error> {
        let known = match boundary {
            Boundary::Nearest => true,
            Boundary::Linear => window.reach().1 > 0,
            Boundary::Mirror => false,
        };
        if !known {
            let expected = "a condition that needs no later frames than the window does";
            return Err(Error::Parameter { name: "boundary", expected });
        }
        let pose = || Pose::new(joints);
        let (first, inner, last, scratch) = (pose(), pose(), pose(), pose());
        Ok(Self {
            window,
            boundary,
            first,
            inner,
            last,
            scratch,
            begun: false,
            taken: 0,
            given: 0,
            beyond: 0,
        })
    }

    /// Adds the frames before the first one, extrapolated from the first two, and the first frame.
    fn begin(&mut self, second: Option<&Pose>) {
        for steps in (1..=self.window.reach().0).rev() {
            extend(self.boundary, &self.first, second, steps, &mut self.scratch);
            self.window.admit(&self.scratch);
        }
        self.window.admit(&self.first);
        self.begun = true;
    }

    /// Returns the next frame, if its window is complete.
    fn give(&mut self, out: &mut Pose) -> bool {
        let due = self.begun && self.taken + self.beyond > self.given + self.window.reach().1;
        if due {
            self.window.settle(out);
            self.given += 1;
        }
        due
    }
}

impl<W: Window> Causal for Ends<W> {
    fn latency(&self) -> usize {
        self.window.reach().1
    }

    fn appear(&mut self, joint: usize, q: [f64; 4]) {
        for pose in [&mut self.first, &mut self.inner, &mut self.last] {
            pose.set(joint, q);
        }
        self.window.appear(joint, q);
    }

    fn push(&mut self, pose: &Pose, out: &mut Pose) -> bool {
        if self.taken == 0 {
            self.first.copy_from(pose);
            if self.boundary != Boundary::Linear {
                self.begin(None);
            }
        } else {
            if !self.begun {
                self.begin(Some(pose));
            }
            self.window.admit(pose);
        }
        std::mem::swap(&mut self.inner, &mut self.last);
        self.last.copy_from(pose);
        self.taken += 1;
        self.give(out)
    }

    fn finish(&mut self, out: &mut Pose) -> bool {
        if self.given == self.taken {
            return false;
        }
        if !self.begun {
            self.begin(None);
        }
        while !self.give(out) {
            self.beyond += 1;
            let inner = (self.taken > 1).then_some(&self.inner);
            extend(self.boundary, &self.last, inner, self.beyond, &mut self.scratch);
            self.window.admit(&self.scratch);
        }
        true
    }
}

/// Writes the pose `steps` frames beyond `end`; `inner` is the neighbour of `end`, if known. Confidences are
/// repeated.
fn extend(boundary: Boundary, end: &Pose, inner: Option<&Pose>, steps: usize, out: &mut Pose) {
    out.copy_from(end);
    if let (Boundary::Linear, Some(inner)) = (boundary, inner) {
        for joint in 0..end.joints() {
            out.set(joint, continued(end.at(joint), inner.at(joint), steps));
        }
    }
}
