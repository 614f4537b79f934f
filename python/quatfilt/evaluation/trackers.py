"""Recordings of consumer trackers, which have no truth: the automatic method by measures that need none.

Jerk that is left, the slow path, excursions from it, and measurements that were withheld.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy import ndimage

from quatfilt import sampling
from quatfilt._typing import Array, Mask
from quatfilt.denoise import denoise
from quatfilt.errors import FileAccessError
from quatfilt.filters.gaps import fill_gaps
from quatfilt.filters.kalman import kalman
from quatfilt.formats.files import read_motion
from quatfilt.motion.metrics import jerk
from quatfilt.motion.motion import Motion
from quatfilt.presets import PRESETS
from quatfilt.rotations.quaternion import geodesic_distance

FOLDER = "trackers"
"""Where the recordings lie in the data."""

SLOW = 0.25
"""Seconds: deviation of the Gaussian that makes the slow path."""

CLEAR = 0.9
"""Share of the largest eigenvalue from which a slow path is defined."""

LEAST_EXCURSION = 0.5
"""Degrees: joints that leave their slow path by less in 95 % of the frames have no peaks."""

EVERY = 9
"""Of so many measurements one is withheld."""

CAP = 30.0
"""Degrees: larger errors of withheld measurements count as this."""


@dataclass(frozen=True)
class Take:
    """One recording, and the automatic method's result.

    Parameters
    ----------
    name : str
        Name of the file.
    source : str
        What `info` says about its source; empty if every frame was measured.
    before, after : Motion
        The recording and the result.
    flips : int
        Turns of the root by more than 90° in a frame.
    jerk_left, jerk_left_kalman : float
        Jerk of the result over that of the recording: the automatic method and `kalman`.
    slow_moved : float, degrees
        Mean angle between the slow paths.
    masked : float
        Share of the samples without a slow path.
    peaks_kept : float
        95th percentile of the excursion from the slow path, mean over joints.
    change : float, degrees
        Mean angle between recording and result.
    withheld, withheld_plain : float, degrees
        Mean error of withheld measurements, capped at 30°: the automatic method, and geodesics between neighbours.
    speed, acceleration : float
        99th percentiles in the result, rad/s and rad/s².
    presets : mapping
        By name of the preset: jerk_left, slow_moved, peaks_kept and change of its result.
    """

    name: str
    source: str
    before: Motion
    after: Motion
    flips: int
    jerk_left: float
    jerk_left_kalman: float
    slow_moved: float
    masked: float
    peaks_kept: float
    change: float
    withheld: float
    withheld_plain: float
    speed: float
    acceleration: float
    presets: Mapping[str, Mapping[str, float]]


def run(data: Path, *, progress: Callable[[int, int], None] | None = None) -> list[Take]:
    """Clean every recording in ``data/trackers``.

    Raises
    ------
    QuatfiltError
        If there is none, or one does not open.
    """
    paths = files(data)
    takes = []
    for number, path in enumerate(paths):
        takes.append(measured(path.stem, read_motion(path)))
        if progress is not None:
            progress(number + 1, len(paths))
    return takes


def files(data: Path) -> Sequence[Path]:
    """Return the recordings, sorted by name."""
    found = sorted((data / FOLDER).glob("*.bvh"))
    if not found:
        raise FileAccessError(data / FOLDER, "expected recordings of trackers (.bvh) in this folder")
    return found


def measured(name: str, before: Motion) -> Take:
    """Clean a recording and measure the result."""
    q, fps = before.rotations, before.fps
    after = denoise(before)
    source = sampling.recognised(q, fps)
    slow = slow_path(q, SLOW * fps)
    own, masked = compared(q, after.rotations, slow, fps)
    held, plain = withheld(q, source, fps)
    speeds = geodesic_distance(after.rotations[:-1], after.rotations[1:]) * fps
    return Take(
        name=name,
        source=source.says(fps),
        before=before,
        after=after,
        flips=sampling.flips(q),
        **own,
        jerk_left_kalman=jerk_left(q, kalman(q, fps=fps), fps),
        masked=masked,
        withheld=held,
        withheld_plain=plain,
        speed=float(np.percentile(speeds, 99)),
        acceleration=float(np.percentile(accelerations(after.rotations, fps), 99)),
        presets={
            preset: compared(q, denoise(before, preset=preset).rotations, slow, fps)[0] for preset in PRESETS
        },
    )


def compared(q: Array, result: Array, slow: tuple[Array, Mask], fps: float) -> tuple[dict[str, float], float]:
    """Return the measures that need a recording, its slow path and a result alone, and the share of samples without a slow path."""
    path, defined = slow_path(result, SLOW * fps)
    clear = slow[1] & defined
    measures = {
        "jerk_left": jerk_left(q, result, fps),
        "slow_moved": _mean(np.degrees(geodesic_distance(slow[0], path))[clear]),
        "peaks_kept": peaks_kept(q, result, slow[0], clear),
        "change": _mean(np.degrees(geodesic_distance(q, result))),
    }
    return measures, 1 - float(clear.mean())


def jerk_left(before: Array, after: Array, fps: float) -> float:
    """Return the jerk of a result over that of the recording; 1 for recordings without any."""
    rough = float(jerk(before, fps=fps))
    return float(jerk(after, fps=fps)) / rough if rough > 0 else 1.0


def slow_path(q: Array, sigma: float) -> tuple[Array, Mask]:
    """Return the slow path of a clip, and where it is defined.

    The eigenvector of the largest eigenvalue of `Σ g q qᵀ`, which knows no signs; defined where that eigenvalue's share is at least
    `CLEAR`. Means of components would cancel out near half a turn.
    """
    squares = q[..., :, None] * q[..., None, :]
    values, vectors = np.linalg.eigh(ndimage.gaussian_filter1d(squares, sigma, axis=0))
    return np.ascontiguousarray(vectors[..., -1]), np.asarray(values[..., -1] >= CLEAR * values.sum(axis=-1))


def peaks_kept(before: Array, after: Array, slow: Array, clear: Mask) -> float:
    """Return the mean over the joints of the 95th percentile of the excursion from the slow path, after over before."""
    excursions = [np.where(clear, np.degrees(geodesic_distance(slow, x)), np.nan) for x in (before, after)]
    kept = []
    for joint in np.flatnonzero(clear.any(axis=0)):
        was, now = (float(np.nanpercentile(excursion[:, joint], 95)) for excursion in excursions)
        if was > LEAST_EXCURSION:
            kept.append(now / was)
    return _mean(np.array(kept)) if kept else 1.0


def withheld(q: Array, source: sampling.Source, fps: float) -> tuple[float, float]:
    """Return the mean error of measurements that were withheld, cleaned and plainly interpolated, in degrees."""
    frames = np.floor(source.times).astype(np.intp)
    known = sampling.at_measurements(q, source)
    gone = np.zeros(len(frames), np.bool_)
    gone[EVERY // 2 :: EVERY] = True
    holes = known.copy()
    holes[gone] = np.nan
    plain, _ = fill_gaps(holes)
    errors = [
        np.minimum(np.degrees(geodesic_distance(known[gone], filled[gone])), CAP)
        for filled in (denoise(holes, fps=fps / source.spacing), plain)
    ]
    return _mean(errors[0]), _mean(errors[1])


def accelerations(q: Array, fps: float) -> Array:
    """Return the differences of the speed from frame to frame, rad/s²."""
    speeds = geodesic_distance(q[:-1], q[1:]) * fps
    return np.abs(np.diff(speeds, axis=0)) * fps


def _mean(values: Array) -> float:
    return float(np.mean(values)) if np.size(values) else 0.0


__all__ = ["FOLDER", "Take", "files", "measured", "run"]
