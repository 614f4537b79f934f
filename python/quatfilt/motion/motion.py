"""Motions: rotations of the joints of a skeleton, and where it goes."""

from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike

from quatfilt import _validation
from quatfilt._typing import Array
from quatfilt.motion.skeleton import Skeleton

_PARTS = ("rotations", "translation", "fps", "skeleton", "joint_translations")


class Motion:
    """A skeleton in motion.

    `read_motion` makes one from a file. A motion does not change; `replace` makes another one.

    Parameters
    ----------
    rotations : array_like, shape (frames, joints, 4)
        Rotation of each joint in its parent's frame, unit quaternions, scalar first. NaN and zeros are missing samples.
    translation : array_like, shape (frames, 3), skeleton units, optional
        Positions of the (first) root; zeros by default.
    fps : float, hertz
        Frames per second.
    skeleton : Skeleton
        The joints.
    joint_translations : array_like, shape (frames, joints, 3), skeleton units, optional
        Positions of the joints in their parents' frames, where they move there; None where the skeleton's offsets hold. That
        of the first root is not used: `translation` holds it.

    Raises
    ------
    ValueError
        If the shapes do not fit each other, or rotations are not of unit length.

    Examples
    --------
    >>> import quatfilt as qf
    >>> arm = qf.Skeleton(["shoulder", "elbow"], [-1, 0], [[0.0, 0, 0], [0, -30, 0]])
    >>> still = qf.Motion([[[1.0, 0, 0, 0]] * 2] * 60, fps=30, skeleton=arm)
    >>> still
    Motion(60 frames of 2 joints, 30 fps, 2 s, float64)
    >>> still.replace(fps=60)
    Motion(60 frames of 2 joints, 60 fps, 1 s, float64)
    """

    __slots__ = (
        "_fps",
        "_joint_translations",
        "_notes",
        "_rotations",
        "_skeleton",
        "_source",
        "_translation",
    )

    def __init__(
        self,
        rotations: ArrayLike,
        translation: ArrayLike | None = None,
        *,
        fps: float,
        skeleton: Skeleton,
        joint_translations: ArrayLike | None = None,
    ) -> None:
        if not isinstance(skeleton, Skeleton):
            raise TypeError(f"skeleton: expected a Skeleton, got {type(skeleton).__name__}")
        if translation is None:
            translation = np.zeros((len(np.asarray(rotations)), 3))
        self._rotations, self._translation, self._joint_translations = _validation.posed(
            rotations, translation, joint_translations, skeleton.parents
        )
        self._fps = _validation.number(fps, "fps", above=0)
        self._skeleton = skeleton
        self._notes: tuple[str, ...] = ()
        self._source: Any = None

    @classmethod
    def _read(
        cls,
        rotations: Array,
        translation: Array,
        *,
        fps: float,
        skeleton: Skeleton,
        joint_translations: Array | None = None,
        notes: tuple[str, ...],
        source: object,
    ) -> Self:
        """Make a motion of a file, with what it takes to write that file again."""
        motion = cls(
            rotations, translation, fps=fps, skeleton=skeleton, joint_translations=joint_translations
        )
        motion._notes = notes
        motion._source = source
        return motion

    @property
    def rotations(self) -> Array:
        """Rotation of each joint in its parent's frame; shape (frames, joints, 4)."""
        return self._rotations

    @property
    def translation(self) -> Array:
        """Positions of the (first) root; shape (frames, 3), skeleton units."""
        return self._translation

    @property
    def fps(self) -> float:
        """Frames per second."""
        return self._fps

    @property
    def skeleton(self) -> Skeleton:
        """The joints."""
        return self._skeleton

    @property
    def joint_translations(self) -> Array | None:
        """Positions of the joints in their parents' frames, shape (frames, joints, 3); None where they do not move."""
        return self._joint_translations

    @property
    def notes(self) -> tuple[str, ...]:
        """What was repaired or assumed when the motion was read."""
        return self._notes

    def __len__(self) -> int:
        return len(self._rotations)

    def __repr__(self) -> str:
        frames, joints = self._rotations.shape[:2]
        return (
            f"Motion({frames} frame{'s' * (frames != 1)} of {joints} joint{'s' * (joints != 1)}, "
            f"{self._fps:g} fps, {frames / self._fps:.4g} s, {self._rotations.dtype})"
        )

    def replace(self, **changes: Any) -> "Motion":
        """Make a motion that differs in some parts.

        It is written as the file that this one came from: same hierarchy, channels and rest row.

        Parameters
        ----------
        **changes
            New `rotations`, `translation`, `fps`, `skeleton` or `joint_translations`.

        Returns
        -------
        Motion
            The other parts are shared with this one.

        Raises
        ------
        TypeError
            If there is no part of that name.
        ValueError
            If the parts do not fit each other.
        """
        for name in changes:
            if name not in _PARTS:
                raise TypeError(f"replace: expected one of {', '.join(_PARTS)}, got {name!r}")
        parts = {name: getattr(self, name) for name in _PARTS} | changes
        motion = Motion(parts.pop("rotations"), parts.pop("translation"), **parts)
        motion._notes = self._notes
        motion._source = self._source
        return motion

    def positions(self) -> Array:
        """Positions of the joints, by forward kinematics.

        Returns
        -------
        ndarray, shape (frames, joints, 3), skeleton units
            Multiplied by ``skeleton.centimetres_per_unit``: centimetres.
        """
        return self._skeleton.forward_kinematics(
            self._rotations, self._translation, joint_translations=self._joint_translations
        )


__all__ = ["Motion"]
