"""Compression of recordings to a tolerance, beside plain small formats of quaternions."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from quatfilt._typing import Array
from quatfilt.evaluation.clips import Clip
from quatfilt.geodesics.compress import compress
from quatfilt.motion.motion import Motion
from quatfilt.motion.skeleton import Skeleton
from quatfilt.rotations.quaternion import geodesic_distance, multiply, normalize

COMPRESSED_CLIPS = {
    "02_05": "punch",
    "03_03": "walk on uneven terrain",
    "05_19": "dance",
    "07_01": "walk",
    "09_12": "walk to all sides",
    "14_02": "boxing",
    "14_06": "jumping jacks, jog, squats, stretches",
    "14_34": "climb a ladder",
    "16_02": "jump",
    "86_09": "walk, sit, look, stand up",
}
"""Recordings of CMU; the method was tried on others."""

TOLERANCE = np.radians(0.1)
"""Of the table: rotation angle, radians."""

SWEPT = tuple(np.radians([0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0]).tolist())
"""Of the curve."""

VERTEX = 3.0
"""Centimetres from a bone to the point whose error is measured, as ACL does it."""

VERTEX_ERROR = 0.01
"""Centimetres: ACL's default threshold."""

RATE = 24.0
"""Frames per second of the recordings that ACL publishes figures of."""

_LADDER = 24
"""Budgets that are tried until that threshold holds, each smaller by √2."""

_REPEATS = 3
"""Timings, of which the shortest counts."""


@dataclass(frozen=True)
class Outcome:
    """What a way of storing made of a clip."""

    clip: str
    way: str
    frames: int
    raw_bytes: int
    bytes: int
    angle_max: float
    """Degrees."""
    angle_mean: float
    """Degrees."""
    vertex_max: float
    """Centimetres."""
    vertex_99: float
    """Centimetres: 99th percentile over all bones, points and frames."""
    write_seconds: float
    read_seconds: float

    @property
    def ratio(self) -> float:
        """How many times as large float32 quaternions are."""
        return self.raw_bytes / self.bytes


def run(
    clips: Sequence[Clip], *, progress: Callable[[int, int], None] = lambda _done, _total: None
) -> tuple[list[Outcome], list[Outcome], dict[float, float]]:
    """Measure everything.

    Parameters
    ----------
    clips : sequence of Clip
        Recordings.
    progress : callable
        Hears how many clips are done, and of how many.

    Returns
    -------
    list of Outcome
        Every clip in every way.
    list of Outcome
        Every clip at 24 frames per second, to ACL's threshold.
    dict
        From tolerances in radians to the ratio over all clips.
    """
    outcomes, as_acl = [], []
    sizes = dict.fromkeys(SWEPT, 0)
    raw = 0
    for done, clip in enumerate(clips):
        motion = clip.motion
        q = motion.rotations.astype(np.float32)
        outcomes += [_outcome(clip, way, q, store) for way, store in WAYS.items()]
        as_acl.append(_to_a_vertex_error(clip))
        raw += q.nbytes
        for tolerance in SWEPT:
            sizes[tolerance] += compress(q, tolerance=tolerance).nbytes
        progress(done + 1, len(clips))
    return outcomes, as_acl, {tolerance: raw / size for tolerance, size in sizes.items()}


Stored = tuple[int, Array, float, float]
"""Bytes, what comes back, seconds to write and to read."""


def _compressed(q: Array, tolerance: float | Array = TOLERANCE) -> Stored:
    small = compress(q, tolerance=tolerance)
    write = _shortest(lambda: compress(q, tolerance=tolerance))
    return small.nbytes, small.decompress(), write, _shortest(small.decompress)


def _float16(q: Array) -> Stored:
    small = q.astype(np.float16)
    write = _shortest(lambda: q.astype(np.float16))
    return small.nbytes, normalize(small.astype(q.dtype)), write, _shortest(lambda: small.astype(q.dtype))


def _smallest_three(q: Array) -> Stored:
    """Return 48 bits per quaternion: which component is the largest, and 15 bits of each of the others."""
    numbers, largest = _to_48_bits(q)
    write = _shortest(lambda: _to_48_bits(q))
    read = _shortest(lambda: _from_48_bits(numbers, largest))
    return 6 * (q.size // 4), _from_48_bits(numbers, largest).astype(q.dtype), write, read


_STEPS = (1 << 15) - 1
"""Of 15 bits."""


def _to_48_bits(q: Array) -> tuple[NDArray[np.uint16], NDArray[np.intp]]:
    largest = np.abs(q).argmax(axis=-1)[..., None]
    signed = q * np.where(np.take_along_axis(q, largest, -1) < 0, -1, 1)
    others = np.take_along_axis(signed, np.arange(1, 4) + largest & 3, -1)
    return np.rint((others / np.sqrt(0.5) + 1) / 2 * _STEPS).astype(np.uint16), largest


def _from_48_bits(numbers: NDArray[np.uint16], largest: NDArray[np.intp]) -> Array:
    others = (numbers / _STEPS * 2 - 1) * np.sqrt(0.5)
    q = np.empty((*numbers.shape[:-1], 4))
    np.put_along_axis(q, np.arange(1, 4) + largest & 3, others, -1)
    np.put_along_axis(q, largest, np.sqrt(np.maximum(1 - (others**2).sum(-1, keepdims=True), 0)), -1)
    return q


OURS, FLOAT16, SMALLEST = "quatfilt.compress, 0.1°", "float16", "48 bits, smallest three"

WAYS: dict[str, Callable[[Array], Stored]] = {
    OURS: _compressed,
    SMALLEST: _smallest_three,
    FLOAT16: _float16,
}
"""Of storing quaternions."""


def _outcome(clip: Clip, way: str, q: Array, store: Callable[[Array], Stored]) -> Outcome:
    size, back, write, read = store(q)
    angles = np.degrees(geodesic_distance(q.astype(np.float64), back.astype(np.float64)))
    vertices = vertex_errors(clip.motion.skeleton, q, back)
    return Outcome(
        clip.name,
        way,
        len(q),
        q.nbytes,
        size,
        float(np.nanmax(angles)),
        float(np.nanmean(angles)),
        float(np.nanmax(vertices)),
        float(np.nanpercentile(vertices, 99)),
        write,
        read,
    )


def _to_a_vertex_error(clip: Clip) -> Outcome:
    """Compress a clip at 24 frames per second until the points next to the bones are as exact as ACL's."""
    motion = clip.motion
    q = motion.rotations[:: max(round(motion.fps / RATE), 1)].astype(np.float32)
    lengths = VERTEX + reach(motion.skeleton)
    outcome = None
    for rung in range(_LADDER):
        tolerance = np.minimum(VERTEX_ERROR * 2.0 ** (-rung / 2) / lengths, np.pi)
        outcome = _outcome(clip, f"{VERTEX_ERROR:g} cm", q, partial(_compressed, tolerance=tolerance))
        if outcome.vertex_max <= VERTEX_ERROR:
            break
    if outcome is None or outcome.vertex_max > VERTEX_ERROR:
        raise ValueError(
            f"{clip.name}: expected an error below {VERTEX_ERROR} cm at some tolerance, got none"
        )
    return outcome


def reach(skeleton: Skeleton) -> Array:
    """Return the length of the longest chain of bones below each joint, in centimetres, ``(joints,)``."""
    lengths = np.linalg.norm(skeleton.offsets, axis=-1) * skeleton.centimetres_per_unit
    result = np.zeros(len(skeleton))
    for joint in range(len(skeleton) - 1, -1, -1):
        parent = skeleton.parents[joint]
        if parent >= 0:
            result[parent] = max(result[parent], result[joint] + lengths[joint])
    return result


def vertex_errors(skeleton: Skeleton, q: Array, back: Array) -> Array:
    """Return how far points 3 cm from each bone, along each axis of its joint, are off: ``(frames, joints, 3)``, centimetres."""
    return np.asarray(np.linalg.norm(_vertices(skeleton, q) - _vertices(skeleton, back), axis=-1))


def _vertices(skeleton: Skeleton, q: Array) -> Array:
    q = q.astype(np.float64)
    still = np.zeros((len(q), 3))
    positions = Motion(q, still, fps=1, skeleton=skeleton).positions() * skeleton.centimetres_per_unit
    turned = q.copy()
    for joint, parent in enumerate(skeleton.parents.tolist()):
        if parent >= 0:
            turned[:, joint] = multiply(turned[:, parent], q[:, joint])
    w, x, y, z = np.moveaxis(normalize(turned), -1, 0)
    axes = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)],
            [2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)],
            [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
    return np.asarray(positions[:, :, None] + VERTEX * np.moveaxis(axes, (0, 1), (2, 3)))


def _shortest(call: Callable[[], object]) -> float:
    seconds = []
    for _ in range(_REPEATS):
        start = time.perf_counter()
        call()
        seconds.append(time.perf_counter() - start)
    return min(seconds)


__all__ = [
    "COMPRESSED_CLIPS",
    "FLOAT16",
    "OURS",
    "RATE",
    "SMALLEST",
    "SWEPT",
    "TOLERANCE",
    "VERTEX",
    "VERTEX_ERROR",
    "WAYS",
    "Outcome",
    "reach",
    "run",
    "vertex_errors",
]
