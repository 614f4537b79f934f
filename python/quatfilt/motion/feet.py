"""Feet that stay where they stand: the step after a filter, and on its own."""

from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from quatfilt import _validation
from quatfilt._backend import ops
from quatfilt._typing import Array, Mask
from quatfilt.motion.legs import Feet, Leg, find_legs, pelvis, up_axis
from quatfilt.motion.motion import Motion

Placement: TypeAlias = Literal["keep", "lock"]

PLACEMENTS: tuple[Placement, ...] = ("keep", "lock")
"""What `denoise` may do with feet on the ground."""


def lock_feet(
    motion: Motion,
    *,
    feet: Feet = "auto",
    contacts: ArrayLike | None = None,
    translation: bool = True,
) -> Motion:
    """Lock feet to the ground while they stand on it.

    In each contact, ankle and toe go to the median of their horizontal path. A foot that moves farther than 3 cm within a contact takes a
    step there. Pelvis, hips, knees and ankles are turned to bring the feet there, frame by frame, by damped least squares; before and after
    a contact the change fades out within 0.1 s.

    Parameters
    ----------
    motion : Motion
        A motion of a skeleton with legs. Missing samples stay missing; legs with missing samples are not moved in those frames.
    feet : {"auto", "topology"} or dict, default "auto"
        How legs are found. ``"auto"``: by the names of the joints. ``"topology"``: the pair of equal chains that leaves the body nearest to
        its root. A dict ``{"left": [...], "right": [...]}`` names the ankle and the toe of each leg, or hip, knee, ankle and toe.
    contacts : array_like of bool or None, shape (frames, feet), default None
        When each ankle and toe stands on the ground, in the order of the skeleton's joints, as from `metrics.foot_contacts`; from force
        plates, for example. None to find contacts: slow and low parts of the path, with thresholds that grow with its noise.
    translation : bool, default True
        Whether the root may move and turn; False for hips, knees and ankles alone.

    Returns
    -------
    Motion
        Frames far from contacts have the same numbers as before.

    Raises
    ------
    TypeError
        If `motion` is no Motion.
    ValueError
        If no legs are found, or an argument is not what was stated; the message names it.

    See Also
    --------
    denoise : ``feet="keep"`` keeps contacts of the input as they were, ``feet="lock"`` locks them after filtering.
    metrics.foot_slide : How far feet slide.

    Notes
    -----
    Feet are moved by 3 cm at most, in a body whose legs are 90 cm long. One height of the ground is assumed: on stairs, give `contacts`.

    Cost: about 10 µs per frame and thread.

    References
    ----------
    .. [1] L. Kovar, J. Schreiner and M. Gleicher, "Footskate cleanup for motion capture editing", SCA 2002.
    .. [2] S. R. Buss, "Introduction to inverse kinematics with Jacobian transpose, pseudoinverse and damped least squares methods", 2004.

    Examples
    --------
    >>> import quatfilt as qf
    >>> from quatfilt.evaluation.synthetic import walk
    >>> truth = walk(seconds=3)
    >>> noisy = truth.replace(rotations=qf.add_gaussian_noise(truth.rotations, sigma=0.01, rng=0))
    >>> clean = qf.denoise(noisy, feet=None)
    >>> slide = lambda motion: qf.metrics.foot_slide(motion, reference=truth)
    >>> slide(qf.lock_feet(clean)) < 0.5 * slide(clean)
    True
    """
    if not isinstance(motion, Motion):
        raise TypeError(f"motion: expected a Motion, got {type(motion).__name__}")
    legs = _usable(motion, find_legs(motion.skeleton, feet=feet))
    if not legs:
        raise ValueError(f"feet: {NO_LEGS}")
    root = _validation.switch(translation, "translation")
    given = None if contacts is None else _given(contacts, legs, len(motion))
    return _placed(motion, motion, legs, given, root=root, lock=True)


NO_LEGS = (
    "no legs were recognised by the names of the joints; name them, feet={'left': [ankle, toe], 'right': [ankle, toe]}, "
    "or try feet='topology'"
)


def with_feet(before: Motion, after: Motion, how: Placement, *, translation: bool = True) -> Motion:
    """Return a filtered motion whose feet stay where those of the input stand.

    Parameters
    ----------
    before, after : Motion
        The same motion without and with a filter.
    how : {"keep", "lock"}
        Whether feet follow their path in the input while they stand on the ground, or stay at one point.
    translation : bool, default True
        Whether the root may move and turn.

    Returns
    -------
    Motion
        `after` itself where no legs are recognised and feet are only to be kept.

    Raises
    ------
    ValueError
        If feet are to be locked and no legs are recognised.
    """
    legs = _usable(after, find_legs(after.skeleton))
    if not legs:
        if how == "lock":
            raise ValueError(
                "feet: expected a skeleton with legs for 'lock', but none were recognised by the names of the joints; "
                "use lock_feet(motion, feet={'left': [ankle, toe], 'right': [ankle, toe]}) after denoise(..., feet=None)"
            )
        return after
    return _placed(before, after, legs, None, root=translation, lock=how == "lock")


def _usable(motion: Motion, legs: tuple[Leg, ...]) -> tuple[Leg, ...]:
    """Return the legs that hang on the first root and have a length: the translation of the motion is that of this root."""
    parents = motion.skeleton.parents

    def root(joint: int) -> int:
        while parents[joint] >= 0:
            joint = int(parents[joint])
        return joint

    return tuple(leg for leg in legs if root(leg.hip) == 0 and leg.length > 0)


def _placed(
    before: Motion, after: Motion, legs: tuple[Leg, ...], given: Mask | None, *, root: bool, lock: bool
) -> Motion:
    if len(after) < 2:
        return after
    skeleton = after.skeleton
    chains = np.array([[leg.hip, leg.knee, *_ends(leg)] for leg in legs], np.int64)
    lengths = np.array([leg.length for leg in legs], np.float64)
    body = pelvis(skeleton, legs)
    target = after.positions()
    feet = np.ascontiguousarray(target[:, chains[:, 2:]])
    up = up_axis(target[:, body], feet.reshape(len(feet), -1, 3))
    source = (
        feet if before is after else np.ascontiguousarray(before.positions()[:, chains[:, 2:]], feet.dtype)
    )
    displacements, _ = ops().foot_displacements(source, feet, lengths, up, float(after.fps), given, lock)
    local = skeleton.offsets[None] if after.joint_translations is None else after.joint_translations
    rotations, translation = ops().place_feet(
        after.rotations,
        after.translation,
        np.ascontiguousarray(local, after.rotations.dtype),
        skeleton.parents,
        body,
        chains,
        lengths,
        displacements,
        root,
        lock,
    )
    return after.replace(rotations=rotations, translation=translation)


def _ends(leg: Leg) -> tuple[int, int]:
    """Ankle and toe; a leg without a toe has its ankle twice."""
    return leg.ankle, leg.ankle if leg.toe is None else leg.toe


def _given(contacts: ArrayLike, legs: tuple[Leg, ...], frames: int) -> Mask:
    """Return contacts ``(frames, legs, 2)`` from one column for each foot joint in the order of the skeleton."""
    array: Array | Mask = np.asarray(contacts)
    joints = sorted(joint for leg in legs for joint in leg.feet)
    if array.dtype != np.bool_ and not np.isin(array, (0, 1)).all():
        raise ValueError(f"contacts: expected True and False, or 1 and 0, got dtype {array.dtype}")
    if array.shape != (frames, len(joints)):
        raise ValueError(
            f"contacts: expected shape ({frames}, {len(joints)}), frames and the ankles and toes of the legs, got {array.shape}"
        )
    columns = [[joints.index(joint) for joint in _ends(leg)] for leg in legs]
    return np.ascontiguousarray(array.astype(np.bool_)[:, columns])


__all__ = ["PLACEMENTS", "Placement", "lock_feet", "with_feet"]
