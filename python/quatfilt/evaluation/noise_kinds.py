"""Kinds of noise that trackers make, beside white and steady noise.

A kind takes clean rotations and a level σ: the deviation per component of the rotation vector in radians. Unless a kind says otherwise,
a noisy sample is ``q · exp(n / 2)`` with the noise vector `n` in the body frame. Lengths are in frames at every frame rate.
"""

import itertools
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from scipy import ndimage, signal
from scipy.spatial.transform import Rotation

from quatfilt._typing import Array, Mask
from quatfilt.rotations.quaternion import exp, multiply
from quatfilt.rotations.resample import slerp

Rng: TypeAlias = np.random.Generator
Vectors: TypeAlias = Callable[[int, int, Rng], Array]
"""Noise vectors ``(frames, joints, 3)`` of level 1."""


@dataclass(frozen=True)
class Body:
    """A clean clip, and the joints that left/right swaps and flips need.

    Parameters
    ----------
    rotations : ndarray, shape (frames, joints, 4)
        Unit quaternions.
    pairs : sequence of (int, int)
        Joints of the left side and their partners on the right.
    """

    rotations: Array
    pairs: Sequence[tuple[int, int]]

    @classmethod
    def of(cls, rotations: Array, names: Sequence[str]) -> "Body":
        """Pair joints by their names: ``LeftArm`` and ``RightArm``, ``lfemur`` and ``rfemur``."""
        places = {name: joint for joint, name in enumerate(names)}
        pairs = [
            (joint, places[other])
            for name, joint in places.items()
            if (other := _other_side(name)) != name and other in places
        ]
        return cls(rotations, pairs)

    def replaced(self, rotations: Array) -> "Body":
        """Return the same body with other rotations."""
        return Body(rotations, self.pairs)


def _other_side(name: str) -> str:
    if re.match(r"l[a-z]", name):
        return "r" + name[1:]
    return name.replace("Left", "Right")


@dataclass(frozen=True)
class Kind:
    """A kind of noise.

    Parameters
    ----------
    name : str
        Its name in tables.
    says : str
        Its definition, for the page.
    add : callable
        From a body, a level in radians and a random generator to noisy rotations.
    levelled : bool
        Whether the level matters.
    counts : callable
        From the number of frames to those on which errors are measured.
    """

    name: str
    says: str
    add: Callable[[Body, float, Rng], Array]
    levelled: bool = True
    counts: Callable[[int], slice] = lambda _frames: slice(None)


def _disturbed(vectors: Vectors) -> Callable[[Body, float, Rng], Array]:
    def add(body: Body, level: float, rng: Rng) -> Array:
        frames, joints = body.rotations.shape[:2]
        return multiply(body.rotations, exp(level * vectors(frames, joints, rng) / 2))

    return add


def _white(frames: int, joints: int, rng: Rng) -> Array:
    return rng.normal(size=(frames, joints, 3))


def _autoregressive(rho: float) -> Vectors:
    def vectors(frames: int, joints: int, rng: Rng) -> Array:
        steps = _white(frames, joints, rng)
        # The first sample has the variance of all others, so that the noise is stationary.
        steps[1:] *= np.sqrt(1 - rho**2)
        return np.asarray(signal.lfilter([1.0], [1.0, -rho], steps, axis=0))

    return vectors


STRETCH = 100
"""Frames over which the level of `unsteady` and `bad-third` stays."""


def _along_time(choices: Sequence[float]) -> Vectors:
    """Return white noise times one of the factors in each stretch, the same for all joints."""

    def vectors(frames: int, joints: int, rng: Rng) -> Array:
        factors = rng.choice(choices, size=frames // STRETCH + 1)
        return np.asarray(_white(frames, joints, rng) * np.repeat(factors, STRETCH)[:frames, None, None])

    return vectors


def starts(frames: int, probability: float, rng: Rng) -> list[int]:
    """Return the frames in which something begins that begins in each frame with a probability, at least one."""
    found = np.flatnonzero(rng.random(frames) < probability)
    return [int(rng.integers(frames))] if len(found) == 0 else found.tolist()


def _bursts(frames: int, joints: int, rng: Rng) -> Array:
    factor = np.full(frames, 0.3)
    for start in starts(frames, 0.01, rng):
        factor[start : start + 20] = 6 * 0.3
    return np.asarray(_white(frames, joints, rng) * factor[:, None, None])


def _student(frames: int, joints: int, rng: Rng) -> Array:
    return np.asarray(rng.standard_t(3, size=(frames, joints, 3)) / np.sqrt(3))


def _one_axis(frames: int, joints: int, rng: Rng) -> Array:
    return np.asarray(_white(frames, joints, rng) * np.array([0.3, 0.3, 3.0]))


def _low_passed(frames: int, joints: int, rng: Rng) -> Array:
    smoothed = ndimage.gaussian_filter1d(_white(frames + 32, joints, rng), 2.0, axis=0)[16 : frames + 16]
    # A Gaussian of deviation s leaves the share 1/(2 s √π) of the variance.
    return np.asarray(smoothed * np.sqrt(2 * 2.0 * np.sqrt(np.pi)))


white = _disturbed(_white)


def _held(body: Body, level: float, rng: Rng) -> Array:
    noisy = white(body, level, rng)
    return noisy[np.arange(len(noisy)) // 4 * 4]


def _frozen(body: Body, level: float, rng: Rng) -> Array:
    noisy = white(body, level, rng)
    noisy[: len(noisy) // 2] = noisy[0]
    return noisy


def _second_half(frames: int) -> slice:
    return slice(frames // 2, None)


def _swapped(body: Body, level: float, rng: Rng) -> Array:
    return _exchanged(body, white(body, level, rng), rng)


def _exchanged(body: Body, noisy: Array, rng: Rng) -> Array:
    """Exchange left and right of noisy rotations, in place, for 3 to 11 frames at a time."""
    if body.pairs:
        left, right = np.array(body.pairs).T
        for start in starts(len(noisy), 1 / 120, rng):
            run = slice(start, start + int(rng.integers(3, 12)))
            noisy[run, left], noisy[run, right] = noisy[run, right].copy(), noisy[run, left].copy()
    return noisy


def _turned(body: Body, level: float, rng: Rng, joints: Sequence[int], degrees: tuple[float, float]) -> Array:
    """Turn single joints of noisy rotations by an angle about a random axis, for 2 to 9 frames at a time."""
    noisy = _disturbed(_autoregressive(0.8))(body, level, rng)
    for joint in joints:
        for start in starts(len(noisy), 1 / 200, rng):
            axis = rng.normal(size=3)
            turn = np.radians(rng.uniform(*degrees)) * axis / np.linalg.norm(axis)
            run = slice(start, start + int(rng.integers(2, 10)))
            noisy[run, joint] = multiply(noisy[run, joint], exp(turn / 2))
    return noisy


def _runs(body: Body, level: float, rng: Rng) -> Array:
    return _turned(body, level, rng, range(body.rotations.shape[1]), (15.0, 60.0))


def _estimates(body: Body, level: float, rng: Rng) -> Array:
    noisy = _exchanged(body, _runs(body, level, rng), rng)
    for start in starts(len(noisy), 1 / 60, rng):
        noisy[start : start + int(rng.integers(2, 5))] = noisy[start]
    return noisy


def _flips(body: Body, level: float, rng: Rng) -> Array:
    return _turned(body, level, rng, [0], (100.0, 170.0))


def _steps(body: Body, _level: float, _rng: Rng) -> Array:
    degrees = Rotation.from_quat(body.rotations.reshape(-1, 4), scalar_first=True).as_euler(
        "ZXY", degrees=True
    )
    stepped = Rotation.from_euler("ZXY", np.round(degrees), degrees=True).as_quat(scalar_first=True)
    return np.asarray(stepped.reshape(body.rotations.shape))


def knots(frames: int, rng: Rng) -> Array:
    """Return the times of a 30 Hz clock in frames of 100 Hz, and both ends of the clip.

    The clock ticks every 10/3 frames; one tick of seven is dropped, but no two in a row.
    """
    ticks = np.arange(rng.uniform(0, 10 / 3), frames - 1, 10 / 3)
    kept: Mask = np.asarray(rng.random(len(ticks)) > 1 / 7)
    kept[1:] |= ~kept[:-1]
    return np.unique([0.0, *ticks[kept], frames - 1.0])


def _interpolated(body: Body, level: float, rng: Rng) -> Array:
    frames = np.arange(len(body.rotations))
    times = knots(len(frames), rng)
    seen = white(body.replaced(slerp(body.rotations, frames, times)), level, rng)
    return slerp(seen, times, frames)


SINGLE: tuple[Kind, ...] = (
    Kind("white", "independent normal vectors", white),
    Kind("ar5", "AR(1) in time, coefficient .5, stationary", _disturbed(_autoregressive(0.5))),
    Kind("ar8", "AR(1) in time, coefficient .8, stationary", _disturbed(_autoregressive(0.8))),
    Kind(
        "unsteady",
        f"stretches of {STRETCH} frames at 2σ or σ/4, by chance",
        _disturbed(_along_time([2, 0.25])),
    ),
    Kind(
        "bad-third",
        f"stretches of {STRETCH} frames, 1.5σ in one of three and σ/10 else, by chance",
        _disturbed(_along_time([1.5, 0.1, 0.1])),
    ),
    Kind("bursts", ".3σ; in one of 100 frames begin 20 frames at six times that", _disturbed(_bursts)),
    Kind("student", "Student's t with three degrees of freedom over √3", _disturbed(_student)),
    Kind("axis", ".3σ, .3σ and 3σ along x, y and z of the body", _disturbed(_one_axis)),
    Kind("held", "every fourth frame of white noise, four times", _held),
    Kind(
        "frozen",
        "the first half repeats its first frame; the second, white, counts",
        _frozen,
        counts=_second_half,
    ),
    Kind("swaps", "white; in one of 120 frames left and right are exchanged for 3 to 11 frames", _swapped),
    Kind("runs", "ar8; runs of 2 to 9 frames turned by 15° to 60°, in a joint one in 200 frames", _runs),
    Kind(
        "estimates",
        "runs; left and right exchanged as in swaps; in one of 60 frames the pose stays for 2 to 4 frames",
        _estimates,
    ),
    Kind("flips", "ar8; runs of 2 to 9 frames in which the root is turned by 100° to 170°", _flips),
    Kind("steps", "Euler angles rounded to 1°", _steps, levelled=False),
    Kind(
        "low-passed",
        "white noise through a Gaussian of two frames, then scaled to σ",
        _disturbed(_low_passed),
    ),
    Kind(
        "interpolated",
        "white noise on the ticks of a clock, 10/3 or 20/3 frames apart, geodesics between them",
        _interpolated,
    ),
)
"""Kinds of noise, one cause each."""


def _mixed(first: Kind, second: Kind) -> Kind:
    def add(body: Body, level: float, rng: Rng) -> Array:
        each = level / np.sqrt(2)
        return second.add(body.replaced(first.add(body, each, rng)), each, rng)

    return Kind(
        f"{first.name}+{second.name}",
        f"{first.name}, and on it {second.name}, both at σ/√2",
        add,
        counts=second.counts,
    )


def _named(name: str) -> Kind:
    return next(kind for kind in SINGLE if kind.name == name)


MIXTURES: tuple[Kind, ...] = tuple(
    _mixed(_named(first), _named(second))
    for first, second in (("ar5", "bursts"), ("axis", "unsteady"), ("ar8", "swaps"), ("student", "held"))
)
"""Mixtures of two kinds."""

KINDS: dict[str, Kind] = {kind.name: kind for kind in itertools.chain(SINGLE, MIXTURES)}
"""By name, in the order of the table."""

LEVELS = (0.012, 0.04, 0.12)
"""Radians per component."""

__all__ = ["KINDS", "LEVELS", "MIXTURES", "SINGLE", "Body", "Kind"]
