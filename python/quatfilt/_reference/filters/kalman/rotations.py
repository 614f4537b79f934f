"""The Kalman filter of constant angular velocity, and its smoother, on the manifold of rotations.

R. E. Kalman, *A New Approach to Linear Filtering and Prediction Problems*, 1960; H. E. Rauch, F. Tung and C. T. Striebel,
*Maximum Likelihood Estimates of Linear Dynamic Systems*, 1965. Sums of numbers become steps along geodesics, differences
become logarithms, and velocities are carried along by parallel transport.
"""

from typing import NamedTuple

import numpy as np

from quatfilt._reference._arrays import Mask, Reals
from quatfilt._reference.filters.displacements import carried, displacement_between, moved
from quatfilt._reference.filters.kalman.covariance import Covariance
from quatfilt._reference.filters.nonlocal_pose_means.nonlocal_pose_means import in_hemisphere_of
from quatfilt._reference.rotations.quaternion import normalize

FARTHEST_FORECAST = 0.2
"""Radians: deviation of a forecast beyond which it is not followed. The pose may then be anywhere, and a forecast that
goes on turning would be met from the wrong side by the next sample."""

FASTEST = np.pi
"""Radians per frame: deviation of the velocity before anything is known of it. Faster turns cannot be seen."""


class State(NamedTuple):
    """What is known of each joint at one frame."""

    rotation: Reals
    """`(joints, 4)`: the pose, or where the forecast was left."""
    velocity: Reals
    """`(joints, 3)`, radians per frame, in the frame of the joint."""
    beyond: Reals
    """`(joints,)`: for how many frames the velocity has gone on since the forecast was left."""
    covariance: Covariance

    def forecast(self) -> Reals:
        """Where the pose would be if the forecast were followed: the way from `rotation`, `(joints, 3)`."""
        return self.beyond[:, None] * self.velocity


class Prediction(NamedTuple):
    """What is expected one frame later."""

    origin: Reals
    """`(joints, 4)`: the rotation from which ways are measured."""
    way: Reals
    """`(joints, 3)`: the expected way from there; zero unless the forecast is left."""
    left: Mask
    """`(joints,)`: whether the forecast is left."""


def kalman(
    q: Reals, confidence: Reals | None, process_noise: Reals, measurement_noise: Reals, lookahead: int
) -> Reals:
    """Filter rotations forward in time, and smooth them with what comes later.

    Parameters
    ----------
    q : array (frames, joints, 4)
        Rotations without missing samples.
    confidence : array (frames, joints) or None
        From 0 to 1: the variance of a measurement is divided by it. None: 1 everywhere.
    process_noise : array (joints,), radians / frame^1.5
        Root of the spectral density of the angular acceleration.
    measurement_noise : array (joints,), radians
        Deviation per component of the rotation vector, above 0.
    lookahead : int, frames
        How many later frames a frame is smoothed with; −1 for all.

    Returns
    -------
    array (frames, joints, 4)
        Unit quaternions, continuous in sign from the hemisphere of the input's first frame. Before a joint's first
        sample with confidence its pose stays as it is there; a joint without one comes back as it is.
    """
    frames, joints = q.shape[:2]
    if frames < 2 or joints == 0:
        return normalize(q)
    samples = normalize(q.astype(np.float64))
    trust = np.ones((frames, joints)) if confidence is None else confidence.astype(np.float64)
    variances = process_noise**2, measurement_noise**2
    states = [state for state, _ in forward(samples, trust, *variances)]
    reach = frames - 1 if lookahead < 0 else min(lookahead, frames - 1)
    result = samples.copy()
    for last in range(reach, frames - 1):
        result[last - reach] = smoothed(states, trust, variances[0], last, last - reach)[-1]
    result[frames - 1 - reach :] = smoothed(states, trust, variances[0], frames - 1, frames - 1 - reach)[::-1]
    begin = np.argmax(trust > 0, axis=0)
    for joint in range(joints):
        if not trust[begin[joint], joint]:
            result[:, joint] = samples[:, joint]
        result[: begin[joint], joint] = result[begin[joint], joint]
    return in_hemisphere_of(normalize(result), q).astype(q.dtype)


def forward(
    samples: Reals, trust: Reals, process_variance: Reals, variance: Reals
) -> list[tuple[State, Reals]]:
    """Filter forward: the states, and the innovations `(joints, 3)` that led to them; zero at a joint's first sample."""
    state = unknown(samples[0], np.ones_like(trust[0]), variance)
    begun = trust[0] > 0
    result = [
        (
            either(begun, unknown(samples[0], np.where(begun, trust[0], 1), variance), state),
            0 * state.velocity,
        )
    ]
    for sample, weight in zip(samples[1:], trust[1:], strict=True):
        after, innovation = step(result[-1][0], sample, weight, process_variance, variance)
        begins = ~begun & (weight > 0)
        begun |= begins
        first = unknown(sample, np.where(begins, weight, 1), variance)
        result.append((either(begins, first, after), np.where(begins[:, None], 0, innovation)))
    return result


def unknown(sample: Reals, trust: Reals, variance: Reals) -> State:
    """Return what is known after one sample: the pose, and nothing of the velocity."""
    pose = variance / trust
    velocity = np.full_like(pose, FASTEST**2)
    return State(
        sample,
        np.zeros((len(sample), 3)),
        np.zeros(len(sample)),
        Covariance(pose, np.zeros_like(pose), velocity, pose * velocity),
    )


def predict(state: State, process_variance: Reals) -> tuple[Prediction, Covariance]:
    """Return what is expected of the next frame."""
    covariance = state.covariance.predicted(process_variance)
    left = covariance.pose > FARTHEST_FORECAST**2
    origin = np.where(left[:, None], state.rotation, moved(state.rotation, state.velocity))
    displacement = np.where(left[:, None], state.forecast() + state.velocity, 0)
    return Prediction(origin, displacement, left), covariance


def step(
    state: State, sample: Reals, trust: Reals, process_variance: Reals, variance: Reals
) -> tuple[State, Reals]:
    """Return the state one frame later, and the innovation: from the expected pose to the sample."""
    (origin, displacement, left), covariance = predict(state, process_variance)
    innovation = displacement_between(origin, sample) - displacement
    gain, velocity_gain = (x[:, None] for x in covariance.gains(variance, trust))
    corrected = displacement + gain * innovation
    velocity = carried(state.velocity + velocity_gain * innovation, corrected)
    measured = trust > 0
    return (
        State(
            np.where(measured[:, None], moved(origin, corrected), origin),
            np.where(measured[:, None], velocity, state.velocity),
            np.where(measured | ~left, 0, state.beyond + 1),
            covariance.updated(variance, trust),
        ),
        innovation,
    )


def smoothed(
    states: list[State], trust: Reals, process_variance: Reals, last: int, first: int
) -> list[Reals]:
    """Smoothed rotations of the frames `last, last − 1 … first`, from what is known at frame `last`."""
    after = states[last]
    # What is known better now: the way from the rotation of the state, and the velocity there.
    displacement, velocity = after.forecast(), after.velocity
    heard = np.zeros(len(displacement), np.bool_)
    result = [after.rotation]
    for frame in range(last - 1, first - 1, -1):
        state = states[frame]
        (origin, expected, left), _ = predict(state, process_variance)
        # The same as seen from the origin of the prediction, which a measurement has left behind.
        seen = displacement_between(origin, moved(after.rotation, displacement))
        measured = (trust[frame + 1] > 0)[:, None]
        velocity = np.where(measured, carried(carried(velocity, displacement), -seen), velocity)
        displacement = np.where(measured, seen, displacement)
        heard |= trust[frame + 1] > 0
        # What it differs by from what was expected; nothing where no sample came since. And as seen from here.
        surprise = np.where(heard[:, None], displacement - expected, 0)
        change = np.where(heard[:, None], velocity - state.velocity, 0)
        surprise = np.where(left[:, None], surprise, carried(surprise, -state.velocity))
        change = np.where(left[:, None], change, carried(change, -state.velocity))
        c11, c12, c21, c22 = (c[:, None] for c in state.covariance.smoother_gains(process_variance))
        displacement = state.forecast() + c11 * surprise + c12 * change
        velocity = state.velocity + c21 * surprise + c22 * change
        # Where no later sample says where a forecast leads, it is not followed.
        result.append(np.where(heard[:, None], moved(state.rotation, displacement), state.rotation))
        after = state
    return result


def either(condition: Mask, yes: State, no: State) -> State:
    """Choose the one state or the other, for each joint."""

    def chosen(a: Reals, b: Reals) -> Reals:
        return np.where(condition.reshape(-1, *[1] * (a.ndim - 1)), a, b)

    return State(
        chosen(yes.rotation, no.rotation),
        chosen(yes.velocity, no.velocity),
        chosen(yes.beyond, no.beyond),
        Covariance(*(chosen(a, b) for a, b in zip(yes.covariance, no.covariance, strict=True))),
    )
