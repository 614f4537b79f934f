"""Non-local pose means."""

from collections.abc import Sequence
from typing import Any, Literal, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from quatfilt import _validation
from quatfilt._backend import ops
from quatfilt._typing import Array
from quatfilt.filters import _spans
from quatfilt.filters.boundary import BOUNDARIES, Boundary
from quatfilt.noise._measure import measure

Chart = Literal["mean", "identity", "local"]
Weights = Literal["pose", "joint"]
Distance = Literal["mean", "sum"]

_CHARTS: tuple[Chart, ...] = ("mean", "identity", "local")
WEIGHTS: tuple[Weights, ...] = ("pose", "joint")
DISTANCES: tuple[Distance, ...] = ("mean", "sum")

_LIBRARY_NEIGHBORS = 32
"""How many patches count with a library unless told: of four walks, 16 keep 1 dB more at the paper's noise, and 32 take 1 dB
more away at 15 times as much."""

_WHOLE_CLIP = ALL = NO_LIMIT = -1

_LONGEST_RADIUS = 100_000
"""Frames: windows and patches beyond it would take memory for frames that no clip has."""

MOST = 1_000_000_000
"""More neighbours, and a longer lookahead, than any window has."""

_NOISE_TO_BANDWIDTH = {"pose": 1.0, "joint": 1.2}
"""The automatic bandwidth in units of the estimated noise: best on average over six clips and 1, 5 and 15 times the
paper's noise. Distances of single joints scatter more, and want a little more room."""

_BLOCKS, _BLOCK_FRAMES = 64, 256
"""Longer clips are measured on so many blocks of so many frames: enough for the noise to within one per cent."""

_LEAST_BANDWIDTH = 1e-9
"""Radians: the automatic bandwidth of a joint without noise, whose frames then come back as they are."""


def nonlocal_pose_means(
    q: ArrayLike,
    *,
    search_radius: int | None = 10,
    patch_radius: int = 5,
    bandwidth: float | ArrayLike | Literal["auto"] = "auto",
    distance: Distance = "mean",
    weights: Weights = "pose",
    neighbors: int | None = None,
    library: ArrayLike | Sequence[ArrayLike] | None = None,
    chart: Chart = "mean",
    boundary: Boundary = "nearest",
    lookahead: int | None = None,
    confidence: ArrayLike | None = None,
    gaps: _spans.Gaps = "fill",
    max_gap: float | None = None,
    fps: float = 1.0,
    scalar_first: bool = True,
) -> Array:
    """Denoise by averaging poses whose neighbourhoods in time look alike.

    With the poses `x_t` as rotation vectors in a chart, the patches ``P_t = (x_{t-r}, …, x_{t+r})`` of
    ``2·patch_radius + 1`` frames, and the learning window ``|s − t| ≤ search_radius``::

        f(t, s) = exp(−‖P_s − P_t‖² / (2·bandwidth²))        s ≠ t
        f(t, t) = max(max_s f(t, s), exp(−80))
        x̂_t     = Σ_s f(t, s)·x_s / Σ_s f(t, s)

    where ``‖·‖²`` is the mean square over the patch's frames and coordinates. What repeats is averaged over its
    repetitions, what happens once keeps more of its shape than under a filter of fixed width. Impacts are rounded all the
    same, the more the stronger the noise.

    Parameters
    ----------
    q : array_like, shape (frames, joints, 4) or (frames, 4)
        Unit quaternions along time. NaN or four zeros are missing samples.
    search_radius : int or None, frames, default 10
        Radius of the learning window, from 1 to 100,000; None for the whole clip, at a cost that grows with the square
        of its length.
    patch_radius : int, frames, default 5
        Radius of a patch, from 0 to 100,000.
    bandwidth : float or array_like (joints,), radians of rotation per coordinate, or "auto", default "auto"
        How unlike patches may be. Twice the paper's σ. "auto" takes the noise that `noise_model` measures, its root
        mean square over the joints; for ``weights="joint"`` 1.2 times each joint's own.
    distance : {"mean", "sum"}, default "mean"
        ``"sum"`` is the printed equation, whose bandwidth depends on the patch and on the number of joints.
    weights : {"pose", "joint"}, default "pose"
        One weight per pose, as in the paper; or per joint, so that each joint finds its own repetitions.
    neighbors : int or None, default None
        Only so many most similar patches of the window and the library count; None for all, and for 32 with a library.
    library : array_like (n, joints, 4), list of such, or None, default None
        A clip, or a list or tuple of clips, clean ones of the same person at the same frame rate, whose patches are
        candidates of every frame. Their frames are averaged as they are; missing ones are left out. They have no part in
        the root's translation.
    chart : {"mean", "local", "identity"}, default "mean"
        Where rotations become vectors. ``"mean"``: along the sign-continuous path, at each joint's Karcher mean;
        joints that turn farther than three quarters of a turn from it use ``"local"``. ``"local"``: each pair of
        frames at one of them; the most faithful, and three times slower. ``"identity"``: the paper's; breaks down
        far from the identity. With a library ``"mean"`` stands for ``"local"``, and ``"identity"`` is refused.
    boundary : {"nearest", "mirror", "linear"}, default "nearest"
        How the clip goes on beyond its ends: the end pose is held; time turns round; the angular velocity is held.
    lookahead : int or None, frames, default None
        If given, the window and patches touch no frame later than this one plus `lookahead`.
    confidence : array_like or None, shape (frames,) or (frames, joints), 0…1, default None
        How far each sample counts, in patch distances and in means. Missing samples have 0.
    gaps : {"fill", "keep", "raise"}, default "fill"
        What becomes of missing samples. ``"keep"``: they stay missing, and do not disturb the others.
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
    NonlocalPoseMeansStream : The same for a live source.

    Notes
    -----
    Cost: ``frames · joints · search_radius``, whatever the patch: along one lag the patch distance is a sliding sum,
    and a lag serves both of its signs. Memory beyond the result: one byte per sample and some hundred kB per thread.

    Rule of thumb: leave the bandwidth "auto". Below the noise the filter does nothing; at several times the noise it
    becomes a moving mean, which flattens fast motion. Not for gaps wider than the window, nor for single-frame spikes.

    A neighbour that is as near as another within rounding may replace it when `neighbors` is given.

    References
    ----------
    .. [1] C. J. Dean and J. P. Lewis, "Non-local pose means for denoising motion capture data".
    .. [2] A. Buades, B. Coll and J.-M. Morel, "A non-local algorithm for image denoising", CVPR 2005.

    Examples
    --------
    >>> import numpy as np, quatfilt as qf
    >>> t = np.arange(240) / 120
    >>> swing = qf.exp(0.4 * np.sin(2 * np.pi * t)[:, None] * [0.0, 0.0, 1.0])
    >>> noisy = qf.add_gaussian_noise(swing, sigma=np.radians(2), rng=0)
    >>> clean = qf.nonlocal_pose_means(noisy)
    >>> error = lambda q: float(np.degrees(qf.geodesic_distance(swing, q)).mean())
    >>> error(clean) < 0.7 * error(noisy)
    True
    """
    return with_translation(
        q,
        None,
        search_radius=search_radius,
        patch_radius=patch_radius,
        bandwidth=bandwidth,
        distance=distance,
        weights=weights,
        neighbors=neighbors,
        library=library,
        chart=chart,
        boundary=boundary,
        lookahead=lookahead,
        confidence=confidence,
        gaps=gaps,
        max_gap=max_gap,
        fps=fps,
        scalar_first=scalar_first,
    )[0]


def with_translation(
    q: ArrayLike,
    translation: Array | None,
    *,
    bandwidth: float | ArrayLike | Literal["auto"],
    confidence: ArrayLike | None,
    gaps: _spans.Gaps,
    max_gap: float | None,
    fps: float,
    scalar_first: bool,
    **window: Any,
) -> tuple[Array, Array | None]:
    """Filter as `nonlocal_pose_means` does, and a translation ``(frames, 3)`` with the root's weights."""
    clip = _spans.prepare(
        q,
        gaps=gaps,
        max_gap=max_gap,
        fps=fps,
        confidence=confidence,
        scalar_first=scalar_first,
        together=True,
    )
    others, lengths = _validation.library(window.pop("library"), clip.rotations, scalar_first=scalar_first)
    options = _checked(bandwidth=bandwidth, **window, borrows=others is not None)
    bandwidths = _joint_bandwidths(clip, bandwidth, window["weights"], fps)
    moved = None if translation is None else translation.astype(clip.rotations.dtype)

    def run(rotations: Array, trust: Array | None, span: _spans.Span) -> Array:
        # Without the root there are no weights for its translation.
        part = moved[span.frames] if moved is not None and 0 in span.joints else None
        beside = None if others is None else np.ascontiguousarray(others[:, span.joints])
        result, along = ops().nonlocal_pose_means(
            rotations, part, trust, bandwidths[span.joints], *options, beside, lengths
        )
        if moved is not None and along is not None:
            moved[span.frames] = along
        return cast("Array", result)

    return clip.filter(run), moved


def _checked(
    *,
    search_radius: int | None,
    patch_radius: int,
    bandwidth: float | ArrayLike | Literal["auto"],
    distance: Distance,
    weights: Weights,
    neighbors: int | None,
    chart: Chart,
    boundary: Boundary,
    lookahead: int | None,
    borrows: bool = False,
) -> tuple[Any, ...]:
    """Return the options after the bandwidth as the backends take them."""
    if isinstance(bandwidth, str):
        _validation.known(bandwidth, "bandwidth", ("auto",), "'auto', a number or one per joint")
    seen = _validation.choice(chart, "chart", _CHARTS)
    if borrows:
        if seen == "identity":
            raise ValueError("chart: expected 'mean' or 'local' with a library, got 'identity'")
        seen = "local"
        neighbors = _LIBRARY_NEIGHBORS if neighbors is None else neighbors
    return (
        _WHOLE_CLIP
        if search_radius is None
        else _validation.integer(search_radius, "search_radius", at_least=1, at_most=_LONGEST_RADIUS),
        _validation.integer(patch_radius, "patch_radius", at_least=0, at_most=_LONGEST_RADIUS),
        _validation.choice(distance, "distance", DISTANCES),
        _validation.choice(weights, "weights", WEIGHTS),
        ALL if neighbors is None else _validation.integer(neighbors, "neighbors", at_least=1, at_most=MOST),
        seen,
        _validation.choice(boundary, "boundary", BOUNDARIES),
        NO_LIMIT
        if lookahead is None
        else _validation.integer(lookahead, "lookahead", at_least=0, at_most=MOST),
    )


def _sample(clip: _spans.Clip) -> Array:
    """Return what the noise is measured on: all frames of a short clip, evenly spaced blocks of a long one.

    What nobody trusts is left out. A missing frame stands between blocks, for no difference is taken across one.
    """
    rotations = clip.rotations
    missing = clip.missing if clip.confidence is None else np.asarray(clip.confidence == 0)
    if len(rotations) > _BLOCKS * _BLOCK_FRAMES:
        starts = np.linspace(0, len(rotations) - _BLOCK_FRAMES, _BLOCKS).astype(np.intp)
        blocks = (starts[:, None] + np.arange(_BLOCK_FRAMES)).ravel()
        rotations, missing = rotations[blocks], missing[blocks].copy()
        missing[_BLOCK_FRAMES - 1 :: _BLOCK_FRAMES] = True
    elif missing.any():
        rotations = rotations.copy()
    if missing.any():
        rotations[missing] = np.nan
    return rotations


def _joint_bandwidths(
    clip: _spans.Clip, bandwidth: float | ArrayLike | Literal["auto"], weights: Weights, fps: float
) -> NDArray[np.float64]:
    """Return the bandwidth of each joint."""
    joints = clip.rotations.shape[1]
    if not isinstance(bandwidth, str):
        return _validation.per_joint(bandwidth, "bandwidth", joints, above=0)
    if clip.unchanged:
        return np.full(joints, _LEAST_BANDWIDTH)
    noise = measure(_sample(clip), fps=fps).level
    if weights == "pose":
        noise = np.full(joints, np.sqrt(np.mean(noise**2)))
    return np.maximum(_NOISE_TO_BANDWIDTH[weights] * noise, _LEAST_BANDWIDTH)


__all__ = [
    "ALL",
    "DISTANCES",
    "MOST",
    "NO_LIMIT",
    "WEIGHTS",
    "Boundary",
    "Chart",
    "Distance",
    "Weights",
    "nonlocal_pose_means",
    "with_translation",
]
