"""Cuts between behaviours, where the error of a few principal geodesics begins to grow faster than before.

J. Barbič et al., "Segmenting motion capture data into distinct behaviors", Graphics Interface 2004, their PCA-SEG, on rotations: a segment
is described by principal geodesics that are fitted to all of its frames so far. As long as it goes on, the sum of the squared errors
grows at a steady rate, for what comes has been there before; a new behaviour makes it grow faster.

The geodesics are those of the squared sine, for they are in closed form: of the unit quaternions of a joint, with the moments
`M = Σ q qᵀ`, the great sphere of `k` dimensions through their mean that lies nearest is spanned by the eigenvectors of the `k + 1` largest
eigenvalues of `M`, and the others sum up to `Σ sin² d`. Signs cancel in `M`, and a constant rotation of the frame turns it.
"""

import numpy as np

from quatfilt._reference._arrays import Indices, Reals
from quatfilt._reference.rotations.quaternion import is_missing, normalize

STILL = 1e-3
"""Root mean square of the error (unit: sine of half of a rotation angle, 0.1°) below which nobody sees that it grows."""

BLOCK = 512
"""Frames whose moments are summed up at once."""


def segment(
    q: Reals, components: int, window: int, min_length: int, lag: int, threshold: float
) -> tuple[Indices, Reals, Reals]:
    """Find the first frames of new behaviours.

    With `e_i` the sum of the squared errors of the segment's frames up to `i`, and `d_i = e_i − e_{i−lag}`, frame `i` is a cut where `d_i`
    exceeds the mean of the segment's `d` before it by more than `threshold` of their deviations, and by more than `STILL`.

    Parameters
    ----------
    q : array (frames, joints, 4)
        Rotations. Missing samples have no error.
    components : int
        Geodesics per joint: 1 or 2.
    window : int
        Frames at the beginning of a segment in which no cut is looked for.
    min_length : int
        Frames of each segment, at least.
    lag : int
        Frames that `d` spans.
    threshold : float
        In standard deviations.

    Returns
    -------
    cuts : array (n,)
        Rising.
    growth : array (frames,)
        `d_i`; NaN where the segment is too young.
    limit : array (frames,)
        Threshold of `d_i`; NaN where it was not tested.
    """
    frames, joints = q.shape[:2]
    growth, limit = np.full(frames, np.nan), np.full(frames, np.nan)
    samples = np.where(is_missing(q)[..., None], 0.0, q.astype(np.float64))
    with np.errstate(invalid="ignore"):
        samples = np.nan_to_num(normalize(samples))
    floor = STILL**2 * lag * joints
    first = max(window, min_length, lag + 1)
    cuts: list[int] = []
    start = 0
    while start < frames:
        errors = np.zeros(0)
        moments = np.zeros((joints, 4, 4))
        total, squares = 0.0, 0.0
        cut = None
        for i in range(frames - start):
            if i == len(errors):
                block = samples[start + i : start + i + BLOCK]
                sums = moments + np.cumsum(np.einsum("tja,tjb->tjab", block, block), axis=0)
                moments = sums[-1]
                left = np.linalg.eigvalsh(sums)[..., : 3 - components].sum(axis=(1, 2))
                errors = np.concatenate([errors, left])
            if i < lag:
                continue
            d, count = errors[i] - errors[i - lag], i - lag
            growth[start + i] = d
            if i >= first and start + i + min_length <= frames:
                mean = total / count
                deviation = np.sqrt(max(squares / count - mean * mean, 0.0))
                limit[start + i] = mean + threshold * deviation + floor
                if d > limit[start + i]:
                    cut = start + i
                    break
            total += d
            squares += d * d
        if cut is None:
            break
        cuts.append(cut)
        start = cut
    return np.array(cuts, np.intp), growth, limit
