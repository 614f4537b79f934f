"""Mirror images of takes: left and right change places."""

import re
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from quatfilt.motion.skeleton import EndSite, Skeleton
from quatfilt.reconstruction.database.body import Body
from quatfilt.reconstruction.database.takes import Take

_SIDES = (
    (r"left", r"right"),
    (r"Left", r"Right"),
    (r"LEFT", r"RIGHT"),
    (r"(?<![A-Za-z])l", r"r"),
    (r"(?<![A-Za-z])L", r"R"),
)
"""What names say of the left, and of the right: words anywhere, a letter where no other letter is before it."""

_SAME_PLACE = 0.25
"""Distance from a joint's place in its parent to the mirror image of its partner's, as a part of the longest bone, up to which
both count as the same: people are not symmetric to a few percent."""


@dataclass(frozen=True)
class Mirror:
    """The sagittal plane of a body.

    Parameters
    ----------
    partners : ndarray of int, shape (joints,)
        The joint on the other side; the joint itself in the middle.
    across : int
        The axis across the plane.
    """

    partners: NDArray[np.intp]
    across: int

    def skeleton(self, skeleton: Skeleton) -> Skeleton:
        """Return the mirror image of a skeleton: each joint where its partner's image is."""
        sites = [
            EndSite(int(self.partners[site.joint]), self._image(site.offset), site.name)
            for site in skeleton.end_sites
        ]
        return Skeleton(
            skeleton.names,
            skeleton.parents,
            [self._image(offset) for offset in skeleton.offsets[self.partners].tolist()],
            centimetres_per_unit=skeleton.centimetres_per_unit,
            end_sites=sorted(sites, key=lambda site: site.joint),
        )

    def take(self, take: Take) -> Take:
        """Return the mirror image of a take.

        A reflection `M` makes `M R M` of a rotation `R`: of its axis, the component across the plane stays, and those in the
        plane change their signs. Signs are exact, so that the image is that of the rounded take.
        """
        signs = np.full(4, -1, np.float32)
        signs[[0, 1 + self.across]] = 1
        places = np.ones(3, np.float32)
        places[self.across] = -1
        return Take(
            f"{take.name} mirrored",
            self.skeleton(take.skeleton),
            np.ascontiguousarray(take.rotations[:, self.partners]) * signs,
            -take.heading,
            take.translation * places,
        )

    def _image(self, offset: tuple[float, float, float]) -> tuple[float, float, float]:
        x, y, z = (-value if axis == self.across else value for axis, value in enumerate(offset))
        return x, y, z


def mirror_of(body: Body, skeleton: Skeleton, up: int) -> Mirror:
    """Find the sagittal plane of a body by the names of its joints, and by where the skeleton has them at rest.

    Raises
    ------
    ValueError
        If no joint has a partner, or if the body is not symmetric: mirrored rotations would not fit its joints.
    """
    partners = _partners(body.names)
    paired = np.flatnonzero(partners != np.arange(len(partners)))
    if not len(paired):
        raise ValueError(
            f"mirror: expected left and right joints (LeftArm, l_arm, arm.L …) in {body.source}, got "
            f"{', '.join(body.names[:4])}{', …' if len(body.names) > 4 else ''}"
        )
    above = np.where(body.parents < 0, -1, partners[body.parents])
    odd = np.flatnonzero(body.parents[partners] != above)
    if len(odd):
        first, other = body.names[odd[0]], body.names[partners[odd[0]]]
        raise ValueError(f"mirror: expected {first} and {other} at joints of one name, but for the side")
    places = _at_rest(skeleton)
    spread = np.abs(places[paired] - places[partners[paired]]).sum(axis=0)
    spread[up] = 0
    mirror = Mirror(partners, int(np.argmax(spread)))
    moved = np.linalg.norm(mirror.skeleton(skeleton).offsets - skeleton.offsets, axis=1)
    moved[0] = 0
    longest = np.linalg.norm(skeleton.offsets[1:], axis=1).max(initial=0)
    if moved.max() > _SAME_PLACE * longest:
        name = body.names[int(np.argmax(moved))]
        raise ValueError(
            f"mirror: expected a body that is symmetric across {'xyz'[mirror.across]} in {body.source}, got {name} elsewhere "
            "in its parent than its partner's mirror image"
        )
    return mirror


def _partners(names: tuple[str, ...]) -> NDArray[np.intp]:
    """Return the joint on the other side for each joint, itself where there is none."""
    index = {name: joint for joint, name in enumerate(names)}
    partners = np.arange(len(names))
    for name, joint in index.items():
        for left, right in _SIDES:
            for place in re.finditer(left, name):
                other = index.get(name[: place.start()] + right + name[place.end() :])
                if other is not None and partners[joint] == joint:
                    partners[joint], partners[other] = other, joint
    return partners


def _at_rest(skeleton: Skeleton) -> NDArray[np.float64]:
    """Return where the joints are in the rest pose."""
    places = skeleton.offsets.copy()
    for joint, parent in enumerate(skeleton.parents):
        if parent >= 0:
            places[joint] += places[parent]
    return places
