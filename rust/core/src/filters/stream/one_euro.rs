//! The 1€ filter of a stream.

use super::pose::Pose;
use super::{Causal, PoseStream};
use crate::Error;
use crate::error::check_length;
use crate::filters::lanes::{LANES, lanes, of_lane};
use crate::filters::one_euro::{Cutoffs, OneEuro, Record, State, forward};
use crate::rotations::quaternion::unit;

impl OneEuro {
    /// The filter as a stream, over poses with one joint per cutoff.
    ///
    /// A joint is returned unchanged until its first sample with confidence.
    ///
    /// # Errors
    /// [`Error::Length`] if the numbers of cutoffs and slopes differ.
    pub fn stream(&self) -> Result<PoseStream, Error> {
        let joints = self.min_cutoff.len();
        check_length("beta", joints, self.beta.len())?;
        check_length("derivative_cutoff", joints, self.derivative_cutoff.len())?;
        let groups = lanes(&self.min_cutoff)
            .into_iter()
            .zip(lanes(&self.beta))
            .zip(lanes(&self.derivative_cutoff))
            .map(|((least, beta), derivative)| (Cutoffs { least, beta, derivative }, State::nothing()))
            .collect();
        Ok(PoseStream::new(Follower { groups }, joints))
    }
}

/// State of the filter, per eight joints.
struct Follower {
    groups: Vec<(Cutoffs, State)>,
}

impl Causal for Follower {
    fn latency(&self) -> usize {
        0
    }

    /// The state of a joint starts at its first sample.
    fn appear(&mut self, _joint: usize, _q: [f64; 4]) {}

    fn push(&mut self, pose: &Pose, out: &mut Pose) -> bool {
        for ((cutoffs, state), first) in self.groups.iter_mut().zip((0..).step_by(LANES)) {
            let mut record = Record::STILL;
            for (plane, joints) in record.rotation.iter_mut().zip(pose.rotations()) {
                plane.copy_from_slice(&joints[first..first + LANES]);
            }
            record.confidence.copy_from_slice(&pose.confidence()[first..first + LANES]);
            forward(std::slice::from_mut(&mut record), cutoffs, state);
            for lane in 0..LANES.min(out.joints() - first) {
                out.set(first + lane, unit(of_lane(&record.rotation, lane)));
            }
        }
        true
    }

    fn finish(&mut self, _out: &mut Pose) -> bool {
        false
    }
}
