"""Compression of rotations to a tolerance."""

from numpy.typing import ArrayLike

from quatfilt import _validation
from quatfilt._backend import ops
from quatfilt._typing import PerJoint
from quatfilt.geodesics.compressed import Compressed


def compress(
    q: ArrayLike, *, tolerance: PerJoint, quantised: bool = True, scalar_first: bool = True
) -> Compressed:
    """Compress rotations so that none comes back farther from what it was than a tolerance.

    Each joint is described by turns about its principal geodesics, ``q = c · exp(s₁v₁) · exp(s₂v₂) · exp(s₃v₃)``: as many of them
    as the tolerance needs, so a joint that does not move costs nothing, a hinge has one, a joint of two degrees of freedom
    two, and none more than three. The coordinates become whole steps, are predicted from frames on both sides, and what is left
    is coded by how likely it is. What the reader will compute is computed and compared with `q` before anything is written: the
    tolerance holds for every sample, whatever the motion.

    Parameters
    ----------
    q : array_like, shape (frames, joints, 4) or (frames, 4)
        Unit quaternions along time. Missing samples (NaN or four zeros) come back as NaN.
    tolerance : float or array_like (joints,), radians of rotation
        The largest rotation angle between a sample and what comes back, above 0. Where float32 cannot hold it, or roundings are larger,
        samples are stored as they are.
    quantised : bool, default True
        False: coordinates are stored as floats of the dtype of `q`. Larger, and nearly exact.
    scalar_first : bool, default True
        Whether quaternions are ``(w, x, y, z)``; False for SciPy's ``(x, y, z, w)``.

    Returns
    -------
    Compressed
        With ``decompress()``, ``save(path)``, ``nbytes``, ``ratio``.

    Raises
    ------
    ValueError, TypeError
        If an argument has another shape, type or range than stated; the message names it.

    See Also
    --------
    PrincipalGeodesicAnalysis : The analysis that this is built on.

    Notes
    -----
    Cost: ``frames · joints``, some 200 ns per sample and thread; decompression takes less than half of that. The bytes do not depend on the
    machine, the number of threads or the signs of the quaternions, but for one bit of each joint.

    References
    ----------
    .. [1] S. Said, N. Courty, N. Le Bihan and S. J. Sangwine, "Exact principal geodesic analysis for data on SO(3)",
       EUSIPCO 2007.
    .. [2] G. N. N. Martin, "Range encoding: an algorithm for removing redundancy from a digitised message", 1979.

    Examples
    --------
    >>> import numpy as np, quatfilt as qf
    >>> t = np.arange(600) / 60
    >>> swing = qf.exp(0.4 * np.sin(2 * np.pi * t)[:, None] * [0.0, 0.0, 1.0])
    >>> small = qf.compress(swing, tolerance=np.radians(0.1))
    >>> back = small.decompress()
    >>> bool(qf.geodesic_distance(swing, back).max() <= np.radians(0.1))
    True
    >>> small.ratio > 50
    True
    """
    clip, _ = _validation.clip(q, "q", scalar_first=scalar_first)
    joints = clip.shape[1]
    bounds = _validation.per_joint(tolerance, "tolerance", joints, above=0)
    chosen = _validation.switch(quantised, "quantised")
    backend = ops()
    stream, error = backend.compress(clip, backend.principal_frames(clip), bounds, chosen)
    single = _validation.quaternions(q, "q").ndim == 2
    return Compressed(stream, len(clip), joints, single, clip.dtype, error)


__all__ = ["compress"]
