"""Patch search."""

from collections.abc import Sequence
from typing import cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from quatfilt import _validation
from quatfilt._backend import ops
from quatfilt._typing import Array

_LONGEST_RADIUS = 100_000
"""Frames: patches beyond it would take memory for frames that no clip has."""

_MOST = 100_000
"""More neighbours of every frame than memory holds for any clip."""

_LONGEST_EXCLUSION = 1_000_000_000
"""Frames: longer than any clip."""


def patch_neighbors(
    q: ArrayLike,
    *,
    patch_radius: int = 5,
    k: int = 16,
    exclusion: int | None = None,
    library: ArrayLike | Sequence[ArrayLike] | None = None,
    joint_weights: ArrayLike | None = None,
    scalar_first: bool = True,
) -> tuple[NDArray[np.int64], Array]:
    """Find the `k` most similar patches of every frame: in the clip itself, in another clip, or in many.

    The patch of a frame is the frame with `patch_radius` frames before and after it; beyond the ends of a clip its end
    frame is held. The distance of two patches is the root mean square rotation angle between them, over the patch's frames
    and joints. The search is exact.

    Parameters
    ----------
    q : array_like, shape (frames, joints, 4) or (frames, 4)
        Unit quaternions along time; signs do not matter. Samples that are NaN or four zeros are missing: a distance is the
        mean over the pairs of samples that are both there, and patches without such a pair are no neighbours.
    patch_radius : int, frames, default 5
        Radius of a patch, from 0 to 100,000.
    k : int, default 16
        How many neighbours, from 1 to 100,000.
    exclusion : int or None, frames, default None
        In the clip itself, the frame and so many frames before and after it are left out; None for `patch_radius`. Not with
        a library.
    library : array_like (n, joints, 4), list of such, or None, default None
        A clip, or a list or tuple of clips, whose patches are the candidates instead. They have as many joints as `q` and
        are taken in its dtype.
    joint_weights : array_like (joints,) or None, default None
        What each joint counts in the mean, not negative; None for all the same.
    scalar_first : bool, default True
        Whether quaternions are ``(w, x, y, z)``; False for SciPy's ``(x, y, z, w)``.

    Returns
    -------
    indices : ndarray of int64, shape (frames, `k`)
        Frames of `q`, or frames of the library counted through its clips one after the other. The nearest first; of equally
        near ones the lower index. −1 where there are fewer than `k`.
    distances : ndarray, shape (frames, `k`), radians of rotation
        In the dtype of `q`; infinite where there are fewer than `k`.

    Raises
    ------
    ValueError
        If shapes do not fit, samples are far from unit length, or an option is out of its range.
    TypeError
        If an option is of another type.

    Notes
    -----
    At most ``frames · candidates · joints`` angles, whatever the patch; of clips without missing samples, pairs that bounds
    show to be too far apart are passed over, which leaves some thousandths of the angles even where motion never repeats. Memory
    beyond the result: 16 bytes for each neighbour, 28 to 47 MB for 31 joints in float32 for 16,384 candidates at a time, and
    some MB per thread.

    Distances within rounding of each other may change places between precisions and backends.

    References
    ----------
    C.-C. M. Yeh et al., "Matrix Profile I: all pairs similarity joins for time series", ICDM 2016, for the exclusion zone
    and the sums along diagonals.

    Examples
    --------
    >>> import numpy as np, quatfilt as qf
    >>> t = np.arange(100)
    >>> swing = qf.exp(0.4 * np.sin(2 * np.pi * t / 25)[:, None] * [0.0, 0.0, 1.0])
    >>> indices, distances = qf.patch_neighbors(swing, k=3)
    >>> np.sort(indices[40])
    array([15, 65, 90])
    >>> bool((distances[40] < 1e-9).all())
    True
    """
    clip, _ = _validation.clip(q, "q", scalar_first=scalar_first)
    radius = _validation.integer(patch_radius, "patch_radius", at_least=0, at_most=_LONGEST_RADIUS)
    count = _validation.integer(k, "k", at_least=1, at_most=_MOST)
    zone = radius
    if exclusion is not None:
        zone = _validation.integer(exclusion, "exclusion", at_least=0, at_most=_LONGEST_EXCLUSION)
        if library is not None:
            raise ValueError(
                f"exclusion: expected None with a library, whose frames are not near in time, got {zone}"
            )
    weights = np.ones(clip.shape[1])
    if joint_weights is not None:
        weights = _validation.per_joint(joint_weights, "joint_weights", clip.shape[1], at_least=0)
        if len(weights) and not weights.any():
            raise ValueError("joint_weights: expected a weight above 0, got none")
    clips, lengths = _validation.library(library, clip, scalar_first=scalar_first)
    found = ops().patch_neighbors(clip, clips, lengths, radius, count, zone, weights)
    return cast("tuple[NDArray[np.int64], Array]", found)


__all__ = ["patch_neighbors"]
