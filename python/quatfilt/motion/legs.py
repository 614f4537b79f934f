"""Legs of a skeleton: hip, knee, ankle and toe of each side, found by the names of the joints."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Literal, TypeAlias

import numpy as np

from quatfilt._typing import Array
from quatfilt.motion._leg_pairs import leg_pair

if TYPE_CHECKING:
    from quatfilt.motion.skeleton import Skeleton

Side: TypeAlias = Literal["left", "right"]

SIDES: Final[tuple[Side, ...]] = ("left", "right")

Feet: TypeAlias = Literal["auto", "topology"] | Mapping[str, Sequence[str]]
"""How legs are found: by names, by equal pairs of bones, or as the caller names them."""

_PARTS = re.compile(r"[A-Z]+(?=[A-Z][a-z])|[A-Z]?[a-z]+|[A-Z]+|左|右|足首")
"""Words of a name: at underscores, blanks, dots and digits, and where camelCase has a hump."""

_SIDE: Final[dict[str, Side]] = {
    "left": "left",
    "l": "left",
    "左": "left",
    "right": "right",
    "r": "right",
    "右": "right",
}

_ANKLE: Final = ("ankle", "足首")
_FOOT: Final = ("foot", "feet")
_TOE: Final = ("toe", "toes", "toebase", "ball", "foot", "feet")
_BODY: Final = (
    *("ankle", "ankles", "ball", "calf", "feet", "femur", "foot", "heel", "hip", "hipjoint", "knee", "leg"),
    *("lowerleg", "lowleg", "shin", "thigh", "tibia", "toe", "toebase", "toes", "upleg", "upperleg"),
)
"""Words that may follow ``l``, ``r``, ``left`` or ``right`` without a border, as in ``lfoot``."""

_NOT_AN_ANKLE: Final = (
    "toe",
    "toes",
    "toebase",
    "ball",
    "heel",
    "roll",
    "ik",
    "index",
    "pole",
    "target",
    "ctrl",
)
"""Words of joints about the foot that are not its ankle."""

_FEET: Final = ("ankle", "ankles", "ball", "feet", "foot", "toe", "toebase", "toes", "足首")
"""Words of joints that may touch the ground."""

_HELPERS: Final = ("twist", "roll")
"""Words of joints that share a bone with another joint: they divide no leg."""

_SHORTEST_BONE = 0.05
"""Of the chain from the root to the ankle: a shorter bone is no thigh and no shank."""

_MOST_UNEQUAL = 2.0
"""Ratio of thigh and shank, or of shank and thigh: beyond it they are something else."""


@dataclass(frozen=True)
class Leg:
    """A leg of a skeleton, as indices of its joints.

    Parameters
    ----------
    side : {"left", "right"}
        Side of the body.
    hip, knee, ankle : int
        Joints at the upper end of the thigh, between thigh and shank, and at the lower end of the shank.
    toe : int or None
        Joint at the ball of the foot; None where the chain ends at the ankle.
    length : float, skeleton units
        Length of thigh and shank.
    """

    side: Side
    hip: int
    knee: int
    ankle: int
    toe: int | None
    length: float

    @property
    def feet(self) -> tuple[int, ...]:
        """Joints that may touch the ground: the ankle and the toe."""
        return (self.ankle,) if self.toe is None else (self.ankle, self.toe)


def find_legs(skeleton: "Skeleton", *, feet: Feet = "auto") -> tuple[Leg, ...]:
    """Find the legs of a skeleton.

    Parameters
    ----------
    skeleton : Skeleton
        The joints.
    feet : {"auto", "topology"} or mapping, default "auto"
        ``"auto"`` finds legs by the names of their joints. ``"topology"`` takes the pair of equal chains that leaves the body nearest
        to the root; a skeleton of four equal legs has no such pair. A mapping ``{"left": [...], "right": [...]}`` names the joints: the
        ankle and, if there is one, the toe; or hip, knee, ankle and toe.

    Returns
    -------
    tuple of Leg
        At most one for each side, the left one first; empty where no leg is recognised.

    Raises
    ------
    ValueError
        If `feet` has another value, or names a joint that is not in the skeleton or has no leg above it.
    """
    if isinstance(feet, Mapping):
        return _named(skeleton, feet)
    if feet == "topology":
        pair = leg_pair(skeleton.parents, skeleton.offsets)
        return tuple(
            _leg(skeleton, side, joints, _toe(skeleton, joints[2]))
            for side, joints in zip(SIDES, pair, strict=False)
        )
    if feet != "auto":
        raise ValueError(f"feet: expected 'auto', 'topology' or a dict with 'left' and 'right', got {feet!r}")
    found = (_found(skeleton, side) for side in SIDES)
    return tuple(leg for leg in found if leg is not None)


def foot_joints(skeleton: "Skeleton") -> list[int]:
    """Return the joints that may touch the ground, in the order of the skeleton.

    These are the ankles and toes of its legs. A skeleton without legs, such as a foot on its own, has those whose names hold a word for
    feet, ankles or toes.
    """
    legs = find_legs(skeleton)
    if legs:
        return sorted(joint for leg in legs for joint in leg.feet)
    return [joint for joint, name in enumerate(skeleton.names) if set(words(name)[1]) & set(_FEET)]


def pelvis(skeleton: "Skeleton", legs: Sequence[Leg]) -> int:
    """Return the lowest joint that all legs hang on; joint 0 where there is none."""
    if not legs:
        return 0
    above = [_ancestors(skeleton, leg.hip) for leg in legs]
    return next((joint for joint in above[0] if all(joint in other for other in above)), 0)


def up_axis(body: Array, feet: Array) -> int:
    """Return the vertical axis: the one that leads from the feet up to the body.

    Parameters
    ----------
    body : array, shape (frames, 3)
        Path of the pelvis.
    feet : array, shape (frames, feet, 3)
        Paths of the foot joints.

    Returns
    -------
    int
        0, 1 or 2, or 3 less if the axis points down.
    """
    rise = body[:, None].astype(np.float64) - feet
    known = np.isfinite(rise).all(axis=(1, 2))
    if not known.any():
        return 1
    mean = rise[known].mean(axis=(0, 1))
    axis = int(np.argmax(np.abs(mean)))
    return axis if mean[axis] >= 0 else axis - 3


def words(name: str) -> tuple[Side | None, tuple[str, ...]]:
    """Return the side that a joint's name speaks of, and its other words in lower case, without a namespace."""
    side: Side | None = None
    rest: list[str] = []
    for part in _PARTS.findall(re.split(r"[:|]", name)[-1]):
        word = part.lower()
        found = _SIDE.get(word)
        if found is None:
            found, word = _glued(word)
        else:
            word = ""
        side = side or found
        if word:
            rest.append(word)
    return side, tuple(rest)


def _glued(word: str) -> tuple[Side | None, str]:
    """Take a side off a word that it was written together with."""
    for prefix in ("left", "right", "l", "r"):
        if word.startswith(prefix) and word[len(prefix) :] in _BODY:
            return _SIDE[prefix], word[len(prefix) :]
        if word.endswith(prefix) and len(prefix) > 1 and word[: -len(prefix)] in _BODY:
            return _SIDE[prefix], word[: -len(prefix)]
    return None, word


def _found(skeleton: "Skeleton", side: Side) -> Leg | None:
    """Return the leg of a side, or None where there is none or more than one."""
    for kind in (_ANKLE, _FOOT):
        legs: list[Leg] = []
        for joint, name in enumerate(skeleton.names):
            own, rest = words(name)
            if own != side or not set(rest) & set(kind) or set(rest) & set(_NOT_AN_ANKLE):
                continue
            leg = _above(skeleton, side, joint)
            if leg is not None and not any(known.ankle in _ancestors(skeleton, joint) for known in legs):
                legs.append(leg)
        if legs:
            return legs[0] if len(legs) == 1 else None
    return None


def _named(skeleton: "Skeleton", feet: Mapping[str, Sequence[str]]) -> tuple[Leg, ...]:
    unknown = [side for side in feet if side not in SIDES]
    if unknown or not feet:
        raise ValueError(
            f"feet: expected a dict with 'left' and 'right', got {unknown[0] if unknown else 'none'!r}"
        )
    legs = []
    for side in SIDES:
        if side not in feet:
            continue
        names = [feet[side]] if isinstance(feet[side], str) else list(feet[side])
        missing = [name for name in names if name not in skeleton.names]
        if missing:
            raise ValueError(f"feet: expected names of the skeleton's joints, got {missing[0]!r}")
        if not 1 <= len(names) <= 4:
            raise ValueError(
                f"feet[{side!r}]: expected ankle and toe, or hip, knee, ankle and toe, got {len(names)} names"
            )
        joints = [skeleton.index(str(name)) for name in names]
        if len(joints) > 2:
            hip, knee, ankle = joints[:3]
            if hip not in _ancestors(skeleton, knee) or knee not in _ancestors(skeleton, ankle):
                raise ValueError(f"feet[{side!r}]: expected hip, knee and ankle each below the one before")
            legs.append(_leg(skeleton, side, (hip, knee, ankle), joints[3] if len(joints) > 3 else None))
            continue
        leg = _above(skeleton, side, joints[0])
        if leg is None:
            raise ValueError(
                f"feet[{side!r}]: expected an ankle below a shank and a thigh, got {names[0]!r}: name hip, knee, ankle and toe"
            )
        if len(joints) == 2:
            leg = _leg(skeleton, side, (leg.hip, leg.knee, leg.ankle), joints[1])
        legs.append(leg)
    for leg in legs:
        if leg.toe is not None and leg.ankle not in _ancestors(skeleton, leg.toe):
            raise ValueError(f"feet[{leg.side!r}]: expected a toe below the ankle")
    return tuple(legs)


def _above(skeleton: "Skeleton", side: Side, ankle: int) -> Leg | None:
    """Return the leg that ends at an ankle: knee and hip are the next joints above it across bones that are long enough."""
    chain = [ankle, *_ancestors(skeleton, ankle)]
    lengths = np.linalg.norm(skeleton.offsets[chain[:-1]], axis=1)
    shortest = _SHORTEST_BONE * float(lengths.sum())
    ends: list[tuple[int, float]] = []
    bone = 0.0
    for joint, length in zip(chain[1:], lengths, strict=True):
        bone += float(length)
        if bone > shortest and not set(words(skeleton.names[joint])[1]) & set(_HELPERS):
            ends.append((joint, bone))
            bone = 0.0
        if len(ends) == 2:
            break
    if len(ends) < 2:
        return None
    (knee, shank), (hip, thigh) = ends
    if not 1 / _MOST_UNEQUAL <= thigh / shank <= _MOST_UNEQUAL:
        return None
    return _leg(skeleton, side, (hip, knee, ankle), _toe(skeleton, ankle))


def _leg(skeleton: "Skeleton", side: Side, joints: tuple[int, int, int], toe: int | None) -> Leg:
    hip, knee, ankle = joints
    chain = [ankle, *_ancestors(skeleton, ankle)]
    bones = chain[: chain.index(hip)]
    return Leg(side, hip, knee, ankle, toe, float(np.linalg.norm(skeleton.offsets[bones], axis=1).sum()))


def _toe(skeleton: "Skeleton", ankle: int) -> int | None:
    """Return the child of an ankle that is named as toe, ball or foot, or else that with the longest chain below it."""
    children = [int(joint) for joint in np.flatnonzero(skeleton.parents == ankle)]
    if not children:
        return None
    for kind in (_TOE, ("index",)):
        named = [joint for joint in children if set(words(skeleton.names[joint])[1]) & set(kind)]
        if named:
            # Beside a toe there may be joints that help its skin, with more words in their names.
            return min(named, key=lambda joint: len(words(skeleton.names[joint])[1]))
    moving = [joint for joint in children if np.any(skeleton.offsets[joint] != 0)]
    return max(moving, key=lambda joint: _reach(skeleton, joint), default=None)


def _reach(skeleton: "Skeleton", joint: int) -> float:
    """Length of the longest chain from a joint's parent down through it."""
    below = [_reach(skeleton, int(child)) for child in np.flatnonzero(skeleton.parents == joint)]
    return float(np.linalg.norm(skeleton.offsets[joint])) + max(below, default=0.0)


def _ancestors(skeleton: "Skeleton", joint: int) -> tuple[int, ...]:
    """Joints above a joint, the nearest first."""
    return tuple(_up(skeleton, joint))


def _up(skeleton: "Skeleton", joint: int) -> Iterator[int]:
    parent = int(skeleton.parents[joint])
    while parent >= 0:
        yield parent
        parent = int(skeleton.parents[parent])


__all__ = ["SIDES", "Feet", "Leg", "Side", "find_legs", "foot_joints", "pelvis", "up_axis", "words"]
