"""Every check of what users pass in, and every message.

Arrays leave this module native, C-contiguous, aligned, float32 or float64, and scalar first.
"""

import math
from collections.abc import Collection, Mapping
from types import MappingProxyType
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from quatfilt import _backend
from quatfilt._typing import Array

_FAR_FROM_UNIT = 0.1
"""A norm that differs from 1 by more is no rounding error: such data are not unit quaternions."""

_LONGEST_REACH = 5000
"""Frames, weighted: with longer masks, or a smaller sum of their weights, rotations would move by more turns than sine
and cosine take exactly in float32."""

_LOWEST_FREQUENCY = 1e-6
"""Periods per frame: the coefficients of filters for lower ones have lost too many digits."""

_WIDEST_INTEGERS = "biu"

_Choice = TypeVar("_Choice", bound=str)


def floats(value: Any, name: str) -> Array:
    """Return `value` as a native float32 or float64 array, without a copy where it already is one."""
    if _is_rotation(value):  # SciPy's, scalar last
        value = np.roll(value.as_quat(), 1, axis=-1)
    elif hasattr(value, "__dlpack__") and not hasattr(value, "__array__"):
        value = np.from_dlpack(value)
    try:
        array = np.asarray(value)
    except ValueError as error:
        raise ValueError(f"{name}: expected a rectangular array of numbers ({error})") from None
    if array.dtype.kind in _WIDEST_INTEGERS:
        dtype: np.dtype[Any] = np.dtype(np.float64)
    elif array.dtype.kind == "f":
        dtype = np.dtype(np.float32 if array.dtype.itemsize <= 4 else np.float64)
    else:
        raise TypeError(f"{name}: expected real numbers, got dtype {array.dtype}")
    return np.require(array, dtype, ("C_CONTIGUOUS", "ALIGNED"))


def _scalar_first(array: Array, *, scalar_first: bool) -> Array:
    return array if scalar_first else np.ascontiguousarray(np.roll(array, 1, axis=-1))


def scalar_order(array: Array, *, scalar_first: bool) -> Array:
    """Return quaternions that are scalar first in the order that the caller asked for."""
    return array if scalar_first else np.ascontiguousarray(np.roll(array, -1, axis=-1))


def quaternions(value: Any, name: str, *, scalar_first: bool = True) -> Array:
    """Return `value` as an array ``(..., 4)``, scalar first."""
    array = floats(value, name)
    if array.ndim < 1 or array.shape[-1] != 4:
        raise ValueError(f"{name}: expected shape (..., 4), got {array.shape}")
    # SciPy's rotations were scalar last by themselves; `scalar_first` then speaks of the result alone.
    return _scalar_first(array, scalar_first=scalar_first or _is_rotation(value))


def _is_rotation(value: Any) -> bool:
    return hasattr(value, "as_quat")


def vectors(value: Any, name: str) -> Array:
    """Return `value` as an array ``(..., 3)``."""
    array = floats(value, name)
    if array.ndim < 1 or array.shape[-1] != 3:
        raise ValueError(f"{name}: expected shape (..., 3), got {array.shape}")
    return array


def clip(value: Any, name: str = "rotations", *, scalar_first: bool = True) -> tuple[Array, int]:
    """Return `value` as ``(frames, joints, 4)``, and how many of its samples are missing.

    Raises
    ------
    ValueError
        For another shape, and for samples that are neither missing nor near unit length.
    """
    array = quaternions(value, name, scalar_first=scalar_first)
    if array.ndim not in (2, 3):
        raise ValueError(f"{name}: expected shape (frames, joints, 4) or (frames, 4), got {array.shape}")
    array = array.reshape(array.shape[0], -1 if array.size else math.prod(array.shape[1:-1]), 4)
    missing, worst, index = _backend.ops().scan(array)
    if worst > _FAR_FROM_UNIT:
        frame, joint = divmod(index, array.shape[1])
        norm = math.hypot(*array[frame, joint].tolist())
        raise ValueError(
            f"{name}: expected unit quaternions, got norm {norm:.6g} at frame {frame}, joint {joint}",
        )
    return array, missing


def pose(value: Any, like: Array | None, *, scalar_first: bool) -> Array:
    """Return `value` as ``(joints, 4)`` or ``(4,)``: the shape and dtype of `like`, the first pose, if there was one."""
    array = quaternions(value, "pose", scalar_first=scalar_first)
    if array.ndim not in (1, 2):
        raise ValueError(f"pose: expected shape (joints, 4) or (4,), got {array.shape}")
    if like is not None and array.shape != like.shape:
        raise ValueError(f"pose: expected shape {like.shape} as in the first push, got {array.shape}")
    if like is not None and array.dtype != like.dtype:
        raise TypeError(f"pose: expected dtype {like.dtype} as in the first push, got {array.dtype}")
    rows = array.reshape(1, -1, 4)
    _, worst, joint = _backend.ops().scan(rows)
    if worst > _FAR_FROM_UNIT:
        norm = math.hypot(*rows[0, joint].tolist())
        raise ValueError(f"pose: expected unit quaternions, got norm {norm:.6g} at joint {joint}")
    return array


def pair(a: Array, b: Array, name_a: str, name_b: str) -> tuple[Array, Array]:
    """Return two arrays of rows broadcast against each other, of one dtype, C-contiguous."""
    dtype = np.result_type(a.dtype, b.dtype)
    try:
        shape = np.broadcast_shapes(a.shape, b.shape)
    except ValueError:
        raise ValueError(
            f"{name_b}: expected a shape that broadcasts with {name_a}'s {a.shape}, got {b.shape}",
        ) from None
    return (
        np.require(np.broadcast_to(a, shape), dtype, ("C_CONTIGUOUS", "ALIGNED")),
        np.require(np.broadcast_to(b, shape), dtype, ("C_CONTIGUOUS", "ALIGNED")),
    )


def number(
    value: Any,
    name: str,
    *,
    above: float | None = None,
    at_least: float | None = None,
    at_most: float | None = None,
    infinite: bool = False,
) -> float:
    """Return `value` as a float within its bounds; finite, unless it may be `infinite`."""
    expected = "a number" + _bounds(above, at_least, at_most)
    if isinstance(value, (bool, np.bool_, str)) or not np.isscalar(value):
        raise TypeError(f"{name}: expected {expected}, got {type(value).__name__}")
    try:
        result = float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        raise TypeError(f"{name}: expected {expected}, got {type(value).__name__}") from None
    if (
        math.isnan(result)
        or not (infinite or math.isfinite(result))
        or not _within(result, above, at_least, at_most)
    ):
        raise ValueError(f"{name}: expected {expected}, got {value!s}")
    return result


def integer(value: Any, name: str, *, at_least: int | None = None, at_most: int | None = None) -> int:
    """Return `value` as an int within its bounds."""
    expected = "an integer" + _bounds(None, at_least, at_most)
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, (int, np.integer)):
        raise TypeError(f"{name}: expected {expected}, got {type(value).__name__}")
    result = int(value)
    if not _within(result, None, at_least, at_most):
        raise ValueError(f"{name}: expected {expected}, got {value}")
    return result


def odd(value: Any, name: str) -> int:
    """Return `value` as an odd int of at least 1."""
    result = integer(value, name, at_least=1)
    if result % 2 == 0:
        raise ValueError(f"{name}: expected an odd number, got {result}")
    return result


def choice(
    value: Any,
    name: str,
    options: tuple[_Choice, ...],
    *,
    elsewhere: Mapping[str, str] = MappingProxyType({}),
) -> _Choice:
    """Return `value` if it is one of `options`; `elsewhere` tells why what other functions take will not do here."""
    for option in options:
        if isinstance(value, str) and value == option:
            return option
    reason = elsewhere.get(value) if isinstance(value, str) else None
    expected = f"{name}: expected one of {', '.join(map(repr, options))}, got {value!r}"
    raise ValueError(f"{expected}: {reason}" if reason else expected)


def known(value: Any, name: str, names: Collection[str], expected: str) -> str:
    """Return `value` if it is one of many names; `expected` says of which."""
    if isinstance(value, str) and value in names:
        return value
    raise ValueError(f"{name}: expected {expected}, got {value!r}")


def per_joint(
    value: Any,
    name: str,
    joints: int,
    *,
    above: float | None = None,
    at_least: float | None = None,
    at_most: float | None = None,
    infinite: bool = False,
) -> NDArray[np.float64]:
    """Return a number, or one number per joint, as a float64 array ``(joints,)``."""
    bounds = {"above": above, "at_least": at_least, "at_most": at_most}
    if np.isscalar(value):
        return np.full(joints, number(value, name, **bounds, infinite=infinite))
    array = floats(value, name).astype(np.float64)
    if array.ndim == 0:
        return np.full(joints, number(array.item(), name, **bounds, infinite=infinite))
    if array.shape != (joints,):
        raise ValueError(f"{name}: expected a number or one per joint, shape ({joints},), got {array.shape}")
    for joint, one in enumerate(array):
        number(one, f"{name}[{joint}]", **bounds, infinite=infinite)
    return array


def frequencies(value: Any, name: str, joints: int, fps: float) -> NDArray[np.float64]:
    """Return a frequency below the Nyquist frequency, or one per joint, as a float64 array ``(joints,)``."""
    array = per_joint(value, name, joints, above=0)
    lowest, nyquist = _LOWEST_FREQUENCY * fps, fps / 2
    for joint, one in enumerate(array):
        if not lowest <= one < nyquist:
            place = name if np.ndim(value) == 0 else f"{name}[{joint}]"
            raise ValueError(
                f"{place}: expected a number of at least {lowest:g} and below the Nyquist frequency "
                f"fps / 2 = {nyquist:g}, got {one:g}"
            )
    return array


def mask(value: Any, name: str) -> NDArray[np.float64]:
    """Return `value` as weights ``(2k + 1,)``, the largest of them 1 or −1."""
    array = floats(value, name).astype(np.float64)
    if array.ndim != 1 or len(array) % 2 == 0:
        raise ValueError(f"{name}: expected an odd number of weights, shape (2k + 1,), got {array.shape}")
    if not np.isfinite(array).all():
        raise ValueError(f"{name}: expected finite weights")
    largest = np.abs(array).max()
    array = array / (largest or 1)
    reach = np.abs(array) @ np.abs(np.arange(len(array)) - len(array) // 2)
    if reach > _LONGEST_REACH * abs(array.sum()) or largest == 0:
        raise ValueError(f"{name}: expected weights whose sum is not near 0, got {array.sum() * largest:g}")
    return array


def interval(
    value: Any, name: str, *, at_least: float | None = None, at_most: float | None = None
) -> tuple[float, float]:
    """Return two numbers `(low, high)`, in this order and within their bounds."""
    try:
        low, high = value
    except (TypeError, ValueError):
        raise TypeError(f"{name}: expected two numbers (low, high), got {value!r}") from None
    low = number(low, f"{name}[0]", at_least=at_least, at_most=at_most)
    high = number(high, f"{name}[1]", at_least=at_least, at_most=at_most)
    if low > high:
        raise ValueError(f"{name}: expected two numbers (low, high) in this order, got {value!r}")
    return low, high


def times(value: Any, name: str, frames: int) -> NDArray[np.float64]:
    """Return strictly increasing times, one per frame."""
    array = np.asarray(floats(value, name), np.float64)
    if array.shape != (frames,):
        raise ValueError(f"{name}: expected one time per frame, shape ({frames},), got {array.shape}")
    _finite(array, name)
    steps = np.flatnonzero(array[1:] <= array[:-1])
    if steps.size:
        at = int(steps[0])
        raise ValueError(
            f"{name}: expected strictly increasing times, got {array[at + 1]:g} after {array[at]:g} at index {at + 1}"
        )
    return array


def times_within(value: Any, name: str, span: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return times ``(n,)`` from the first to the last of `span`."""
    array = np.asarray(floats(value, name), np.float64)
    if array.ndim != 1:
        raise ValueError(f"{name}: expected shape (n,), got {array.shape}")
    _finite(array, name)
    if not span.size and array.size:
        raise ValueError(f"{name}: expected no times, since there are no frames, got {array.size}")
    outside = np.flatnonzero((array < span[0]) | (array > span[-1])) if array.size else array
    if outside.size:
        at = int(outside[0])
        raise ValueError(
            f"{name}: expected times from {span[0]:g} to {span[-1]:g}, got {array[at]:.17g} at index {at}"
        )
    return array


def _finite(array: Array, name: str) -> None:
    odd = np.flatnonzero(~np.isfinite(array))
    if odd.size:
        raise ValueError(f"{name}: expected finite times, got {array[odd[0]]} at index {int(odd[0])}")


def generator(value: Any, name: str) -> np.random.Generator:
    """Return a generator of random numbers: `value`, or a new one of that seed."""
    if isinstance(value, np.random.Generator):
        return value
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, (int, np.integer)):
        raise TypeError(f"{name}: expected a numpy.random.Generator or a seed, got {type(value).__name__}")
    return np.random.default_rng(integer(value, name, at_least=0))


def confidence(value: ArrayLike | None, frames: int, joints: int, dtype: np.dtype[Any]) -> Array | None:
    """Return `value`, ``(frames,)`` or ``(frames, joints)`` in 0…1, as ``(frames, joints)``; NaN counts as 0."""
    if value is None:
        return None
    array = floats(value, "confidence")
    if array.shape == (frames,):
        array = np.repeat(array[:, None], joints, axis=1)
    if array.shape != (frames, joints):
        raise ValueError(
            f"confidence: expected shape ({frames},) or ({frames}, {joints}), got {array.shape}",
        )
    return np.require(_shares(array), dtype, ("C_CONTIGUOUS", "ALIGNED"))


def pose_confidence(value: Any, joints: int) -> NDArray[np.float64] | None:
    """Return `value`, a number or one per joint in 0…1, as ``(joints,)``; NaN counts as 0."""
    if value is None:
        return None
    array = floats(value, "confidence").astype(np.float64)
    if array.shape not in ((), (joints,)):
        raise ValueError(
            f"confidence: expected a number or one per joint, shape ({joints},), got {array.shape}"
        )
    return np.ascontiguousarray(np.broadcast_to(_shares(array), joints))


def _shares(confidence: NDArray[Any]) -> NDArray[Any]:
    array = np.where(np.isnan(confidence), 0, confidence)
    if array.size and (array.min() < 0 or array.max() > 1):
        worst = array.min() if array.min() < 0 else array.max()
        raise ValueError(f"confidence: expected values from 0 to 1, got {worst}")
    return array


def _bounds(above: float | None, at_least: float | None, at_most: float | None) -> str:
    parts = [
        f"above {above:g}" if above is not None else "",
        f"of at least {at_least:g}" if at_least is not None else "",
        f"at most {at_most:g}" if at_most is not None else "",
    ]
    text = " and ".join(part for part in parts if part)
    return f" {text}" if text else ""


def _within(value: float, above: float | None, at_least: float | None, at_most: float | None) -> bool:
    return (
        (above is None or value > above)
        and (at_least is None or value >= at_least)
        and (at_most is None or value <= at_most)
    )


def parents(value: ArrayLike, joints: int) -> NDArray[np.int64]:
    """Return `value` as the parents of `joints` joints, read-only: each comes before its child, −1 for a root."""
    array = np.asarray(value)
    if array.size == 0:
        array = array.astype(np.int64)
    if array.dtype.kind not in "iu":
        raise TypeError(f"parents: expected integers, got dtype {array.dtype}")
    if array.shape != (joints,):
        raise ValueError(f"parents: expected one for each of {joints} names, got shape {array.shape}")
    result = array.astype(np.int64)
    for joint, parent in enumerate(result):
        if not -1 <= parent < joint:
            raise ValueError(
                f"parents: expected −1 or the index of a joint before it for joint {joint}, got {parent}"
            )
    result.setflags(write=False)
    return result


def offsets(value: ArrayLike, joints: int) -> NDArray[np.float64]:
    """Return `value` as the offsets of `joints` joints, read-only."""
    array = floats(value, "offsets").astype(np.float64)
    if array.shape != (joints, 3) and not (joints == 0 and array.size == 0):
        raise ValueError(f"offsets: expected shape ({joints}, 3), got {array.shape}")
    if not np.isfinite(array).all():
        raise ValueError("offsets: expected finite numbers")
    array = array.reshape(joints, 3)
    array.setflags(write=False)
    return array


def posed(
    rotations: ArrayLike,
    translation: ArrayLike,
    joint_translations: ArrayLike | None,
    parents: NDArray[np.int64],
) -> tuple[Array, Array, Array | None]:
    """Return rotations, translation and joint translations of a skeleton in motion, of one dtype."""
    q, _ = clip(rotations)
    frames, joints = q.shape[:2]
    if joints != len(parents):
        raise ValueError(f"rotations: expected {len(parents)} joints as in the skeleton, got {joints}")
    moved = floats(translation, "translation")
    if moved.shape != (frames, 3):
        raise ValueError(f"translation: expected shape ({frames}, 3), got {moved.shape}")
    moved = np.require(moved, q.dtype, ("C_CONTIGUOUS", "ALIGNED"))
    if joint_translations is None:
        return q, moved, None
    own = floats(joint_translations, "joint_translations")
    if own.shape != (frames, joints, 3):
        raise ValueError(f"joint_translations: expected shape ({frames}, {joints}, 3), got {own.shape}")
    return q, moved, np.require(own, q.dtype, ("C_CONTIGUOUS", "ALIGNED"))
