"""The clips that a report compares, checked against each other."""

from dataclasses import dataclass

from numpy.typing import ArrayLike

from quatfilt import _validation
from quatfilt.motion.metrics import _samples
from quatfilt.motion.metrics._samples import Values
from quatfilt.motion.motion import Motion

_SAME_RATE = 0.01
"""Files round their frame times: rates that differ by less are the same."""


@dataclass(frozen=True)
class Side:
    """One of the clips."""

    rotations: Values
    """``(frames, joints, 4)``; NaN where samples are missing."""
    names: tuple[str, ...]
    fps: float | None
    motion: Motion | None


def sides(
    before: Motion | ArrayLike,
    after: Motion | ArrayLike,
    reference: Motion | ArrayLike | None,
    *,
    fps: float | None,
    scalar_first: bool,
) -> tuple[Side, ...]:
    """Return the clips, two or three, of the same kind, joints, frames and rate."""
    rate = None if fps is None else _validation.number(fps, "fps", above=0)
    first = _side(before, "before", rate, scalar_first=scalar_first)
    others = {"after": after} if reference is None else {"after": after, "reference": reference}
    result = [first]
    for name, value in others.items():
        if isinstance(value, Motion) != (first.motion is not None):
            kind = "a Motion" if first.motion is not None else "rotations"
            raise TypeError(f"{name}: expected {kind} as before, got {type(value).__name__}")
        side = _side(value, name, rate, scalar_first=scalar_first)
        if side.motion is not None and side.names != first.names:
            lacking = [joint for joint in first.names if joint not in side.names]
            got = f"none called {lacking[0]!r}" if lacking else f"{len(side.names)} in another order"
            raise ValueError(f"{name}: expected the joints of before, got {got}")
        if side.rotations.shape != first.rotations.shape:
            raise ValueError(
                f"{name}: expected the shape of before, {first.rotations.shape}, got {side.rotations.shape}"
            )
        rates = first.fps or 0.0, side.fps or 0.0
        if abs(rates[1] - rates[0]) > _SAME_RATE * rates[0]:
            raise ValueError(f"{name}: expected the frame rate of before, {rates[0]:g}, got {rates[1]:g}")
        result.append(side)
    return tuple(result)


def _side(value: Motion | ArrayLike, name: str, fps: float | None, *, scalar_first: bool) -> Side:
    if isinstance(value, Motion):
        rate = value.fps if fps is None else fps
        motion = value if fps is None else value.replace(fps=fps)
        rotations, _ = _samples.clip(value.rotations, name, scalar_first=True)
        return Side(rotations, tuple(value.skeleton.names), rate, motion)
    rotations, _ = _samples.clip(value, name, scalar_first=scalar_first)
    return Side(rotations, tuple(f"joint {joint}" for joint in range(rotations.shape[1])), fps, None)


__all__ = ["Side", "sides"]
