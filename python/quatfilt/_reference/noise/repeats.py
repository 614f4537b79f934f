"""Exact repeats: samples that a recorder wrote again because it had no new one."""

import numpy as np

from quatfilt._reference._arrays import Mask, Reals
from quatfilt._reference.rotations.quaternion import is_missing


def find_repeats(q: Reals) -> Mask:
    """Mark the samples that equal the latest sample of their joint before them, in every component.

    A frozen joint, a stream that is held for some frames and a doubled frame repeat exactly; measurements with noise do not. `q` and
    `−q` are the same rotation and count as equal. Missing samples are no repeats, and a sample after a gap is compared with the one
    before the gap.

    Parameters
    ----------
    q : array (frames, joints, 4)

    Returns
    -------
    array (frames, joints) of bool
        Never at the first sample of a joint.
    """
    missing = is_missing(q)
    repeats = np.zeros(q.shape[:2], np.bool_)
    for joint in range(q.shape[1]):
        known = np.flatnonzero(~missing[:, joint])
        before, here = q[known[:-1], joint], q[known[1:], joint]
        repeats[known[1:], joint] = (here == before).all(axis=-1) | (here == -before).all(axis=-1)
    return repeats
