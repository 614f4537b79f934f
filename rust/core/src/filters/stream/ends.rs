//! Filters with a window in time, and what they see beyond the ends of the clip.

use super::Causal;
use super::pose::Pose;
use crate::Error;
use crate::window::{Boundary, continued};

/// What one filter does with the latest frames.
pub(super) trait Window: Send {
    /// How many frames before and after a frame it sees.
    fn reach(&self) -> (usize, usize);

    /// Takes a frame.
    fn admit(&mut self, pose: &Pose);

    /// Filters the frame that now has all that it sees after it: the last but `reach().1`.
    fn settle(&mut self, out: &mut Pose);

    /// Puts a joint in all frames at `q`.
    fn appear(&mut self, joint: usize, q: [f64; 4]);
}

/// A window that moves over a clip and over what continues it at either end.
pub(super) struct Ends<W> {
    window: W,
    boundary: Boundary,
    /// The first pose, the last but one and the last.
    first: Pose,
    inner: Pose,
    last: Pose,
    spare: Pose,
    /// Whether the frames before the first were admitted.
    begun: bool,
    taken: usize,
    given: usize,
    /// How many frames after the last were admitted.
    beyond: usize,
}

impl<W: Window> Ends<W> {
    /// A window over poses of so many joints.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a condition that has to know more of the clip than there is when the first pose comes out.
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
        let (first, inner, last, spare) = (pose(), pose(), pose(), pose());
        Ok(Self { window, boundary, first, inner, last, spare, begun: false, taken: 0, given: 0, beyond: 0 })
    }

    /// Admits what lies before the first frame, as seen from the second, and the first frame.
    fn begin(&mut self, second: Option<&Pose>) {
        for steps in (1..=self.window.reach().0).rev() {
            extend(self.boundary, &self.first, second, steps, &mut self.spare);
            self.window.admit(&self.spare);
        }
        self.window.admit(&self.first);
        self.begun = true;
    }

    /// Gives the next frame, if all that it sees was admitted.
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
            extend(self.boundary, &self.last, inner, self.beyond, &mut self.spare);
            self.window.admit(&self.spare);
        }
        true
    }
}

/// Writes the pose `steps` frames beyond `end`, whose inner neighbour may be known. Confidences are held.
fn extend(boundary: Boundary, end: &Pose, inner: Option<&Pose>, steps: usize, out: &mut Pose) {
    out.copy_from(end);
    if let (Boundary::Linear, Some(inner)) = (boundary, inner) {
        for joint in 0..end.joints() {
            out.set(joint, continued(end.at(joint), inner.at(joint), steps));
        }
    }
}
