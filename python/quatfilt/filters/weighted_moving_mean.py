"""Blender's weighted moving mean."""

from typing import Any, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from quatfilt import _validation
from quatfilt._backend import ops
from quatfilt._typing import Array
from quatfilt.filters import _development, _spans


def weighted_moving_mean(
    q: ArrayLike,
    *,
    iterations: int = 1,
    confidence: ArrayLike | None = None,
    gaps: _spans.Gaps = "fill",
    max_gap: float | None = None,
    fps: float = 1.0,
    scalar_first: bool = True,
) -> Array:
    """Smooth rotations as Blender's "Smooth Keys" smooths the keys of a curve.

    Of the numbers ``p₂ p₁ c n₁ n₂`` around a frame it takes the mean of ``(3p₂ + 5p₁ + 2c + n₁ + n₂)/12`` and
    ``(p₂ + p₁ + 2c + 5n₁ + 3n₂)/12``, that is the mask ``(2, 3, 2, 3, 2)/12``. Blender does so for each channel; here it is
    done for the rotations as vectors about a smooth reference path, see `gaussian`.

    Parameters
    ----------
    q : array_like, shape (frames, joints, 4) or (frames, 4)
        Unit quaternions along time. NaN or four zeros are missing samples.
    iterations : int, default 1
        How often the filter is applied.
    confidence : array_like or None, shape (frames,) or (frames, joints), default None
        How far samples are believed, from 0 to 1, rather than the weighted mean of those near them; NaN counts as 0.
        Samples that were filled in have 0.
    gaps : {"fill", "keep", "raise"}, default "fill"
        What becomes of missing samples. With ``"fill"`` they are estimated from their neighbours; with ``"keep"`` they are
        missing again in the result.
    max_gap : float or None, seconds, default None
        The longest gap that is filled; None for any. Longer ones stay missing, and their sides are filtered apart.
    fps : float, hertz, default 1.0
        Frame rate, for `max_gap`; without it `max_gap` counts frames.
    scalar_first : bool, default True
        Whether quaternions are ``(w, x, y, z)``; False for SciPy's ``(x, y, z, w)``.

    Returns
    -------
    ndarray, shape of `q`
        Unit quaternions, continuous in sign from the hemisphere of the first frame on.

    Raises
    ------
    ValueError, TypeError
        If an argument has another shape, type or range than stated; the message names it.

    See Also
    --------
    gaussian : A mask that falls off, and whose width is a time.

    Notes
    -----
    The end frames stay. Where the second neighbour lies beyond an end, the first one stands for it. Blender does so at
    frame 2 as well, which has a second neighbour: its test is ``i − 2 > 0``. This is kept, so that a clip that runs
    backwards is smoothed a little differently at its ends.

    The mask has the variance 11/6 frames²: `n` passes resemble a Gaussian of ``1.35·√n`` frames.

    Cost: ``iterations · frames · joints``.

    Examples
    --------
    >>> import numpy as np, quatfilt as qf
    >>> t = np.arange(240) / 120
    >>> swing = qf.exp(0.4 * np.sin(2 * np.pi * t)[:, None] * [0.0, 0.0, 1.0])
    >>> noisy = qf.add_gaussian_noise(swing, sigma=np.radians(2), rng=0)
    >>> clean = qf.weighted_moving_mean(noisy, iterations=4)
    >>> error = lambda q: float(np.degrees(qf.geodesic_distance(swing, q)).mean())
    >>> error(clean) < 0.5 * error(noisy)
    True
    """
    return with_translation(
        q,
        None,
        iterations=iterations,
        confidence=confidence,
        gaps=gaps,
        max_gap=max_gap,
        fps=fps,
        scalar_first=scalar_first,
    )[0]


def with_translation(
    q: ArrayLike, translation: Array | None, *, iterations: int, **missing: Any
) -> tuple[Array, Array | None]:
    """Filter as `weighted_moving_mean` does, and a translation ``(frames, 3)`` alike."""
    clip = _spans.prepare(q, **missing)
    passes = _validation.integer(iterations, "iterations", at_least=1)
    scale = np.full(clip.rotations.shape[1], np.sqrt(2.0 * passes))
    reference = _development.reference_sigma(scale)

    def run(
        rotations: Array, along: Array | None, trust: Array | None, there: NDArray[np.intp]
    ) -> tuple[Array, Array | None]:
        result = ops().weighted_moving_mean(rotations, along, trust, reference[there], passes)
        return cast("tuple[Array, Array | None]", result)

    return _development.filtered(clip, translation, run)


__all__ = ["weighted_moving_mean", "with_translation"]
