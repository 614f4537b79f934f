"""Compression to a tolerance: one stream of bits, joint by joint, in principal geodesic coordinates.

For each joint it holds what the joint is (3 bits), which samples are missing, the frame of its coordinates, the length of a step, and
as many coordinates as the tolerance needs, each a series of whole numbers. The writer computes what the reader will, measures the largest
error, and takes shorter steps, more coordinates or, in the end, the samples as they are, until the tolerance holds.
"""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from quatfilt._reference._arrays import Mask, Reals
from quatfilt._reference.geodesics.compress import chart, series
from quatfilt._reference.geodesics.compress.arithmetic import Doubles, round_even
from quatfilt._reference.geodesics.compress.bits import Context, Reader, Writer
from quatfilt._reference.geodesics.compress.fit import COMPONENTS, FARTHEST, Fit
from quatfilt._reference.geodesics.compress.numbers import Numbers
from quatfilt._reference.rotations.quaternion import is_missing

PLAIN = 7
"""Kind of a joint whose samples are stored unchanged. Kinds 0 … 3 are that many coordinates in steps, kinds 4 … 6 floats."""

SURE = 1.0 - 1e-9
"""Part of the tolerance that is used: whoever measures again may round otherwise."""

SHORTER = 0.9
"""A step that was too long is made shorter by this factor …"""

ATTEMPTS = 8
"""… so many times, before another coordinate is added."""

LARGEST = float(1 << 46)
"""Numbers of a series are smaller: predictions are computed in 64 bits."""

UNTURNED = np.array([1.0, 0.0, 0.0, 0.0])
"""Axes of a joint that does not move."""

COARSE, FINE = 16, 32
"""Bits of each number of a frame …"""

FINE_BELOW = 1e-3
"""… and the tolerance (radians) below which they are many: 16 bits are off by up to 8e-5 rad."""

STEP_BITS = 20
"""Bits of the length of a step: sign, exponent of float64, and eight bits of the significand."""


@dataclass
class _Joint:
    """Encoded contents of a joint."""

    kind: int
    missing: Mask
    width: int = COARSE
    frame: list[int] = field(default_factory=list)
    step: float = 0.0
    coded: list[tuple[series.Integers, list[int]]] = field(default_factory=list)
    floats: Reals = field(default_factory=lambda: np.zeros(0))
    opposite: bool = False
    error: float = 0.0


class _Contexts:
    """Adaptive contexts of the coder, shared by all joints."""

    def __init__(self) -> None:
        self.missing = (Context(), Context())
        self.ahead = Numbers()
        self.between = Numbers()


def compress(q: Reals, frames: Reals, tolerance: Reals, quantised: bool) -> tuple[bytes, float]:  # noqa: FBT001
    """Compress rotations `(frames, joints, 4)`.

    Parameters
    ----------
    q : array (frames, joints, 4)
        Rotations.
    frames : array (joints, 2, 2, 4)
        Result of `principal_frames`: two frames for each joint; the one that needs fewer coordinates is used.
    tolerance : array (joints,)
        Largest rotation angle between a sample and its decoded value, radians, above 0.
    quantised : bool
        False: coordinates are stored as floats.

    Returns
    -------
    bytes
        The stream.
    float
        The largest error, radians.
    """
    joints = [_joint(q[:, j], frames[j], float(tolerance[j]), quantised=quantised) for j in range(q.shape[1])]
    writer, contexts = Writer(), _Contexts()
    for joint in joints:
        _write(writer, joint, contexts)
    return writer.finish(), max((joint.error for joint in joints), default=0.0)


def decompress(data: bytes, frames: int, joints: int, double: bool) -> Reals:  # noqa: FBT001
    """Return the rotations `(frames, joints, 4)` of a stream, float64 or float32; NaN where samples were missing."""
    dtype: np.dtype[np.floating[Any]] = np.dtype(np.float64) if double else np.dtype(np.float32)
    reader, contexts = Reader(data), _Contexts()
    result = np.full((frames, joints, 4), np.nan, dtype)
    with np.errstate(all="ignore"):  # bytes that nobody compressed may stand for any numbers
        for j in range(joints):
            joint = _read(reader, frames, dtype, contexts)
            result[~joint.missing, j] = _continuous(_rotations(joint, dtype))
    return result


def _joint(samples: Reals, frames: Reals, tolerance: float, *, quantised: bool) -> _Joint:
    missing = is_missing(samples)
    valid = samples[~missing]
    if len(valid):
        bound = min(tolerance, np.pi) * SURE
        width = COARSE if tolerance >= FINE_BELOW else FINE
        path = valid.astype(np.float64)
        fit = Fit(path, frames[0], width)
        if fit.components(bound) == COMPONENTS:
            other = Fit(path, frames[1], width)
            fit = other if other.components(bound) < COMPONENTS else fit
        if fit.farthest < FARTHEST:
            for components in range(fit.components(bound), COMPONENTS + 1):
                found = _within(bound, valid, missing, fit, components, quantised=quantised)
                if found is not None:
                    return found
    return _Joint(PLAIN, missing, floats=valid.ravel())


def _within(
    bound: float, valid: Reals, missing: Mask, fit: Fit, components: int, *, quantised: bool
) -> _Joint | None:
    """Take so many coordinates; None if the bound does not hold."""
    stepped = quantised and components > 0
    step = fit.step(components, bound) if stepped else 0.0
    for _ in range(ATTEMPTS if stepped else 1):
        joint = _Joint(components, missing, fit.width, [number for q in fit.numbers for number in q])
        if stepped:
            joint.step = _storable(step)
            if joint.step == 0.0:  # too small to be stored
                return None
            if fit.farthest * (series.STEP / joint.step) >= LARGEST:
                return None
            numbers = round_even(fit.s[:, :components] * (series.STEP / joint.step)).astype(np.int64)
            joint.coded = [series.differences(column)[:2] for column in numbers.T]
        elif components:
            joint.kind = COMPONENTS + components
            joint.floats = fit.s[:, :components].T.astype(valid.dtype).ravel()
        result = _rotations(joint, valid.dtype)
        joint.error = float(chart.angles(valid.astype(np.float64), result.astype(np.float64)).max())
        if joint.error <= bound:
            joint.opposite = bool(_inner(valid[:1], result[:1])[0] < 0.0)
            return joint
        step *= SHORTER
    return None


def _rotations(joint: _Joint, dtype: np.dtype[np.floating[Any]]) -> Reals:
    """Return the valid samples of a joint, `(n, 4)`, as they come back but for their signs."""
    count = int((~joint.missing).sum())
    if joint.kind == PLAIN or count == 0:
        return joint.floats.reshape(count, 4)
    s = np.zeros((count, COMPONENTS))
    for k, (steps, kernels) in enumerate(joint.coded):
        s[:, k] = series.restored(steps, kernels).astype(np.float64) * (joint.step / series.STEP)
    if len(joint.floats):
        s[:, : joint.kind - COMPONENTS] = joint.floats.reshape(-1, count).T
    centre = chart.from_rounded(joint.frame[:3], joint.width)
    axes = chart.from_rounded(joint.frame[3:], joint.width) if joint.kind else UNTURNED
    path = chart.rotations(s, centre, axes).astype(dtype)
    return -path if joint.opposite else path


def _write(writer: Writer, joint: _Joint, contexts: _Contexts) -> None:
    writer.plain(joint.kind, 3)
    _write_missing(writer, joint.missing, contexts)
    if joint.missing.all():
        return
    if joint.kind != PLAIN:
        writer.plain(int(joint.width == FINE), 1)
        for number in joint.frame if joint.kind else joint.frame[:3]:
            writer.plain(number & (1 << joint.width) - 1, joint.width)
        writer.plain(int(joint.opposite), 1)
    if joint.coded:
        writer.plain(_bits(joint.step) >> 64 - STEP_BITS, STEP_BITS)
    for steps, kernels in joint.coded:
        series.write(writer, steps, kernels, contexts.ahead, contexts.between)
    for bits in joint.floats.view(f"u{joint.floats.itemsize}").tolist():
        writer.plain(bits, 8 * joint.floats.itemsize)


def _read(reader: Reader, frames: int, dtype: np.dtype[np.floating[Any]], contexts: _Contexts) -> _Joint:
    joint = _Joint(reader.plain(3), np.zeros(0, np.bool_))
    joint.missing = _read_missing(reader, frames, contexts)
    count = int((~joint.missing).sum())
    if count == 0:
        return joint
    floats = 4
    if joint.kind != PLAIN:
        joint.width = FINE if reader.plain(1) else COARSE
        joint.frame = [_signed(reader.plain(joint.width), joint.width) for _ in range(6 if joint.kind else 3)]
        joint.opposite = bool(reader.plain(1))
        floats = max(joint.kind - COMPONENTS, 0)
    if 0 < joint.kind <= COMPONENTS:
        joint.step = _from_bits(reader.plain(STEP_BITS) << 64 - STEP_BITS)
        joint.coded = [
            series.read(reader, count, contexts.ahead, contexts.between) for _ in range(joint.kind)
        ]
    bits = [reader.plain(8 * dtype.itemsize) for _ in range(floats * count)]
    joint.floats = np.array(bits, f"u{dtype.itemsize}").view(dtype)
    return joint


def _write_missing(writer: Writer, missing: Mask, contexts: _Contexts) -> None:
    writer.plain(int(missing.any()), 1)
    if missing.any():
        before = 0
        for bit in missing.astype(int).tolist():
            writer.bit(bit, contexts.missing[before])
            before = bit


def _read_missing(reader: Reader, frames: int, contexts: _Contexts) -> Mask:
    missing = np.zeros(frames, np.bool_)
    if reader.plain(1):
        before = 0
        for frame in range(frames):
            missing[frame] = before = reader.bit(contexts.missing[before])
    return missing


def _continuous(path: Reals) -> Reals:
    """Flip signs so that none is opposite to the one before."""
    opposite = np.concatenate([[False], np.logical_xor.accumulate(_inner(path[1:], path[:-1]) < 0.0)])
    return np.where(opposite[:, None], -path, path)


def _inner(a: Reals, b: Reals) -> Doubles:
    (aw, ax, ay, az), (bw, bx, by, bz) = a.astype(np.float64).T, b.astype(np.float64).T
    return np.asarray((aw * bw + ax * bx) + (ay * by + az * bz))


def _signed(number: int, width: int) -> int:
    return number - (1 << width) if number >> width - 1 else number


def _bits(x: float) -> int:
    return int(np.float64(x).view(np.uint64))


def _from_bits(bits: int) -> float:
    return float(np.uint64(bits).view(np.float64))


def _storable(step: float) -> float:
    """Return the largest step that can be stored and is not longer."""
    return _from_bits(_bits(step) >> 64 - STEP_BITS << 64 - STEP_BITS)
