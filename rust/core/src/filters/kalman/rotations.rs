//! The forward filter and the backward smoother, on eight joints side by side.
//!
//! A record holds their states at one frame. It starts as the samples, becomes the state of the filter, and in the
//! end its rotation is the smoothed one. All arithmetic is in float64.

use super::covariance::Covariance;
use crate::filters::lanes::{LANES, Lane, of_lane, scaled, select, set_lane};
use crate::rotations::quaternion::{between, conjugate_one, exp_one, log_short, product, rotate, unit};
use crate::simd::multiversion;

/// Standard deviation of a forecast, radians, beyond which the pose is held. With larger ones the pose may be
/// anywhere, and a forecast that keeps rotating could be more than 180° from the next sample.
const FARTHEST_FORECAST: f64 = 0.2;

/// Standard deviation of the velocity before it is known, radians per frame. Faster rotations are not observable.
const FASTEST: f64 = std::f64::consts::PI;

/// Number of measurements that determine the first velocity. Earlier forecasts carry no information.
const KNOWN: f64 = 2.0;

/// Variances of each joint: of the acceleration within a frame, and of a measurement.
#[derive(Debug, Clone, Copy)]
pub(in crate::filters) struct Variances {
    pub(in crate::filters) process: Lane,
    pub(in crate::filters) measurement: Lane,
}

/// One frame of [`LANES`] joints.
#[derive(Debug, Clone, Copy)]
pub(in crate::filters) struct Record {
    /// The sample, of any length; then the pose, or the pose at which the forecast stopped; in the end the smoothed
    /// pose.
    pub(in crate::filters) rotation: [Lane; 4],
    /// Confidence of the sample.
    pub(in crate::filters) confidence: Lane,
    /// Angular velocity, radians per frame, in the joint's own frame.
    velocity: [Lane; 3],
    /// Number of frames for which the velocity has continued since the forecast stopped.
    beyond: Lane,
    covariance: [Lane; 4],
}

impl Record {
    /// A constant sample of each joint at the identity, with confidence.
    pub(in crate::filters) const STILL: Self = Self {
        rotation: [[1.0; LANES], [0.0; LANES], [0.0; LANES], [0.0; LANES]],
        confidence: [1.0; LANES],
        velocity: [[0.0; LANES]; 3],
        beyond: [0.0; LANES],
        covariance: [[0.0; LANES]; 4],
    };

    /// The same sample in all lanes.
    pub(in crate::filters) fn alike(sample: [f64; 4], confidence: f64) -> Self {
        Self { rotation: sample.map(|x| [x; LANES]), confidence: [confidence; LANES], ..Self::STILL }
    }

    #[inline(always)]
    pub(in crate::filters) fn rotation(&self, lane: usize) -> [f64; 4] {
        of_lane(&self.rotation, lane)
    }

    #[inline(always)]
    pub(in crate::filters) fn covariance(&self, lane: usize) -> Covariance {
        Covariance::of_array(of_lane(&self.covariance, lane))
    }

    #[inline(always)]
    fn state(&self, lane: usize) -> State {
        State {
            rotation: self.rotation(lane),
            velocity: of_lane(&self.velocity, lane),
            beyond: self.beyond[lane],
            covariance: self.covariance(lane),
        }
    }

    #[inline(always)]
    fn set_state(&mut self, lane: usize, state: State) {
        set_lane(&mut self.rotation, lane, state.rotation);
        set_lane(&mut self.velocity, lane, state.velocity);
        self.beyond[lane] = state.beyond;
        set_lane(&mut self.covariance, lane, state.covariance.to_array());
    }
}

/// State of one joint at one frame.
#[derive(Debug, Clone, Copy)]
struct State {
    rotation: [f64; 4],
    velocity: [f64; 3],
    beyond: f64,
    covariance: Covariance,
}

/// Prediction of one joint one frame later.
struct Prediction {
    /// The rotation relative to which displacements are measured.
    origin: [f64; 4],
    /// The predicted displacement from there; zero unless the forecast has stopped.
    displacement: [f64; 3],
    /// Whether the forecast has stopped.
    left: bool,
    /// Half of one frame's rotation.
    half_turn: [f64; 4],
    covariance: Covariance,
}

impl State {
    /// State after one sample: the pose, and an unknown velocity.
    #[inline(always)]
    fn first(sample: [f64; 4], confidence: f64, variance: f64) -> Self {
        let covariance = Covariance::first(variance / confidence, FASTEST * FASTEST);
        Self { rotation: sample, velocity: [0.0; 3], beyond: 0.0, covariance }
    }

    /// One of two states, without a branch.
    #[inline(always)]
    fn select(condition: bool, yes: Self, no: Self) -> Self {
        let covariance = select(condition, yes.covariance.to_array(), no.covariance.to_array());
        Self {
            rotation: select(condition, yes.rotation, no.rotation),
            velocity: select(condition, yes.velocity, no.velocity),
            beyond: select(condition, [yes.beyond], [no.beyond])[0],
            covariance: Covariance::of_array(covariance),
        }
    }

    /// The displacement from the rotation to the pose that the forecast would reach.
    #[inline(always)]
    fn forecast(&self) -> [f64; 3] {
        scaled(self.velocity, self.beyond)
    }

    #[inline(always)]
    fn predict(&self, process: f64) -> Prediction {
        let covariance = self.covariance.predicted(process);
        let left = covariance.pose > FARTHEST_FORECAST * FARTHEST_FORECAST;
        let half_turn = exp_one(scaled(self.velocity, 0.25));
        let moved = product(self.rotation, product(half_turn, half_turn));
        let frames = if left { self.beyond + 1.0 } else { 0.0 };
        Prediction {
            origin: select(left, self.rotation, moved),
            displacement: scaled(self.velocity, frames),
            left,
            half_turn,
            covariance,
        }
    }

    /// The state one frame later, and the squared innovation: the displacement from the predicted pose to the sample.
    #[inline(always)]
    fn step(&self, sample: [f64; 4], confidence: f64, process: f64, variance: f64) -> (Self, f64) {
        let expected = self.predict(process);
        let innovation = minus(displacement_between(expected.origin, sample), expected.displacement);
        // Kalman gains K₁, K₂; then q = q⁻ exp(K₁ν/2) and ω = transport(ω⁻ + K₂ν).
        let [gain, velocity_gain] = expected.covariance.gains(variance, confidence);
        let corrected = plus(expected.displacement, gain, innovation);
        let half = exp_one(scaled(corrected, 0.25));
        let moved = product(expected.origin, product(half, half));
        let velocity = rotate(conjugate_one(half), plus(self.velocity, velocity_gain, innovation));
        let measured = confidence > 0.0;
        let after = Self {
            rotation: select(measured, moved, expected.origin),
            velocity: select(measured, velocity, self.velocity),
            beyond: if measured | !expected.left { 0.0 } else { self.beyond + 1.0 },
            covariance: expected.covariance.updated(variance, confidence),
        };
        (after, square(innovation))
    }
}

/// Smoothed state of one joint at a frame.
#[derive(Debug, Clone, Copy)]
struct Better {
    /// The smoothed rotation.
    rotation: [f64; 4],
    /// The displacement to it from the rotation of the filter's state.
    displacement: [f64; 3],
    /// Half of its rotation.
    half: [f64; 4],
    /// The smoothed velocity in the tangent space at the rotation of the filter's state.
    velocity: [f64; 3],
    /// Whether there is a later sample.
    heard: bool,
}

impl Better {
    /// The smoothed state of the previous frame, whose filter state is `state`. `measured` is whether there is a
    /// sample at this frame.
    #[inline(always)]
    fn back(&self, measured: bool, state: &State, process: f64) -> Self {
        let expected = state.predict(process);
        // Relative to the origin of the prediction, which differs from the state after a measurement.
        let seen = displacement_between(expected.origin, self.rotation);
        let there = rotate(conjugate_one(self.half), self.velocity);
        let carried = rotate(exp_one(scaled(seen, 0.25)), there);
        let velocity = select(measured, carried, self.velocity);
        let displacement = select(measured, seen, self.displacement);
        let heard = self.heard | measured;
        // Differences from the prediction, in the previous frame's coordinates; zero without a later sample.
        let surprise = select(heard, minus(displacement, expected.displacement), [0.0; 3]);
        let change = select(heard, minus(velocity, state.velocity), [0.0; 3]);
        let surprise = select(expected.left, surprise, rotate(expected.half_turn, surprise));
        let change = select(expected.left, change, rotate(expected.half_turn, change));
        // Rauch–Tung–Striebel gains C of the filter's covariance.
        let [c11, c12, c21, c22] = state.covariance.smoother_gains(process);
        let displacement = plus(plus(state.forecast(), c11, surprise), c12, change);
        let velocity = plus(plus(state.velocity, c21, surprise), c22, change);
        let half = exp_one(scaled(displacement, 0.25));
        // Without a later sample the forecast is not followed.
        let moved = product(state.rotation, product(half, half));
        Self { rotation: select(heard, moved, state.rotation), displacement, half, velocity, heard }
    }
}

/// Smoothed states of [`LANES`] joints at a frame.
#[derive(Debug, Clone, Copy)]
pub(in crate::filters) struct Later {
    pub(in crate::filters) rotation: [Lane; 4],
    displacement: [Lane; 3],
    half: [Lane; 4],
    velocity: [Lane; 3],
    heard: [bool; LANES],
    confidence: Lane,
}

impl Later {
    /// The start of the smoother: the filter's state at the last frame.
    pub(in crate::filters) fn nothing(record: &Record) -> Self {
        Self {
            rotation: record.rotation,
            displacement: std::array::from_fn(|c| {
                std::array::from_fn(|i| record.velocity[c][i] * record.beyond[i])
            }),
            half: Record::STILL.rotation,
            velocity: record.velocity,
            heard: [false; LANES],
            confidence: record.confidence,
        }
    }

    #[inline(always)]
    fn of_lane(&self, i: usize) -> Better {
        Better {
            rotation: of_lane(&self.rotation, i),
            displacement: of_lane(&self.displacement, i),
            half: of_lane(&self.half, i),
            velocity: of_lane(&self.velocity, i),
            heard: self.heard[i],
        }
    }

    #[inline(always)]
    fn set_lane(&mut self, i: usize, better: Better) {
        set_lane(&mut self.rotation, i, better.rotation);
        set_lane(&mut self.displacement, i, better.displacement);
        set_lane(&mut self.half, i, better.half);
        set_lane(&mut self.velocity, i, better.velocity);
        self.heard[i] = better.heard;
    }
}

/// Statistics of the filter's forecasts, for each joint.
#[derive(Debug, Clone, Copy, Default)]
pub(in crate::filters) struct Forecasts {
    /// Number of samples with confidence.
    pub(in crate::filters) measured: Lane,
    /// Squared innovations, each times its confidence.
    pub(in crate::filters) errors: Lane,
    /// Sum of these confidences.
    pub(in crate::filters) weights: Lane,
}

/// Starts the filter with the first record, which holds a sample.
pub(in crate::filters) fn begin(record: &mut Record, variances: &Variances, forecasts: &mut Forecasts) {
    for i in 0..LANES {
        let measured = record.confidence[i] > 0.0;
        let confidence = if measured { record.confidence[i] } else { 1.0 };
        record.set_state(i, State::first(unit(record.rotation(i)), confidence, variances.measurement[i]));
        forecasts.measured[i] = if measured { 1.0 } else { 0.0 };
    }
}

multiversion! {
    /// Filters forward: `records[0]` holds a state, the others samples, which are replaced by states.
    pub(in crate::filters) fn forward(records: &mut [Record], variances: &Variances, forecasts: &mut Forecasts) {
        let Some((first, rest)) = records.split_first_mut() else { return };
        let mut before = *first;
        for record in rest {
            let mut after = *record;
            for i in 0..LANES {
                let (sample, confidence) = (unit(after.rotation(i)), after.confidence[i]);
                let (process, variance) = (variances.process[i], variances.measurement[i]);
                let (state, error) = before.state(i).step(sample, confidence, process, variance);
                let measured = confidence > 0.0;
                // Before its first measurement a joint is at its sample.
                let begun = forecasts.measured[i] > 0.0;
                let first = State::first(sample, if measured { confidence } else { 1.0 }, variance);
                after.set_state(i, State::select(begun, state, first));
                let judging = if forecasts.measured[i] >= KNOWN { confidence } else { 0.0 };
                forecasts.errors[i] += judging * error;
                forecasts.weights[i] += judging;
                forecasts.measured[i] += if measured { 1.0 } else { 0.0 };
            }
            *record = after;
            before = after;
        }
    }
}

multiversion! {
    /// Smooths backward: the records hold states. `later` is the smoothed state after the last record on entry, and
    /// of the first record on return. With `keep` the rotations are replaced by the smoothed ones.
    pub(in crate::filters) fn backward(records: &mut [Record], variances: &Variances, later: &mut Later, keep: bool) {
        let mut now = *later;
        for record in records.iter_mut().rev() {
            let state = *record;
            for i in 0..LANES {
                now.set_lane(i, now.of_lane(i).back(now.confidence[i] > 0.0, &state.state(i), variances.process[i]));
            }
            now.confidence = state.confidence;
            if keep {
                record.rotation = now.rotation;
            }
        }
        *later = now;
    }
}

/// The shorter displacement between two rotations, a rotation vector in the frame of its start.
#[inline(always)]
pub(in crate::filters) fn displacement_between(start: [f64; 4], end: [f64; 4]) -> [f64; 3] {
    scaled(log_short(between(start, end)), 2.0)
}

#[inline(always)]
pub(in crate::filters) fn square(v: [f64; 3]) -> f64 {
    v[0] * v[0] + v[1] * v[1] + v[2] * v[2]
}

#[inline(always)]
fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// `a + factor·b`.
#[inline(always)]
fn plus(a: [f64; 3], factor: f64, b: [f64; 3]) -> [f64; 3] {
    [a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]]
}
