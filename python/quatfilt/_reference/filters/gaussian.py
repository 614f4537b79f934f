"""The Gaussian filter: a mask of Gaussian weights, on rotations about their reference path."""

from quatfilt._reference._arrays import Reals
from quatfilt._reference.filters.boundary import Boundary
from quatfilt._reference.filters.columns import gaussian_mask, weighted_mean
from quatfilt._reference.filters.development import Columns, filtered


def gaussian(
    q: Reals,
    translation: Reals | None,
    confidence: Reals | None,
    reference_sigma: Reals,
    sigma: Reals,
    boundary: Boundary,
) -> tuple[Reals, Reals | None]:
    """Average the vectors of :mod:`.development` under a Gaussian mask.

    Parameters
    ----------
    q : array (frames, joints, 4)
        Rotations without missing samples.
    translation : array (frames, 3) or None
        Positions of the root, filtered as joint 0.
    confidence : array (frames, joints) or None
        Weights of the samples, from 0 to 1: of the mean, and of the reference path.
    reference_sigma : array (joints,), frames
        Deviation of the mask that makes the reference path.
    sigma : array (joints,), frames
        Deviation of the filter's mask.
    boundary : "mirror", "linear" or "nearest"
        How the vectors go on beyond the ends of the clip; see :mod:`.boundary`.

    Returns
    -------
    rotations : array (frames, joints, 4)
        Unit quaternions, continuous in sign from the hemisphere of the input's first frame.
    translation : array (frames, 3) or None
    """

    def smooth(columns: Columns, joint: int) -> Reals:
        return weighted_mean(columns.vectors, columns.trust, gaussian_mask(float(sigma[joint])), boundary)

    return filtered(q, translation, confidence, reference_sigma, smooth)
