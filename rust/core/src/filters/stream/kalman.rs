//! The Kalman filter of a stream, and its fixed-lag smoother.

use super::pose::Pose;
use super::{Causal, MOST_NUMBERS, PoseStream};
use crate::Error;
use crate::error::check_length;
use crate::filters::kalman::Kalman;
use crate::filters::kalman::rotations::{Forecasts, Later, Record, Variances, backward, begin, forward};
use crate::filters::lanes::{LANES, Lane, lanes, of_lane};
use crate::rotations::quaternion::unit;

/// Frames kept beyond those in use, so that they are moved only now and then.
const MARGIN: usize = 32;

impl Kalman {
    /// The filter as a stream, over poses with one joint per noise.
    ///
    /// A joint is returned unchanged until its first sample with confidence.
    ///
    /// # Errors
    /// [`Error::Length`] if the numbers of noises differ; [`Error::Parameter`] for an unlimited lookahead, and for
    /// too much memory.
    pub fn stream(&self) -> Result<PoseStream, Error> {
        let joints = self.process_noise.len();
        check_length("measurement_noise", joints, self.measurement_noise.len())?;
        let reach = self.lookahead.unwrap_or(usize::MAX);
        let numbers = reach
            .saturating_mul(2 * joints.next_multiple_of(LANES) * size_of::<Record>() / size_of::<Lane>());
        if numbers > MOST_NUMBERS || self.lookahead.is_none() {
            return Err(Error::Parameter { name: "lookahead", expected: "so many frames as fit into 2 GiB" });
        }
        let squares = |noise: &[f64]| lanes(&noise.iter().map(|noise| noise * noise).collect::<Vec<f64>>());
        let groups = squares(&self.process_noise)
            .into_iter()
            .zip(squares(&self.measurement_noise))
            .map(|(process, measurement)| Group::new(Variances { process, measurement }, reach))
            .collect();
        Ok(PoseStream::new(Smoother { groups, reach, taken: 0, given: 0, ended: false }, joints))
    }
}

/// A group of eight joints.
struct Group {
    variances: Variances,
    forecasts: Forecasts,
    /// The states of the latest frames, at least of those not yet returned; after the end, the smoothed rotations of
    /// these.
    records: Vec<Record>,
    /// The frames of the joints' first samples with confidence.
    begin: [Option<usize>; LANES],
    /// The records to be smoothed, as they were before the end.
    rest: Vec<Record>,
}

impl Group {
    fn new(variances: Variances, reach: usize) -> Self {
        Self {
            variances,
            forecasts: Forecasts::default(),
            records: Vec::with_capacity(2 * reach + MARGIN),
            begin: [None; LANES],
            rest: Vec::with_capacity(reach),
        }
    }

    /// Adds the samples of the joints from `first` on, of the frame `frame`.
    fn take(&mut self, pose: &Pose, first: usize, frame: usize, reach: usize) {
        if self.records.len() == self.records.capacity() {
            let old = self.records.len() - reach - 1;
            self.records.copy_within(old.., 0);
            self.records.truncate(reach + 1);
        }
        let mut record = Record::STILL;
        for (plane, joints) in record.rotation.iter_mut().zip(pose.rotations()) {
            plane.copy_from_slice(&joints[first..first + LANES]);
        }
        record.confidence.copy_from_slice(&pose.confidence()[first..first + LANES]);
        for (begin, confidence) in self.begin.iter_mut().zip(record.confidence) {
            if begin.is_none() && confidence > 0.0 {
                *begin = Some(frame);
            }
        }
        self.records.push(record);
        let last = self.records.len() - 1;
        if frame == 0 {
            begin(&mut self.records[last], &self.variances, &mut self.forecasts);
        } else {
            forward(&mut self.records[last - 1..], &self.variances, &mut self.forecasts);
        }
    }

    /// Writes the rotations of a frame; for joints before their first sample, the samples.
    fn write(&self, smooth: &[Lane; 4], samples: &Record, first: usize, frame: usize, out: &mut Pose) {
        for (lane, begin) in self.begin.iter().enumerate().take(out.joints() - first) {
            let begun = begin.is_some_and(|begin| begin <= frame);
            let planes = if begun { smooth } else { &samples.rotation };
            out.set(first + lane, unit(of_lane(planes, lane)));
        }
    }
}

/// The groups of joints, frame by frame.
struct Smoother {
    groups: Vec<Group>,
    reach: usize,
    taken: usize,
    given: usize,
    ended: bool,
}

impl Causal for Smoother {
    fn latency(&self) -> usize {
        self.reach
    }

    /// The state of a joint starts at its first sample.
    fn appear(&mut self, _joint: usize, _q: [f64; 4]) {}

    fn push(&mut self, pose: &Pose, out: &mut Pose) -> bool {
        for (group, first) in self.groups.iter_mut().zip((0..).step_by(LANES)) {
            group.take(pose, first, self.taken, self.reach);
        }
        self.taken += 1;
        if self.taken <= self.reach {
            return false;
        }
        for (group, first) in self.groups.iter_mut().zip((0..).step_by(LANES)) {
            let last = group.records.len() - 1;
            let due = last - self.reach;
            let mut later = Later::nothing(&group.records[last]);
            backward(&mut group.records[due..last], &group.variances, &mut later, false);
            group.write(&later.rotation, &group.records[due], first, self.given, out);
        }
        self.given += 1;
        true
    }

    fn finish(&mut self, out: &mut Pose) -> bool {
        if self.given == self.taken {
            return false;
        }
        let left = self.taken - self.given;
        for (group, first) in self.groups.iter_mut().zip((0..).step_by(LANES)) {
            let last = group.records.len() - 1;
            if !self.ended {
                let mut later = Later::nothing(&group.records[last]);
                let rest = &mut group.records[last + 1 - left..];
                group.rest.extend_from_slice(rest);
                backward(&mut rest[..left - 1], &group.variances, &mut later, true);
            }
            let smooth = group.records[last + 1 - left].rotation;
            group.write(&smooth, &group.rest[group.rest.len() - left], first, self.given, out);
        }
        self.ended = true;
        self.given += 1;
        true
    }
}
