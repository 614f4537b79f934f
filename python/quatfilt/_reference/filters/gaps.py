"""Gaps: runs of missing samples."""

import numpy as np

from quatfilt._reference._arrays import Indices, Mask, Reals
from quatfilt._reference.rotations.quaternion import continuous, is_missing
from quatfilt._reference.rotations.resample import slerp


def fill_gaps(q: Reals, max_gap: int) -> tuple[Reals, Mask]:
    """Fill the runs of missing samples of each joint.

    A run between two valid samples is filled along the geodesic that joins them, the shorter way, at constant angular
    velocity. A run at an end of the clip is held at the nearest valid sample. Runs longer than `max_gap`, and joints
    without any valid sample, stay missing: NaN in all four components.

    Parameters
    ----------
    q : array (frames, joints, 4)
        Rotations.
    max_gap : int, frames
        The longest run that is filled; −1: any.

    Returns
    -------
    rotations : array (frames, joints, 4)
        Continuous in sign from the first valid sample. The valid samples are otherwise as they were.
    filled : array (frames, joints) of bool
        Where samples have been filled in.
    """
    missing = is_missing(q)
    filled = np.zeros(missing.shape, bool)
    result = q.copy()
    result[missing] = np.nan
    for joint in range(q.shape[1]):
        valid = np.flatnonzero(~missing[:, joint])
        if len(valid) == 0:
            continue
        for start, end in runs(missing[:, joint]):
            filled[start:end, joint] = max_gap < 0 or end - start <= max_gap
        gaps = np.flatnonzero(filled[:, joint])
        result[gaps, joint] = interpolate(q[valid, joint], valid, np.clip(gaps, valid[0], valid[-1]))
    return continuous(result), filled


def runs(mask: Mask) -> list[tuple[int, int]]:
    """First index, and index after the last, of every run of true values."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], mask, [False]])))
    return [(int(start), int(end)) for start, end in zip(edges[::2], edges[1::2], strict=True)]


def interpolate(path: Reals, times: Indices, new_times: Indices) -> Reals:
    """Rotations of one joint, `(frames, 4)`, at new times in frames."""
    return slerp(path[:, None], times.astype(np.float64), new_times.astype(np.float64))[:, 0]
