//! Streams: filters that receive a clip pose by pose and return it pose by pose, a fixed number of frames later.
//!
//! The result equals that of the filter of the whole clip with the same window of earlier and later frames. A stream
//! has state, which it allocates when it is created. It processes each pose on the calling thread: a pose is too
//! little work to share. It computes in float64 for every dtype.
//!
//! - here: missing samples and signs of a live source are handled before the filter sees a pose;
//! - `pose`: poses as planes over the joints, and rings of the latest ones;
//! - `ends`: filters with a window, and their boundary conditions;
//! - one file for each filter. A filter with a window implements `Window`; any other implements `Causal`.

mod bilateral;
mod ends;
mod kalman;
mod nonlocal_pose_means;
mod one_euro;
mod pose;

use crate::Error;
use crate::error::check_length;
use crate::rotations::quaternion::{dot, is_missing, lower, negative, of_row, unit};
use pose::Pose;

/// Largest number of values that a stream may keep: 2 GiB. Larger windows could not keep up with the source.
const MOST_NUMBERS: usize = 1 << 28;

/// A filter that processes poses one by one.
///
/// The quaternions have length 1 and no sign jumps; the first is in the half of S³ that contains the identity. A
/// missing sample repeats the last valid one, with confidence 0.
trait Causal: Send {
    /// Number of frames between a pose and its result.
    fn latency(&self) -> usize;

    /// Sets a joint that had no valid sample so far: in all earlier poses it gets the value `q`, with confidence 0.
    ///
    /// Called before the pose with the joint's first sample is pushed.
    fn appear(&mut self, joint: usize, q: [f64; 4]);

    /// Processes the next pose. Returns whether there is a result in `out`: the pose of `latency` frames ago.
    fn push(&mut self, pose: &Pose, out: &mut Pose) -> bool;

    /// After the last pose: writes the next pending result. Returns whether there was one.
    fn finish(&mut self, out: &mut Pose) -> bool;
}

/// A filter running on a clip that has not ended.
pub struct PoseStream {
    filter: Box<dyn Causal>,
    joints: Vec<Joint>,
    taken: usize,
    given: usize,
    ended: bool,
    pose: Pose,
    out: Pose,
    row: Vec<f64>,
}

/// State of a joint.
#[derive(Debug, Clone, Copy, Default)]
struct Joint {
    /// The frame of its first sample.
    since: Option<usize>,
    taken: Sign,
    given: Sign,
}

/// Makes the sign of a path continuous.
#[derive(Debug, Clone, Copy, Default)]
struct Sign {
    before: [f64; 4],
    turned: bool,
}

impl Sign {
    /// The next sample with the sign that makes the path continuous.
    fn follow(&mut self, q: [f64; 4]) -> [f64; 4] {
        self.turned ^= dot(q, self.before) < 0.0;
        self.before = q;
        if self.turned { negative(q) } else { q }
    }
}

impl PoseStream {
    fn new(filter: impl Causal + 'static, joints: usize) -> Self {
        Self {
            filter: Box::new(filter),
            joints: vec![Joint::default(); joints],
            taken: 0,
            given: 0,
            ended: false,
            pose: Pose::new(joints),
            out: Pose::new(joints),
            row: vec![0.0; joints * 4],
        }
    }

    /// Number of joints of a pose.
    #[must_use]
    pub fn joints(&self) -> usize {
        self.joints.len()
    }

    /// Number of frames between a pose and its result.
    #[must_use]
    pub fn latency(&self) -> usize {
        self.filter.latency()
    }

    /// Number of pending results.
    #[must_use]
    pub fn pending(&self) -> usize {
        self.taken - self.given
    }

    /// Processes the next pose, `(joints, 4)`, with confidences, `(joints,)` in 0…1. Returns the pose of `latency`
    /// frames ago.
    ///
    /// A missing joint repeats its last sample, with confidence 0; before its first sample the result is NaN.
    /// Quaternions need not have length 1 exactly. The results are continuous in sign from the hemisphere of the
    /// first sample.
    ///
    /// # Errors
    /// [`Error::Length`] if the lengths of slices do not agree; [`Error::Parameter`] after [`PoseStream::finish`].
    pub fn push(&mut self, pose: &[f64], confidence: Option<&[f64]>) -> Result<Option<&[f64]>, Error> {
        check_length("pose", self.joints.len() * 4, pose.len())?;
        if let Some(confidence) = confidence {
            check_length("confidence", self.joints.len(), confidence.len())?;
        }
        if self.ended {
            return Err(Error::Parameter { name: "pose", expected: "no more of them after the end" });
        }
        for (index, (joint, q)) in self.joints.iter_mut().zip(pose.chunks_exact(4)).enumerate() {
            let q = of_row(q);
            if is_missing(q) {
                self.pose.set_confidence(index, 0.0);
                continue;
            }
            let q = unit(q);
            if joint.since.is_none() {
                joint.since = Some(self.taken);
                joint.taken = Sign { before: q, turned: lower(q) };
                joint.given.before = q;
                self.filter.appear(index, joint.taken.follow(q));
            }
            self.pose.set(index, joint.taken.follow(q));
            self.pose.set_confidence(index, confidence.map_or(1.0, |confidence| confidence[index]));
        }
        self.taken += 1;
        let came = self.filter.push(&self.pose, &mut self.out);
        Ok(came.then(|| self.give()))
    }

    /// Ends the clip. Returns the next pending result, or `None` after the last.
    pub fn finish(&mut self) -> Option<&[f64]> {
        self.ended = true;
        let came = self.filter.finish(&mut self.out);
        came.then(|| self.give())
    }

    /// The result as a row.
    fn give(&mut self) -> &[f64] {
        for (index, (joint, row)) in self.joints.iter_mut().zip(self.row.chunks_exact_mut(4)).enumerate() {
            let there = joint.since.is_some_and(|since| since <= self.given);
            let q = if there { joint.given.follow(self.out.at(index)) } else { [f64::NAN; 4] };
            row.copy_from_slice(&q);
        }
        self.given += 1;
        &self.row
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::filters::bilateral::{Bilateral, Kernel};
    use crate::filters::kalman::Kalman;
    use crate::filters::nonlocal_pose_means::{Chart, Distance, NonlocalPoseMeans, Weights};
    use crate::filters::one_euro::OneEuro;
    use crate::parallel::Interrupt;
    use crate::rotations::quaternion::exp_one;
    use crate::window::Boundary;
    use crate::{ClipMut, ClipView, Real};

    const FRAMES: usize = 50;
    const JOINTS: usize = 3;

    /// Oscillating joints with a tremor.
    fn clip() -> Vec<f64> {
        let sample = |i: usize| {
            let (frame, joint) = ((i / JOINTS) as f64, (i % JOINTS) as f64);
            let tremor = Real::sin_cos(7.3 * frame + joint).0;
            exp_one([Real::sin_cos(0.2 * frame + joint).0, 0.05 * tremor, 0.02 * tremor * joint])
        };
        (0..FRAMES * JOINTS).flat_map(sample).collect()
    }

    fn pushed(mut stream: PoseStream, q: &[f64]) -> Result<Vec<f64>, Error> {
        let mut out = Vec::new();
        for pose in q.chunks_exact(JOINTS * 4) {
            out.extend_from_slice(stream.push(pose, None)?.unwrap_or_default());
        }
        assert_eq!(stream.pending(), stream.latency());
        while let Some(pose) = stream.finish() {
            out.extend_from_slice(pose);
        }
        assert_eq!(stream.pending(), 0);
        assert!(stream.push(&q[..JOINTS * 4], None).is_err(), "the clip is over");
        Ok(out)
    }

    fn farthest(a: &[f64], b: &[f64]) -> f64 {
        assert_eq!(a.len(), b.len());
        a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn a_stream_gives_what_the_filter_of_the_clip_gives() -> Result<(), Error> {
        let q = clip();
        let view = ClipView::new(&q, FRAMES, JOINTS)?;
        let mut out = vec![0.0; q.len()];
        let interrupt = Interrupt::new();
        for lookahead in [0, 2, 5] {
            let means = NonlocalPoseMeans {
                search_radius: Some(4),
                patch_radius: 2,
                bandwidth: vec![0.05, 0.1, 0.2],
                distance: Distance::Mean,
                weights: Weights::Joint,
                neighbors: None,
                chart: Chart::Local,
                boundary: Boundary::Nearest,
                lookahead: Some(lookahead),
            };
            means.filter(view, None, None, None, ClipMut::new(&mut out, FRAMES, JOINTS)?, &interrupt)?;
            assert!(farthest(&out, &q) > 1e-3);
            assert!(farthest(&pushed(means.stream()?, &q)?, &out) < 1e-12);
            let bilateral = Bilateral {
                radius: 5,
                sigma_time: 1.0,
                sigma_angle: vec![0.2; JOINTS],
                kernel: Kernel::Classic,
                iterations: 3,
                boundary: Boundary::Nearest,
                lookahead: Some(lookahead),
            };
            bilateral.filter(view, None, ClipMut::new(&mut out, FRAMES, JOINTS)?, &interrupt)?;
            assert!(farthest(&out, &q) > 1e-3);
            assert!(farthest(&pushed(bilateral.stream()?, &q)?, &out) < 1e-12);
            let kalman = Kalman {
                process_noise: vec![0.0, 0.01, 1.0],
                measurement_noise: vec![0.1; JOINTS],
                lookahead: Some(lookahead),
            };
            kalman.filter(view, None, ClipMut::new(&mut out, FRAMES, JOINTS)?, &interrupt)?;
            assert!(farthest(&out, &q) > 1e-3);
            assert!(farthest(&pushed(kalman.stream()?, &q)?, &out) < 1e-12);
        }
        let one_euro = OneEuro {
            min_cutoff: vec![0.01, 0.1, 1.0],
            beta: vec![0.1; JOINTS],
            derivative_cutoff: vec![0.01; JOINTS],
        };
        one_euro.filter(view, None, None, ClipMut::new(&mut out, FRAMES, JOINTS)?, &interrupt)?;
        assert!(farthest(&out, &q) > 1e-3);
        assert!(farthest(&pushed(one_euro.stream()?, &q)?, &out) < 1e-12);
        Ok(())
    }
}
