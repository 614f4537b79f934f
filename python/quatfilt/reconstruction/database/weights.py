"""How much the error of a joint shows."""

import numpy as np
from numpy.typing import NDArray

from quatfilt.motion.skeleton import Skeleton

LEAST_REACH = 0.05
"""Part of the longest reach that every joint is given: a hand whose bone ends nowhere in the file still counts."""


def reaches(skeleton: Skeleton) -> NDArray[np.float64]:
    """Length of the longest chain of bones below each joint, to the end sites; skeleton units."""
    below = np.zeros(len(skeleton))
    for site in skeleton.end_sites:
        below[site.joint] = max(below[site.joint], float(np.linalg.norm(site.offset)))
    lengths = np.linalg.norm(skeleton.offsets, axis=1)
    for joint in range(len(skeleton) - 1, -1, -1):
        parent = skeleton.parents[joint]
        if parent >= 0:
            below[parent] = max(below[parent], lengths[joint] + below[joint])
    return below


def joint_weights(skeleton: Skeleton) -> NDArray[np.float64]:
    """Weights of the joints, whose sum is 1: proportional to their reach, at least `LEAST_REACH` of the longest one."""
    reach = reaches(skeleton)
    longest = reach.max(initial=0)
    weights = np.maximum(reach, LEAST_REACH * longest) if longest > 0 else np.ones(len(skeleton))
    normalised: NDArray[np.float64] = weights / weights.sum()
    return normalised
