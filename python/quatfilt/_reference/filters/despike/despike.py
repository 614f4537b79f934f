"""Spikes: samples that leave the motion and come back at once."""

import functools

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from quatfilt._reference._arrays import Indices, Mask, Reals
from quatfilt._reference.filters.despike.deviation import deviation, pace
from quatfilt._reference.filters.despike.displaced import displaced
from quatfilt._reference.filters.despike.place import distance
from quatfilt._reference.rotations.quaternion import normalize

DEVIATION_OF_NOISE = 1.5
"""Median deviation of samples of white noise with the deviation 1 per coordinate; 1.50 was measured for radius 3."""

MOTION = 2.0
"""A spike is farther away than the joint moves in so many frames. Where a frame is a copy of the one before and the motion
then catches up, the deviation is that of 1 frame: such a frame is no spike."""

SURROUNDINGS = 3
"""Neighbours and surroundings are looked for among so many radii of frames on either side."""

LOOKS = 3
"""How often the clip is looked at. The second look knows the spikes that the first one found, and sees those which they
hid; the third releases what only seemed to be one beside them."""


def find_spikes(
    x: Reals,
    confidence: Reals | None,
    noise: Reals,
    smallest: Reals,
    radius: int,
    threshold: float,
    longest: int,
) -> Mask:
    """Find the runs of less than `radius` samples that neither side of them nor the way across explains, and longer displaced ones.

    Runs of `radius` to `longest` samples are spikes if they are :func:`.displaced`. A shorter run is a spike if its :func:`.deviation` is
    larger than

    - `threshold` times the usual deviation: the median over the runs of the same length around it, and at least what
      white noise of the joint's level has, `1.5 · noise`;
    - `smallest`;
    - what the joint moves in 2 frames: by its :func:`.pace`.

    Neighbours of a run are, on either side, the nearest samples that are trusted: up to `radius` of them, within
    `3 · radius` frames, and so far reach the surroundings. Samples of confidence 0 are not trusted, nor are those that the look before this one took for
    spikes. A run without a neighbour on either side, as at the ends of a clip, is no spike. A confidence between 0 and
    1 takes that much off the threshold.

    Parameters
    ----------
    x : array (frames, joints, 4) or (frames, points, 3)
        Rotations without missing samples, or positions.
    confidence : array (frames, joints) or None
        Confidences in [0, 1]; `None` stands for 1.
    noise : array (joints,)
        Deviation of the noise per coordinate: radians of rotation, or the unit of the positions.
    smallest : array (joints,)
        Deviations up to here are no spikes: radians of rotation, or the unit of the positions.
    radius : int, frames
        The deviation judges shorter runs, by at most so many neighbours on either side.
    threshold : float
        How many times the usual deviation.
    longest : int, frames
        The longest displaced run; below `radius` none is looked for.

    Returns
    -------
    array (frames, joints) of bool
        Where spikes are; never where the confidence is 0.
    """
    frames, joints = x.shape[:2]
    trust = np.ones((frames, joints)) if confidence is None else confidence.astype(np.float64)
    path: Reals = x.astype(np.float64)
    if x.shape[-1] == 4:
        path = normalize(path)
    found = np.zeros((frames, joints), bool)
    for joint in range(joints):
        for _ in range(LOOKS):
            found[:, joint] = look(
                path[:, joint],
                trust[:, joint],
                found[:, joint],
                DEVIATION_OF_NOISE * float(noise[joint]),
                float(smallest[joint]),
                radius,
                threshold,
                longest,
            )
    return found


def look(
    path: Reals,
    trust: Reals,
    before: Mask,
    usual: float,
    smallest: float,
    radius: int,
    threshold: float,
    longest: int,
) -> Mask:
    """Spikes of one joint, `(frames,)`, given those that were found before."""
    frames = len(path)
    trusted = (trust > 0) & ~before
    reach = SURROUNDINGS * radius

    @functools.cache
    def sides(start: int, end: int) -> tuple[Indices, Indices]:
        earlier = np.arange(start - 1, max(start - reach, 0) - 1, -1)
        later = np.arange(end, min(end + reach, frames))
        return earlier[trusted[earlier]][:radius], later[trusted[later]][:radius]

    @functools.cache
    def deviation_of(start: int, end: int) -> float:
        return deviation(path, start, end, *sides(start, end))

    def surroundings(start: int, end: int) -> list[float]:
        length = end - start
        starts = [*range(start - reach, start - length + 1), *range(end, start + reach + 1)]
        runs = [(s, s + length) for s in starts if s >= 0 and s + length <= frames]
        found = [deviation_of(*run) for run in runs if trusted[slice(*run)].all()]
        return [value for value in found if np.isfinite(value)]

    def least(doubt: float) -> float:
        return max(smallest, threshold * doubt * usual)

    found = np.zeros(frames, bool)
    floor = least(float(np.min(trust, where=trust > 0, initial=1.0)))
    for length in range(1, min(radius, frames - 1)):
        for start in candidates(path, trust, trusted, length, reach, floor):
            end = start + length
            doubt = float(trust[start:end].max())
            away = deviation_of(start, end)
            if away > max(least(doubt), MOTION * pace(path, *sides(start, end))):
                around = surroundings(start, end)
                found[start:end] |= away > threshold * doubt * (np.median(around) if around else 0.0)
    return found | displaced(path, trust, trusted & ~found, range(radius, longest + 1), least)


def candidates(path: Reals, trust: Reals, trusted: Mask, length: int, reach: int, least: float) -> list[int]:
    """Find the runs of a length that have neighbours and are farther than `least` from the nearest ones: their starts.

    The nearest neighbours are two of the explanations of :func:`.deviation`: no other run can be a spike.
    """
    frames = np.arange(len(path))
    last = np.maximum.accumulate(np.where(trusted, frames, -1))
    first = np.minimum.accumulate(np.where(trusted, frames, len(path))[::-1])[::-1]
    starts = frames[1 : len(path) - length]
    before, after = last[starts - 1], first[starts + length]
    judged = (before >= starts - reach) & (before >= 0)
    judged &= (after < starts + length + reach) & (after < len(path))
    judged &= sliding_window_view(trust > 0, length)[1:-1].all(axis=-1)
    starts, before, after = starts[judged], before[judged], after[judged]
    into, out = distance(path[before], path[starts]), distance(path[starts + length - 1], path[after])
    return [int(start) for start in starts[(into > least) & (out > least)]]
