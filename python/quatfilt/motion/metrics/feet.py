"""Feet on the ground: when they touch it, and how far they slide on it."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from quatfilt import _validation
from quatfilt._typing import Mask
from quatfilt.motion.legs import find_legs, foot_joints, pelvis, up_axis
from quatfilt.motion.metrics import _samples
from quatfilt.motion.metrics._samples import PER, Per, Values

if TYPE_CHECKING:
    from quatfilt.motion.motion import Motion

_SLOW = 15.0
"""Centimetres per second: a joint on the ground is slower."""

_LOW = 5.0
"""Centimetres: a joint on the ground is within this of its lowest height."""

_FEWEST = 3
"""Frames: a shorter touch is none."""

_LEG = 90.0
"""Centimetres: length of the leg of a skeleton whose unit is not known."""

_SHORT_LEG, _LONG_LEG = 60.0, 120.0
"""Centimetres: a leg outside of these is not measured in centimetres."""

Up = Literal["auto", "x", "y", "z"]


def foot_contacts(motion: "Motion", *, feet: Sequence[str] | None = None, up: Up = "auto") -> Mask:
    """Find when the feet touch the ground.

    A foot joint touches it while it is slower than 15 cm/s and within 5 cm of its lowest height, for at least 3 frames.

    Parameters
    ----------
    motion : Motion
        Motion with a skeleton whose unit is known (`Skeleton.centimetres_per_unit`). Otherwise lengths count as centimetres, multiplied by
        `foot_scale`.
    feet : sequence of str or None, default None
        Names of the foot joints; None for the ankles and toes of the legs that are found by the names of the joints, or, without legs,
        for all joints whose names hold a word for feet, ankles or toes.
    up : {"auto", "x", "y", "z"}
        The vertical axis; ``"auto"`` is the one that leads from the feet to the root.

    Returns
    -------
    ndarray of bool, shape (frames, feet)
        Whether each foot joint touches the ground; the feet in the order of `feet`, or of the skeleton.

    Raises
    ------
    ValueError
        If a name is not among the skeleton's, or no joint's name speaks of feet.

    Examples
    --------
    >>> import quatfilt as qf
    >>> from quatfilt.evaluation.synthetic import walk
    >>> touches = qf.metrics.foot_contacts(walk(seconds=4), feet=["LeftToe", "RightToe"])
    >>> bool(touches.any(axis=1).all())  # who walks always has a foot on the ground
    True
    """
    paths, vertical = _paths(motion, feet, up)
    return _contacts(paths, vertical, motion.fps)


def foot_slide(
    motion: "Motion",
    *,
    reference: "Motion | None" = None,
    feet: Sequence[str] | None = None,
    up: Up = "auto",
    per: Per = "clip",
) -> float | Values:
    """Horizontal path of the feet while they touch the ground.

    Parameters
    ----------
    motion : Motion
        Motion whose feet are looked at.
    reference : Motion or None, default None
        Motion that says when the feet touch the ground, see `foot_contacts`; None for `motion` itself. Noise hides
        contacts, so that motions are comparable only with one and the same reference.
    feet : sequence of str or None, default None
        Names of the foot joints; None as in `foot_contacts`.
    up : {"auto", "x", "y", "z"}
        The vertical axis; ``"auto"`` is the one that leads from the feet to the root.
    per : {"clip", "joint"}
        The mean over the foot joints, or the path of each.

    Returns
    -------
    float or ndarray, shape (feet,), centimetres
        Path over the whole clip.

    Raises
    ------
    ValueError
        If a name is not among the skeleton's, no joint's name speaks of feet, or the motions differ in joints or
        frames.

    Examples
    --------
    >>> import quatfilt as qf
    >>> from quatfilt.evaluation.synthetic import walk
    >>> truth = walk(seconds=4)
    >>> qf.metrics.foot_slide(truth, feet=["LeftToe", "RightToe"]) < 0.5
    True
    """
    how = _validation.choice(per, "per", PER)
    paths, vertical = _paths(motion, feet, up)
    if reference is None:
        contacts = _contacts(paths, vertical, motion.fps)
    else:
        truth, vertical = _paths(reference, feet, up)
        if truth.shape != paths.shape:
            raise ValueError(
                f"motion: expected the reference's {truth.shape[0]} frames and {truth.shape[1]} foot joints, "
                f"got {paths.shape[0]} and {paths.shape[1]}",
            )
        contacts = _contacts(truth, vertical, reference.fps)
    steps = np.diff(np.delete(paths, vertical, axis=-1), axis=0)
    lengths = np.linalg.norm(steps, axis=-1)
    grounded = contacts[:-1] & contacts[1:] & ~np.isnan(lengths)
    slide = np.sum(np.where(grounded, lengths, 0.0), axis=0)
    return float(_samples.mean(slide)) if how == "clip" else slide


def foot_scale(motion: "Motion") -> float:
    """Return the factor by which `foot_contacts` and `foot_slide` multiply lengths.

    Where the unit of a skeleton is not known (``centimetres_per_unit`` is 1) and its leg is shorter than 60 or longer than 120 units, the
    unit is not the centimetre. Then the leg is taken to be 90 cm long.

    Parameters
    ----------
    motion : Motion
        Motion with a skeleton.

    Returns
    -------
    float
        90 / leg length in such a skeleton; 1 in others, and in those without legs.

    Examples
    --------
    >>> import quatfilt as qf
    >>> from quatfilt.evaluation.synthetic import walk
    >>> qf.metrics.foot_scale(walk(seconds=1))
    1.0
    """
    skeleton = motion.skeleton
    lengths = [leg.length for leg in find_legs(skeleton)]
    if skeleton.centimetres_per_unit != 1 or not lengths:
        return 1.0
    length = sum(lengths) / len(lengths)
    return 1.0 if _SHORT_LEG <= length <= _LONG_LEG else _LEG / length


def _paths(motion: "Motion", feet: Sequence[str] | None, up: Up) -> tuple[Values, int]:
    """Return the paths of the foot joints in centimetres, ``(frames, feet, 3)``, and the axis that points up."""
    skeleton = motion.skeleton
    names = list(skeleton.names)
    if feet is None:
        joints = foot_joints(skeleton)
        if not joints:
            raise ValueError("feet: expected names of foot joints, for no joint's name speaks of feet")
    else:
        unknown = [name for name in feet if name not in names]
        if unknown:
            raise ValueError(f"feet: expected names of the skeleton's joints, got {unknown[0]!r}")
        joints = [names.index(name) for name in feet]
    unit = skeleton.centimetres_per_unit * foot_scale(motion)
    positions = np.asarray(motion.positions(), np.float64) * unit
    paths = positions[:, joints]
    axis = _validation.choice(up, "up", ("auto", "x", "y", "z"))
    if axis != "auto":
        return paths, "xyz".index(axis)
    vertical = up_axis(positions[:, pelvis(skeleton, find_legs(skeleton))], paths)
    if vertical < 0:
        vertical += 3
        paths[..., vertical] *= -1
    return paths, vertical


def _contacts(paths: Values, vertical: int, fps: float) -> Mask:
    frames = len(paths)
    if frames < _FEWEST:
        return np.zeros(paths.shape[:2], np.bool_)
    speed = np.linalg.norm(np.gradient(paths, axis=0), axis=-1) * fps
    height = paths[..., vertical]
    lowest = np.min(np.where(np.isnan(height), np.inf, height), axis=0)
    touching: Mask = np.asarray((speed < _SLOW) & (height - lowest < _LOW))
    windows: Mask = np.asarray(sliding_window_view(touching, _FEWEST, axis=0).all(axis=-1))
    result = np.zeros_like(touching)
    for offset in range(_FEWEST):
        result[offset : offset + len(windows)] |= windows
    return result


__all__ = ["foot_contacts", "foot_scale", "foot_slide"]
