"""Skeletons: which joint hangs on which, and where."""

from collections.abc import Iterable, Sequence
from typing import NamedTuple, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from quatfilt import _validation
from quatfilt._backend import ops
from quatfilt._typing import Array


class EndSite(NamedTuple):
    """The end of a last bone.

    Parameters
    ----------
    joint : int
        The joint that the bone begins at.
    offset : tuple of 3 floats, skeleton units
        Where the bone ends, in the joint's frame.
    name : str or None
        What a file calls it; most have no name.

    Examples
    --------
    >>> import quatfilt as qf
    >>> qf.EndSite(0, (0.0, 4.0, 0.0)).offset
    (0.0, 4.0, 0.0)
    """

    joint: int
    offset: tuple[float, float, float]
    name: str | None = None


class Skeleton:
    """A tree of joints.

    Parameters
    ----------
    names : sequence of str
        The joints; equal names are allowed, since files have them.
    parents : sequence of int
        Index of each joint's parent, which comes before the joint; −1 for a root, of which there may be several.
    offsets : array_like, shape (joints, 3), skeleton units
        Position of each joint in its parent's frame; of a root, where it stands at rest.
    centimetres_per_unit : float, default 1.0
        Length of the unit of the offsets and of the motion's translation; 1 unless known.
    end_sites : sequence of EndSite, optional
        Ends of the last bones.

    Raises
    ------
    ValueError
        If the lengths differ, a parent does not come before its child, or an offset is not finite.

    Examples
    --------
    >>> import quatfilt as qf
    >>> arm = qf.Skeleton(["shoulder", "elbow"], [-1, 0], [[0.0, 0, 0], [0, -30, 0]])
    >>> arm
    Skeleton(2 joints: shoulder, elbow)
    >>> arm.forward_kinematics([[[1.0, 0, 0, 0]] * 2], [[0.0, 140, 0]])[0, 1]
    array([  0., 110.,   0.])
    """

    __slots__ = ("_acclaim", "_centimetres_per_unit", "_end_sites", "_names", "_offsets", "_parents")

    def __init__(
        self,
        names: Sequence[str],
        parents: ArrayLike,
        offsets: ArrayLike,
        *,
        centimetres_per_unit: float = 1.0,
        end_sites: Iterable[EndSite] = (),
    ) -> None:
        self._names = tuple(str(name) for name in names)
        self._parents = _validation.parents(parents, len(self._names))
        self._offsets = _validation.offsets(offsets, len(self._names))
        self._centimetres_per_unit = _validation.number(centimetres_per_unit, "centimetres_per_unit", above=0)
        self._end_sites = tuple(self._end_site(*site) for site in end_sites)
        self._acclaim: bytes | None = None

    def _end_site(self, joint: int, offset: tuple[float, float, float], name: str | None = None) -> EndSite:
        joint = _validation.integer(joint, "end_sites", at_least=0, at_most=len(self._names) - 1)
        x, y, z = (_validation.number(value, "end_sites") for value in offset)
        return EndSite(joint, (x, y, z), name)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the joints."""
        return self._names

    @property
    def parents(self) -> NDArray[np.int64]:
        """Index of each joint's parent, −1 for a root; shape (joints,), read-only."""
        return self._parents

    @property
    def offsets(self) -> NDArray[np.float64]:
        """Position of each joint in its parent's frame; shape (joints, 3), skeleton units, read-only."""
        return self._offsets

    @property
    def centimetres_per_unit(self) -> float:
        """Length of a unit in centimetres, 1 unless known."""
        return self._centimetres_per_unit

    @property
    def end_sites(self) -> tuple[EndSite, ...]:
        """Ends of the last bones."""
        return self._end_sites

    def __len__(self) -> int:
        return len(self._names)

    def __repr__(self) -> str:
        shown = ", ".join(self._names[:4]) + (", …" if len(self._names) > 4 else "")
        unit = f"; unit {self._centimetres_per_unit:.4g} cm" if self._centimetres_per_unit != 1 else ""
        return f"Skeleton({len(self)} joint{'s' * (len(self) != 1)}: {shown}{unit})"

    def index(self, name: str) -> int:
        """Return the index of the first joint of this name.

        Parameters
        ----------
        name : str
            A joint.

        Returns
        -------
        int
            Its place in `names`.

        Raises
        ------
        ValueError
            If there is none.
        """
        if name not in self._names:
            raise ValueError(f"name: expected a joint of the skeleton, got {name!r}")
        return self._names.index(name)

    def forward_kinematics(
        self,
        rotations: ArrayLike,
        translation: ArrayLike,
        *,
        joint_translations: ArrayLike | None = None,
    ) -> Array:
        """Positions of the joints.

        Parameters
        ----------
        rotations : array_like, shape (frames, joints, 4)
            Rotation of each joint in its parent, unit quaternions, scalar first.
        translation : array_like, shape (frames, 3), skeleton units
            Positions of the first root, and of all roots unless `joint_translations` tells of them.
        joint_translations : array_like, shape (frames, joints, 3), skeleton units, optional
            Positions of the joints in their parents' frames, for joints that move there, instead of the offsets. That of
            the first root is not used: `translation` holds it.

        Returns
        -------
        ndarray, shape (frames, joints, 3), skeleton units
            Positions; NaN below a missing sample.

        Raises
        ------
        ValueError
            If the shapes do not fit each other.

        Notes
        -----
        About 6 ns per joint, frame and thread; twice as much where joints move in their parents.
        """
        q, moved, own = _validation.posed(rotations, translation, joint_translations, self._parents)
        if own is None:
            offsets = self._offsets.astype(q.dtype)
            return cast("Array", ops().forward_kinematics(q, moved, self._parents, offsets))
        own = own.copy()
        own[:, :1] = moved[:, None]
        return cast("Array", ops().forward_kinematics_moving(q, own, self._parents))


__all__ = ["EndSite", "Skeleton"]
