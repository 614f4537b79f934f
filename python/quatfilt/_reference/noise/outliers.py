"""Samples in stretches of strong noise, drawn towards a first estimate."""

import numpy as np

from quatfilt._reference._arrays import Reals
from quatfilt._reference.rotations.quaternion import between, exp, log_short, multiply, normalize


def drawn_towards(q: Reals, estimate: Reals, share: Reals) -> Reals:
    """Return `s · exp(g log(s⁻¹ q))`: rotations that keep a share of their displacement from an estimate.

    Parameters
    ----------
    q : array (frames, joints, 4)
        Rotations without missing samples.
    estimate : array (frames, joints, 4)
        `s`.
    share : array (frames,), float64
        `g`, from 0 to 1.

    Returns
    -------
    array (frames, joints, 4)
        Unit quaternions, each in the hemisphere of its sample in `q`.
    """
    path, near = (normalize(x.astype(np.float64)) for x in (q, estimate))
    moved = multiply(near, exp(share[:, None, None] * log_short(between(near, path))))
    sign = np.where(np.sum(moved * path, axis=-1) < 0, -1, 1)
    return np.asarray(normalize(moved) * sign[..., None], q.dtype)
