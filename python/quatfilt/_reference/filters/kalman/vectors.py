"""The Kalman filter of constant velocity, and its smoother, on numbers."""

from typing import NamedTuple

import numpy as np

from quatfilt._reference._arrays import Reals
from quatfilt._reference.filters.kalman.covariance import Covariance

UNKNOWN_VELOCITY = 1e10
"""Variance of the velocity before anything is known of it, in variances of a measurement."""


class State(NamedTuple):
    """State of each column at one frame; arrays `(columns,)`."""

    value: Reals
    velocity: Reals
    covariance: Covariance


def kalman_vectors(x: Reals, ratio: Reals, lookahead: int) -> Reals:
    """Filter columns of numbers forward in time, and smooth them with what comes later.

    Parameters
    ----------
    x : array (frames, columns)
        Numbers, none of them missing.
    ratio : array (columns,), 1 / frame³
        Spectral density of the acceleration in variances of a measurement, above 0.
    lookahead : int, frames
        How many later frames a frame is smoothed with; −1 for all.

    Returns
    -------
    array (frames, columns)
    """
    frames = len(x)
    if frames < 2:
        return x.copy()
    states = [state for state, _ in forward(x.astype(np.float64), ratio)]
    reach = frames - 1 if lookahead < 0 else min(lookahead, frames - 1)
    result = np.empty(x.shape)
    for last in range(reach, frames - 1):
        result[last - reach] = smoothed(states, ratio, last, last - reach)[-1]
    result[frames - 1 - reach :] = smoothed(states, ratio, frames - 1, frames - 1 - reach)[::-1]
    return result.astype(x.dtype)


def forward(x: Reals, ratio: Reals) -> list[tuple[State, Reals]]:
    """Filter forward: the states, and the innovations that led to them, in units where a measurement's variance is 1."""
    one, nothing = np.ones(x.shape[1]), np.zeros(x.shape[1])
    first = Covariance(one, nothing, UNKNOWN_VELOCITY * one, UNKNOWN_VELOCITY * one)
    result: list[tuple[State, Reals]] = [(State(x[0], nothing, first), nothing)]
    for sample in x[1:]:
        state = result[-1][0]
        covariance = state.covariance.predicted(ratio)
        innovation = sample - (state.value + state.velocity)
        gain, velocity_gain = covariance.gains(one, one)
        after = State(
            state.value + state.velocity + gain * innovation,
            state.velocity + velocity_gain * innovation,
            covariance.updated(one, one),
        )
        result.append((after, innovation))
    return result


def smoothed(states: list[State], ratio: Reals, last: int, first: int) -> list[Reals]:
    """Smoothed values of the frames `last, last − 1 … first`, from what is known at frame `last`."""
    value, velocity, _ = states[last]
    result = [value]
    for state in states[first:last][::-1]:
        c11, c12, c21, c22 = state.covariance.smoother_gains(ratio)
        surprise = value - (state.value + state.velocity)
        change = velocity - state.velocity
        value = state.value + c11 * surprise + c12 * change
        velocity = state.velocity + c21 * surprise + c22 * change
        result.append(value)
    return result
