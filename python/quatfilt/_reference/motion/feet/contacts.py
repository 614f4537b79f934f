"""When a foot joint stands on the ground: a slow and low path, with hysteresis."""

import numpy as np

from quatfilt._reference._arrays import Mask, Reals
from quatfilt._reference.filters.development import gaussian_mask, weighted_mean

LOW_PASS, LOW_PASS_NOISE = 0.05, 0.3
"""Seconds and centimetres: with the noise `ν` the path is low-passed with the deviation `0.05 ν / (ν + 0.3)` s, or noise looks like speed."""

MOST_NOISE = 2.5
"""Centimetres: noise that counts in the thresholds, at most."""

ENTER_SPEED, ENTER_SPEED_NOISE = 15.0, 5.0
"""Centimetres per second, and per second and centimetre of noise: a contact begins below this speed."""

ENTER_HEIGHT = 5.0
"""Centimetres: a contact begins below this height, plus the noise."""

STAY_SPEED, STAY_SPEED_NOISE = 20.0, 6.0
"""As above: a contact goes on below this speed."""

STAY_HEIGHT = 6.0
"""Centimetres: a contact goes on below this height, plus the noise."""

GROUND = 0.5
"""Percentile of the heights that stands for the ground: a single low frame is none."""

SHORTEST, FEWEST = 0.1, 3
"""Seconds and frames: a shorter contact is none. Noise makes short ones by chance: seconds count in proportion to it, up to this noise."""

CHANCE = 0.3
"""Centimetres of noise from which the seconds count in full."""

LONGEST_GAP = 0.05
"""Seconds: contacts that are no farther apart are one."""

SHORTEST_SIGMA = 0.05
"""Frames: a mask of a smaller deviation is one frame wide."""


def found(y: Reals, known: Mask, noise: float, up: int, fps: float) -> Mask:
    """Return when a path stands on the ground, `(frames,)`.

    Parameters
    ----------
    y : array (frames, 3), centimetres
        The path, with the vertical axis pointing up.
    known : array (frames,)
        Frames whose position was known; others are no contact.
    noise : float, centimetres
        `ν`.
    up : int
        The vertical axis.
    fps : float, hertz
    """
    none = np.zeros(len(y), np.bool_)
    if len(y) < FEWEST or not known.any():
        return none
    path = low_passed(y, LOW_PASS * noise / (noise + LOW_PASS_NOISE) * fps)
    extra = min(noise, MOST_NOISE)
    speed = np.linalg.norm(np.gradient(path, axis=0), axis=1) * fps
    height = path[:, up] - np.percentile(path[known, up], GROUND)
    enter = known & (speed < ENTER_SPEED + ENTER_SPEED_NOISE * extra) & (height < ENTER_HEIGHT + extra)
    stay = known & (speed < STAY_SPEED + STAY_SPEED_NOISE * extra) & (height < STAY_HEIGHT + extra)
    result = none
    for start, end in runs(stay):
        if enter[start:end].any():
            result[start:end] = True
    for start, end in runs(~result):
        inside = start > 0 and end < len(y)
        if inside and end - start <= LONGEST_GAP * fps and known[start:end].all():
            result[start:end] = True
    shortest = max(FEWEST, SHORTEST * fps * min(noise / CHANCE, 1))
    for start, end in runs(result):
        if end - start < shortest:
            result[start:end] = False
    return result


def low_passed(path: Reals, sigma: float) -> Reals:
    """Low-pass a path `(frames, 3)` under a Gaussian mask of a deviation in frames; its ends are held."""
    if sigma < SHORTEST_SIGMA or len(path) < 2:
        return path
    return weighted_mean(path, None, gaussian_mask(sigma), "nearest")


def runs(mask: Mask) -> list[tuple[int, int]]:
    """Return the first frame of each run of true values, and the frame after its last."""
    borders = np.flatnonzero(np.diff(np.concatenate([[False], mask, [False]]).astype(np.int8)))
    return [(int(start), int(end)) for start, end in borders.reshape(-1, 2)]
