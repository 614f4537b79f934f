"""By how much feet are to be moved: their paths, contacts and targets, blended over time."""

import numpy as np

from quatfilt._reference._arrays import Mask, Reals
from quatfilt._reference.motion.feet import contacts, paths
from quatfilt._reference.motion.feet.contacts import low_passed, runs

LEG = 90.0
"""Centimetres: thresholds hold for a leg of this length; lengths are multiplied by 90 / leg length."""

SIGMAS = (0.4, 0.28, 0.2, 0.14, 0.1, 0.07, 0.05, 0.035, 0.025, 0.0175, 0.0125)
"""Seconds: deviations of the low-passes that are tried for a target, the longest first; then the path itself is the target."""

ALWAYS, MOST_FRAMES = 0.1, 12.5
"""Seconds and frames: a deviation is tried if it is not above one of these. Few frames per second need more time against noise."""

FIT = 0.35
"""Of the noise: root mean square per coordinate by which a low-pass may move the path within a contact."""

FARTHEST = 3.0
"""Centimetres: a foot is moved by no more."""

FADE = 0.1
"""Seconds: before and after a contact its displacement fades out."""

BRIDGE = 0.2
"""Seconds: between contacts no farther apart the displacement is interpolated."""

RANGE, RANGE_NOISE = 3.0, 0.5
"""Centimetres, and per centimetre of noise: a foot that is locked and moves farther within a contact takes a step."""

STEP = 0.04
"""Seconds: gap that such a step leaves."""

SHORTEST_HOLD = 0.1
"""Seconds: a foot is locked for no less."""


def foot_displacements(
    before: Reals,
    after: Reals,
    lengths: Reals,
    up: int,
    fps: float,
    given: Mask | None,
    lock: bool,  # noqa: FBT001
) -> tuple[Reals, Mask]:
    """Find when feet stand on the ground, and by how much they are to be moved.

    Parameters
    ----------
    before, after : array (frames, legs, 2, 3)
        Paths of ankle and toe of each leg in the input and in the filtered motion. A leg without a toe has its ankle twice.
    lengths : array (legs,)
        Lengths of the legs in the unit of the paths.
    up : int
        The axis that points up, 0 to 2; `up − 3`, that is −3 to −1, if it points down.
    fps : float, hertz
    given : array (frames, legs, 2) or None
        Contacts that are known; None to find them.
    lock : bool
        Whether feet stay at one point, or follow their path in the input.

    Returns
    -------
    displacements : array (frames, legs, 2, 3), float64
        In the unit of the paths; NaN nowhere.
    contacts : array (frames, legs, 2)
    """
    displacements = np.zeros(before.shape)
    touching = np.zeros(before.shape[:3], np.bool_)
    if len(before) < 2:
        return displacements, touching
    for leg, length in enumerate(lengths):
        scale = LEG / float(length)
        moved, weights = np.zeros((2, len(before), 3)), np.zeros((2, len(before)))
        for part in range(2):
            x, f = (path[:, leg, part].astype(np.float64) * scale for path in (before, after))
            own = None if given is None else given[:, leg, part]
            moved[part], weights[part], touching[:, leg, part] = one_joint(x, f, up, fps, own, lock)
        a, t = moved
        w_a, w_t = weights[..., None]
        ankle = w_a * a + (1 - w_a) * w_t * t
        toe = w_t * t + (1 - w_t) * w_a * a
        if not lock:
            # The foot is turned by half as much as its two ends ask for.
            ankle, toe = (3 * ankle + toe) / 4, (ankle + 3 * toe) / 4
        displacements[:, leg, 0], displacements[:, leg, 1] = ankle / scale, toe / scale
    return displacements, touching


def one_joint(
    x: Reals,
    f: Reals,
    up: int,
    fps: float,
    given: Mask | None,
    lock: bool,  # noqa: FBT001
) -> tuple[Reals, Reals, Mask]:
    """Return displacements `(frames, 3)` of a joint, their weights and the contacts `(frames,)`; all in centimetres."""
    frames = len(x)
    known: Mask = np.asarray(np.isfinite(f).all(axis=1))
    none = np.zeros((frames, 3)), np.zeros(frames), np.zeros(frames, np.bool_)
    if not known.any():
        return none
    f = paths.completed(f, known)
    x = paths.completed(x, np.asarray(np.isfinite(x).all(axis=1)), f)
    y, noise = paths.estimated(x, f)
    if given is None:
        upright = y if up >= 0 else -y
        touching = contacts.found(upright, known, noise, up % 3, fps)
    else:
        touching = given & known
    held = touching.copy()
    target = f.copy()
    for start, end in runs(touching):
        target[start:end] = smoothed_target(y[start:end], noise, fps)
        if lock:
            hold(y, target, held, (start, end), noise, up % 3, fps)
    away = target - f
    length = np.linalg.norm(away, axis=1)
    away *= np.minimum(1, FARTHEST / np.where(length > FARTHEST, length, FARTHEST))[:, None]
    away[~held] = 0
    return *blended(away, held, fps), held


def smoothed_target(y: Reals, noise: float, fps: float) -> Reals:
    """Return the smoothest version of a path within a contact that is still the path: it leaves it by a part of the noise."""
    for sigma in SIGMAS:
        if sigma > ALWAYS and sigma * fps > MOST_FRAMES:
            continue
        smoothed = low_passed(y, sigma * fps)
        if np.mean((smoothed - y) ** 2) <= (FIT * noise) ** 2:
            return smoothed
    return y


def hold(
    y: Reals, target: Reals, held: Mask, contact: tuple[int, int], noise: float, up: int, fps: float
) -> None:
    """Lock a contact: horizontally the target is the median of the path, in pieces if the foot moves too far."""
    sides = [axis for axis in range(3) if axis != up]
    shortest = max(contacts.FEWEST, int(np.ceil(SHORTEST_HOLD * fps)))
    gap = max(1, round(STEP * fps))
    speed = np.linalg.norm(np.gradient(y, axis=0), axis=1)
    waiting = [contact]
    while waiting:
        start, end = waiting.pop()
        if end - start < shortest:
            held[start:end] = False
            continue
        piece = y[start:end, sides]
        reach = float(np.linalg.norm(piece.max(axis=0) - piece.min(axis=0)))
        if reach <= RANGE + RANGE_NOISE * noise:
            target[start:end, sides] = np.median(piece, axis=0)
            continue
        peak = start + int(np.argmax(speed[start:end]))
        first, last = max(start, peak - gap // 2), min(end, peak - gap // 2 + gap)
        held[first:last] = False
        waiting += [(start, first), (last, end)]


def blended(away: Reals, held: Mask, fps: float) -> tuple[Reals, Reals]:
    """Continue displacements beyond their contacts.

    Before and after a contact the displacement of its end fades out with the weight `1 − 3u² + 2u³`, `u` the time from it in `FADE`; between
    contacts that are close to each other it is interpolated.

    Returns
    -------
    displacements : array (frames, 3)
    weights : array (frames,)
        1 in contacts, between 0 and 1 beside them.
    """
    moved, weights = away.copy(), held.astype(np.float64)
    fade = FADE * fps
    for start, end in runs(~held):
        before, after = start > 0, end < len(held)
        frames = np.arange(start, end)
        if before and after and end - start <= BRIDGE * fps:
            u = ((frames - start + 1) / (end - start + 1))[:, None]
            moved[start:end] = (1 - u) * away[start - 1] + u * away[end]
            weights[start:end] = 1
            continue
        if before:
            u = np.minimum((frames - start + 1) / fade, 1)
            near = u < 1
            moved[frames[near]] = away[start - 1]
            weights[frames[near]] = (1 - 3 * u**2 + 2 * u**3)[near]
        if after:
            u = np.minimum((end - frames) / fade, 1)
            near = u < 1
            moved[frames[near]] = away[end]
            weights[frames[near]] = (1 - 3 * u**2 + 2 * u**3)[near]
    return moved, weights
