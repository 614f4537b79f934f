//! The Kalman filter of constant velocity, and its smoother, on scalars.

use super::covariance::Covariance;
use crate::error::check_length;
use crate::parallel::{self, Interrupt};
use crate::{Error, Real};

/// Variance of the velocity before it is known, in variances of a measurement.
const UNKNOWN_VELOCITY: f64 = 1e10;

/// State of a column at one frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct State {
    pub(super) value: f64,
    velocity: f64,
    pub(super) covariance: Covariance,
}

/// Filters a column forward; calls `judge` with each innovation in order.
pub(super) fn forward(
    values: impl IntoIterator<Item = f64>,
    ratio: f64,
    mut judge: impl FnMut(f64),
) -> Vec<State> {
    let mut states: Vec<State> = Vec::new();
    for sample in values {
        let after = match states.last() {
            None => {
                State { value: sample, velocity: 0.0, covariance: Covariance::first(1.0, UNKNOWN_VELOCITY) }
            }
            Some(before) => {
                let covariance = before.covariance.predicted(ratio);
                let innovation = sample - (before.value + before.velocity);
                judge(innovation);
                let [gain, velocity_gain] = covariance.gains(1.0, 1.0);
                State {
                    value: before.value + before.velocity + gain * innovation,
                    velocity: before.velocity + velocity_gain * innovation,
                    covariance: covariance.updated(1.0, 1.0),
                }
            }
        };
        states.push(after);
    }
    states
}

/// Smooths backward; calls `take` with the values from the last state to the first.
pub(super) fn backward(states: &[State], ratio: f64, mut take: impl FnMut(f64)) {
    let Some((last, states)) = states.split_last() else { return };
    let (mut value, mut velocity) = (last.value, last.velocity);
    take(value);
    for state in states.iter().rev() {
        let [c11, c12, c21, c22] = state.covariance.smoother_gains(ratio);
        let surprise = value - (state.value + state.velocity);
        let change = velocity - state.velocity;
        value = state.value + c11 * surprise + c12 * change;
        velocity = state.velocity + c21 * surprise + c22 * change;
        take(value);
    }
}

/// Filters the columns of `values`, `(frames, columns)`, one for each of the `ratios`, forward in time. Smooths them
/// with up to `lookahead` later frames, `None` for all.
///
/// A ratio is the spectral density of the acceleration in variances of a measurement, 1 / frame³, above 0.
///
/// # Errors
/// [`Error::Length`] if the lengths of slices do not agree; [`Error::Interrupted`].
pub fn filter_vectors<T: Real>(
    values: &[T],
    ratios: &[f64],
    lookahead: Option<usize>,
    out: &mut [T],
    interrupt: &Interrupt,
) -> Result<(), Error> {
    let columns = ratios.len();
    check_length("values", values.len() / columns.max(1) * columns, values.len())?;
    check_length("out", values.len(), out.len())?;
    let frames = values.len() / columns.max(1);
    if frames < 2 {
        out.copy_from_slice(values);
        return Ok(());
    }
    let reach = lookahead.unwrap_or(frames).min(frames - 1);
    let tasks: Vec<f64> = ratios.to_vec();
    let filtered =
        parallel::map(tasks, values.len() * (30 + 10 * reach.min(frames - reach)), |column, ratio| {
            let states = forward(values[column..].iter().step_by(columns).map(|x| x.to_f64()), ratio, |_| ());
            let mut result = vec![0.0; frames];
            for last in reach..frames - 1 {
                interrupt.check()?;
                backward(&states[last - reach..=last], ratio, |value| result[last - reach] = value);
            }
            let mut frame = frames;
            backward(&states[frames - 1 - reach..], ratio, |value| {
                frame -= 1;
                result[frame] = value;
            });
            Ok(result)
        })?;
    for (column, result) in filtered.iter().enumerate() {
        for (out, value) in out[column..].iter_mut().step_by(columns).zip(result) {
            *out = T::from_f64(*value);
        }
    }
    Ok(())
}
