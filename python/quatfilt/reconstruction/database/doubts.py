"""What looks wrong about the bodies of a database: a vertical that is none, a root that does not turn."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from quatfilt._typing import Array
from quatfilt.reconstruction.database.takes import Take

_LOOKS = 8
"""Poses of a take that are looked at."""

_HIGHER = 1.5
"""Ratio of two extents of a body from which the greater one must be its height: of a person with spread arms it is about 1."""

_STILL = 1e-4
"""Radians: a root that turns by less does not turn."""


@dataclass
class Doubts:
    """Looks at takes as they come in.

    Parameters
    ----------
    up : int
        The axis that is said to be the vertical.
    """

    up: int
    _extents: list[NDArray[np.float64]] = field(default_factory=list)
    _turn: float = 0.0

    def look(self, take: Take) -> None:
        """Look at some poses."""
        some = np.unique(np.linspace(0, len(take.rotations) - 1, _LOOKS).astype(np.intp))
        places: Array = take.skeleton.forward_kinematics(take.rotations[some], np.zeros((len(some), 3)))
        self._extents.append(np.ptp(places, axis=1).astype(np.float64))
        self._turn = max(self._turn, float(np.ptp(take.heading)))

    def notes(self, root: str) -> list[str]:
        """Return what is doubtful."""
        notes = []
        height = np.median(np.concatenate(self._extents), axis=0)
        highest, axes = int(np.argmax(height)), "xyz"
        if height[highest] > _HIGHER * height[self.up]:
            notes.append(
                f"bodies reach {height[highest]:.3g} along {axes[highest]} and {height[self.up]:.3g} along {axes[self.up]}, which "
                f"is said to be up: up={axes[highest]!r}?"
            )
        if self._turn < _STILL:
            notes.append(
                f"{root} never turns about {axes[self.up]}: if a joint below it leads, the headings of clips are not taken out"
            )
        return notes
