"""The 1€ filter."""

from typing import Any, cast

from numpy.typing import ArrayLike

from quatfilt import _validation
from quatfilt._backend import ops
from quatfilt._typing import Array
from quatfilt.filters import _spans


def one_euro(
    q: ArrayLike,
    *,
    fps: float = 1.0,
    min_cutoff: float | ArrayLike = 1.0,
    beta: float | ArrayLike = 0.0,
    derivative_cutoff: float | ArrayLike = 1.0,
    confidence: ArrayLike | None = None,
    gaps: _spans.Gaps = "fill",
    max_gap: float | None = None,
    scalar_first: bool = True,
) -> Array:
    """Smooth rotations without a view ahead: little noise at rest, little delay in motion.

    A low pass of first order whose cutoff grows with the speed. With the sample `y` before, and its result `x`::

        α(f) = 1 / (1 + fps / (2π f))
        ω    ← ω + α(derivative_cutoff)·(2·log(y⁻¹·z)·fps − ω)
        f    = min_cutoff + beta·|ω|
        x    ← x·exp(α(f)·log(x⁻¹·z))

    Parameters
    ----------
    q : array_like, shape (frames, joints, 4) or (frames, 4)
        Unit quaternions along time. NaN or four zeros are missing samples.
    fps : float, hertz, default 1.0
        Frame rate; without it seconds are frames.
    min_cutoff : float or array_like (joints,), hertz, default 1.0
        Cutoff at rest, above 0: the lower, the less noise and the more delay. Infinite: nothing is filtered.
    beta : float or array_like (joints,), 1/rad, default 0.0
        How fast the cutoff grows with the speed, in hertz per rad/s, at least 0: the higher, the less delay in motion.
    derivative_cutoff : float or array_like (joints,), hertz, default 1.0
        Cutoff of the angular velocity, above 0.
    confidence : array_like or None, shape (frames,) or (frames, joints), 0…1, default None
        Each sample's share α is multiplied by it. 0 is a missing sample.
    gaps : {"fill", "keep", "raise"}, default "fill"
        What becomes of missing samples. Where they are filled, the result stays as it was before the gap.
    max_gap : float or None, seconds, default None
        The longest gap that is filled; None for any. Longer ones stay missing, and their sides are filtered apart.
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
    kalman : Follows the velocity too, so that it lags less, and can look ahead.

    Notes
    -----
    Delay of slow motion: ``1 / (2π f)`` seconds for a cutoff `f`, 0.16 s at 1 Hz.

    The velocity is that from sample to sample, as in the authors' code of the years after the paper. The paper's algorithm,
    and their code since 2023, measure it from the result before, which lags: a speed that grows with the frame rate, by a
    factor of 1/α at rest. Here `beta` means the same at every frame rate.

    After missing samples the time since the last one counts. Before a joint's first sample its pose stays.

    Tuning, after the paper: with ``beta=0`` lower `min_cutoff` until a pose that is held does not tremble; then raise
    `beta` until fast motion does not lag.

    Cost: about 30 ns per sample.

    References
    ----------
    .. [1] G. Casiez, N. Roussel and D. Vogel, "1€ filter: a simple speed-based low-pass filter for noisy input in
       interactive systems", CHI 2012.

    Examples
    --------
    >>> import numpy as np, quatfilt as qf
    >>> still = np.tile([1.0, 0.0, 0.0, 0.0], (240, 1))
    >>> noisy = qf.add_gaussian_noise(still, sigma=np.radians(2), rng=0)
    >>> error = lambda q: float(np.degrees(qf.geodesic_distance(still, q)).mean())
    >>> error(qf.one_euro(noisy, fps=120, min_cutoff=1.0, beta=0.3)) < 0.5 * error(noisy)
    True
    """
    return with_translation(
        q,
        None,
        fps=fps,
        min_cutoff=min_cutoff,
        beta=beta,
        derivative_cutoff=derivative_cutoff,
        confidence=confidence,
        gaps=gaps,
        max_gap=max_gap,
        scalar_first=scalar_first,
    )[0]


def with_translation(
    q: ArrayLike,
    translation: Array | None,
    *,
    fps: float,
    min_cutoff: float | ArrayLike,
    beta: float | ArrayLike,
    derivative_cutoff: float | ArrayLike,
    **missing: Any,
) -> tuple[Array, Array | None]:
    """Filter as `one_euro` does, and a translation ``(frames, 3)`` with the root's shares."""
    clip = _spans.prepare(q, fps=fps, **missing)
    joints = clip.rotations.shape[1]
    rate = float(fps)
    least = _validation.per_joint(min_cutoff, "min_cutoff", joints, above=0, infinite=True) / rate
    growth = _validation.per_joint(beta, "beta", joints, at_least=0)
    derivative = (
        _validation.per_joint(derivative_cutoff, "derivative_cutoff", joints, above=0, infinite=True) / rate
    )
    moved = None if translation is None else translation.astype(clip.rotations.dtype)

    def run(rotations: Array, trust: Array | None, span: _spans.Span) -> Array:
        # Without the root there are no shares for its translation.
        part = moved[span.frames] if moved is not None and 0 in span.joints else None
        cutoffs = (x[span.joints] for x in (least, growth, derivative))
        result, along = ops().one_euro(rotations, part, trust, *cutoffs)
        if moved is not None and along is not None:
            moved[span.frames] = along
        return cast("Array", result)

    return clip.filter(run), moved


__all__ = ["one_euro", "with_translation"]
