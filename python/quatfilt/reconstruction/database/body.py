"""The joints that all clips of a database have, in one order and one unit."""

from dataclasses import dataclass, field
from typing import Self

import numpy as np
from numpy.typing import NDArray

from quatfilt.motion.skeleton import EndSite, Skeleton

_NAMED = 4
"""Joints that a message names; more of them are counted."""


class JointsError(ValueError):
    """A clip has joints that no database can hold, or not together with those before it."""


class OtherJointsError(JointsError):
    """A clip has other joints than those before it."""


@dataclass(frozen=True)
class Body:
    """The joints of the first clip; those of the others are matched by name.

    Parameters
    ----------
    names : tuple of str
        The joints.
    parents : ndarray of int64, shape (joints,)
        Their parents.
    centimetres_per_unit : float
        The unit of offsets and translations.
    source : str
        The clip that they come from, for messages.
    """

    names: tuple[str, ...]
    parents: NDArray[np.int64]
    centimetres_per_unit: float
    source: str
    _index: dict[str, int] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "_index", {name: joint for joint, name in enumerate(self.names)})

    @classmethod
    def of(cls, skeleton: Skeleton, source: str) -> Self:
        """Return the body of a skeleton.

        Raises
        ------
        JointsError
            If two joints have one name, or if there is another number of roots than one.
        """
        check_alone(skeleton, source)
        return cls(skeleton.names, skeleton.parents, skeleton.centimetres_per_unit, source)

    def arranged(self, skeleton: Skeleton, source: str) -> tuple[NDArray[np.intp], Skeleton]:
        """Return which joint of `skeleton` each of the body's is, and the skeleton in the body's order and unit.

        Raises
        ------
        OtherJointsError
            If it has other joints, or the same ones in another tree.
        JointsError
            If its joints cannot be told apart by their names.
        """
        check_alone(skeleton, source)
        difference = self.difference(skeleton)
        if difference:
            raise OtherJointsError(f"{source}: expected the joints of {self.source}, got {difference}")
        theirs = {name: joint for joint, name in enumerate(skeleton.names)}
        order = np.array([theirs[name] for name in self.names], np.intp)
        scale = skeleton.centimetres_per_unit / self.centimetres_per_unit
        sites = [
            EndSite(self._index[skeleton.names[site.joint]], _scaled(site.offset, scale), site.name)
            for site in skeleton.end_sites
        ]
        return order, Skeleton(
            self.names,
            self.parents,
            skeleton.offsets[order] * scale,
            centimetres_per_unit=self.centimetres_per_unit,
            end_sites=sorted(sites, key=lambda site: site.joint),
        )

    def difference(self, skeleton: Skeleton) -> str:
        """Say how the joints of a skeleton differ from the body's, in a few words; nothing if they do not."""
        lacking = [name for name in self.names if name not in skeleton.names]
        besides = [name for name in skeleton.names if name not in self._index]
        if lacking or besides:
            words = [f"none named {listed(lacking)}"] if lacking else []
            return " and ".join(words + ([f"others, {listed(besides)}"] if besides else []))
        for joint, name in enumerate(self.names):
            ours = self._name(self.parents[joint], self.names)
            theirs = self._name(skeleton.parents[skeleton.names.index(name)], skeleton.names)
            if ours != theirs:
                return f"{name} with the parent {theirs} instead of {ours}"
        return ""

    @staticmethod
    def _name(joint: int, names: tuple[str, ...]) -> str:
        return "none" if joint < 0 else names[joint]


def check_alone(skeleton: Skeleton, source: str) -> None:
    """Refuse a skeleton whose joints cannot be told apart by their names, or that is no single body."""
    twice = [name for place, name in enumerate(skeleton.names) if name in skeleton.names[:place]]
    if twice:
        raise JointsError(f"{source}: expected joints of different names, got several named {listed(twice)}")
    roots = [name for name, parent in zip(skeleton.names, skeleton.parents, strict=True) if parent < 0]
    if len(roots) != 1:
        raise JointsError(f"{source}: expected one root, got {listed(roots) or 'no joints'}")


def listed(names: list[str]) -> str:
    """Return some names in a line, and how many there are besides."""
    more = len(names) - _NAMED
    return ", ".join(names[:_NAMED]) + (f" and {more} more" if more > 0 else "")


def _scaled(offset: tuple[float, float, float], scale: float) -> tuple[float, float, float]:
    x, y, z = offset
    return x * scale, y * scale, z * scale
