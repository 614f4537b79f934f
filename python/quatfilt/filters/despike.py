"""Spikes: samples that leave the motion and come back at once."""

from dataclasses import dataclass, replace
from typing import Any, Literal, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from quatfilt import _validation
from quatfilt._backend import ops
from quatfilt._typing import Array, Mask, PerJoint
from quatfilt.filters import _spans
from quatfilt.filters.gaps import gap_frames

_LONGEST_RADIUS = 1000
"""Frames: a run that lasts longer is no spike at any frame rate."""

_REACH, _LEAST_RADIUS = 0.075, 3
"""Seconds and frames: "auto". Runs of up to nine frames at 120 per second are judged by the motion around them; fewer neighbours than the second
show no motion."""

_DURATION = 0.375
"""Seconds: "auto". Trackers find a limb that they lost within a third of a second or not at all: 11 frames at 30 per second."""

_LONGEST_BURST = 10_000
"""Frames: likewise, for bursts and swaps."""

_ROUNDINGS = 8
"""By so many times the spacing of numbers at 1 the square of a length may differ from 1 and the quaternion be left as it is."""

_JITTER = 0.105
"""Radians: recordings of bodies jitter by up to that."""

_ACCELERATION = 500.0
"""rad/s²: what the joints of people reach in kicks and punches. Half of it times the square of a frame is how far a joint gets out of
a straight line."""


def despike(
    q: ArrayLike,
    *,
    radius: int | Literal["auto"] = 3,
    threshold: PerJoint = 4.0,
    smallest: PerJoint | Literal["auto"] = "auto",
    duration: float | Literal["auto"] = "auto",
    confidence: ArrayLike | None = None,
    gaps: _spans.Gaps = "fill",
    max_gap: float | None = None,
    fps: float = 1.0,
    scalar_first: bool = True,
) -> Array:
    """Replace spikes, bursts and left/right swaps, and nothing else.

    Three kinds of samples are replaced:

    - spikes: runs of fewer samples than `radius` that leave the motion and come back at once. They are far from where the
      samples before have the joint, resting or moving on, from where those after have it, and from the way between them. Steps, fast swings,
      impacts and the first moves after a rest are none of it: one side explains them. Far is more than `threshold` times what is usual,
      the median of the same deviation around the run, and at least what noise of the joint's level makes usual; more than
      `smallest`; and more than the joint moves in two frames;
    - bursts: longer runs, up to `duration`, that the joint jumps into and jumps back from, beside calm motion. Both jumps are three times as
      long as any step within the run or beside it. A limb, however quick, does not start and stop within one frame;
    - swaps: two joints that jump into each other's place and back within `duration`. They get back what is theirs.

    Spikes and bursts are replaced along the geodesics between the samples beside them. All other samples stay as they are, bit for
    bit, but for the sign of quaternions, and for lengths that are not 1.

    Parameters
    ----------
    q : array_like, shape (frames, joints, 4) or (frames, 4)
        Unit quaternions along time. NaN or four zeros are missing samples.
    radius : int, frames, or "auto", default 3
        Spikes are shorter than this, bursts are not; and so many neighbours on either side of a spike are asked. From 2 to 1000.
        "auto", which `denoise` takes, is ``round(0.075 fps) + 1`` and at least 3: 10 at 120 frames per second; 3 where `fps` is not given.
    threshold : float or array_like (joints,), default 4.0
        How many times as far as usual a spike is. Smaller finds more.
    smallest : float or array_like (joints,), radians of rotation, or "auto", default "auto"
        Spikes are larger than this. "auto" is 0.105, or 6°: recordings of bodies jitter by up to that. Below 49 frames per second
        it is ``250 / fps²``: so far a quick limb gets out of a straight line within a frame, 16° at 30.
    duration : float, seconds, or "auto", default "auto"
        The longest burst and the longest swap; 0 for none. "auto" is 0.375, which is 11 frames at 30 per second, and 0
        where `fps` is not given.
    confidence : array_like, shape (frames,) or (frames, joints), 0…1, or None, default None
        Samples of confidence 0 are replaced whatever they are, and nothing is judged by them. A confidence in between is
        a factor to the threshold.
    gaps : {"fill", "keep", "raise"}, default "fill"
        What becomes of missing samples. Filled ones are no spikes, and nothing is judged by them; with ``"keep"`` they
        are missing again in the result.
    max_gap : float or None, seconds, default None
        The longest gap that is filled; None for any. Longer ones stay missing, and their sides are looked at apart.
    fps : float, hertz, default 1.0
        Frame rate, for `max_gap`, `duration`, `radius` and `smallest`; without it these count frames, and nothing is known of quick limbs.
    scalar_first : bool, default True
        Whether quaternions are ``(w, x, y, z)``; False for SciPy's ``(x, y, z, w)``.

    Returns
    -------
    ndarray, shape of `q`
        Continuous in sign from the first frame on.

    Raises
    ------
    ValueError, TypeError
        If an argument has another shape, type or range than stated; the message names it.

    See Also
    --------
    quatfilt.filters.despike.spikes : The mask of what is replaced.
    noise_level : The level of noise that is taken into account.

    Notes
    -----
    Cost: linear in samples, some 50 ns each per thread; some microseconds for each spike. The first and the last frame have
    neighbours on one side only and stay.

    References
    ----------
    .. [1] F. R. Hampel, "The influence curve and its role in robust estimation", Journal of the American Statistical
       Association 69, 1974.

    Examples
    --------
    >>> import numpy as np, quatfilt as qf
    >>> t = np.arange(240) / 120
    >>> swing = qf.exp(0.4 * np.sin(2 * np.pi * t)[:, None] * [0.0, 0.0, 1.0])
    >>> spoilt = swing.copy()
    >>> spoilt[100] = qf.multiply(swing[100], qf.exp([0.2, 0.0, 0.0]))
    >>> clean = qf.despike(spoilt)
    >>> np.flatnonzero((clean != spoilt).any(axis=-1))
    array([100])
    >>> float(np.degrees(qf.geodesic_distance(clean, swing)).max()) < 0.1
    True
    """
    return with_translation(
        q,
        None,
        radius=radius,
        threshold=threshold,
        smallest=smallest,
        duration=duration,
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
    radius: int | Literal["auto"],
    threshold: PerJoint,
    smallest: PerJoint | Literal["auto"],
    duration: float | Literal["auto"],
    confidence: ArrayLike | None,
    fps: float,
    **missing: Any,
) -> tuple[Array, Array | None]:
    """Replace spikes as `despike` does, and those of a translation ``(frames, 3)``, along straight lines.

    The translation is judged by itself, with the confidences of the root and without a smallest distance.
    """
    clip = _spans.prepare(q, confidence=confidence, fps=fps, **missing)
    limits = _limits(clip, radius=radius, threshold=threshold, smallest=smallest, duration=duration, fps=fps)
    result, _ = limits.apply(clip)
    if translation is None:
        return result, None
    moved = translation.astype(clip.rotations.dtype)
    frames, joints = clip.rotations.shape[:2]
    trust = _validation.confidence(confidence, frames, joints, moved.dtype)
    root = None if trust is None or trust.size == 0 else np.ascontiguousarray(trust[:, :1])
    return result, limits.straightened(moved, root)


def spikes(
    q: ArrayLike,
    *,
    radius: int | Literal["auto"] = 3,
    threshold: PerJoint = 4.0,
    smallest: PerJoint | Literal["auto"] = "auto",
    duration: float | Literal["auto"] = "auto",
    confidence: ArrayLike | None = None,
    max_gap: float | None = None,
    fps: float = 1.0,
    scalar_first: bool = True,
) -> Mask:
    """Tell which samples `despike` takes for spikes, with the same options.

    Returns
    -------
    ndarray of bool, shape (frames, joints) or (frames,)
        Where samples are spikes. Missing ones and those of confidence 0 are none.
    """
    clip = _spans.prepare(
        q, gaps="fill", max_gap=max_gap, fps=fps, confidence=confidence, scalar_first=scalar_first
    )
    _, found = _limits(
        clip, radius=radius, threshold=threshold, smallest=smallest, duration=duration, fps=fps
    ).apply(clip)
    return found.reshape(clip.shape[:-1])


@dataclass(frozen=True)
class _Limits:
    """What is a spike, checked."""

    radius: int
    threshold: NDArray[np.float64]
    smallest: NDArray[np.float64]
    longest: int
    """The longest burst and the longest swap, in frames."""

    def apply(self, clip: _spans.Clip) -> tuple[Array, Mask]:
        """Return the finished clip without its spikes, and where they were, ``(frames, joints)``."""
        found: Mask = np.zeros(clip.rotations.shape[:2], np.bool_)

        whole = clip if clip.unchanged else _normalized(clip)
        noise = None
        if self.longest > 0 and not clip.unchanged:
            noise = np.asarray(ops().noise_level(whole.observed), np.float64)
            whole, found = self.exchanged(whole, noise)
        if found.any() or clip.confidence is not None:
            # Noise is measured on what is in its place, and in each span for itself.
            noise = None

        def run(rotations: Array, trust: Array | None, span: _spans.Span) -> Array:
            smallest, threshold = self.smallest[span.joints], self.threshold[span.joints]
            here = self.find(rotations, trust, smallest, threshold, noise)
            found[span.frames, span.joints] |= here
            gone = here if trust is None else here | (trust == 0)
            # A joint that is trusted nowhere has nothing to be replaced by.
            gone &= ~gone.all(axis=0)
            return cast("Array", ops().fill_gaps(_without(rotations, gone), -1, "slerp")[0])

        return whole.filter(run), found

    def exchanged(self, clip: _spans.Clip, noise: NDArray[np.float64]) -> tuple[_spans.Clip, Mask]:
        """Return the clip with joints back in their own places where they were swapped, and where that was."""
        frames, joints, _ = clip.rotations.shape
        swapped: Mask = np.zeros((frames, joints), np.bool_)
        # A threshold of each joint's own is a factor to its noise.
        swaps = ops().find_swaps(
            clip.rotations, clip.confidence, self.threshold * noise, self.smallest, 1.0, self.longest
        )
        if not len(swaps):
            return clip, swapped
        rotations, missing = clip.rotations.copy(), clip.missing.copy()
        trust = None if clip.confidence is None else clip.confidence.copy()
        for a, b, start, end in swaps.tolist():
            run, pair = slice(start, end), [a, b]
            # Gaps that stay are cuts: what is beyond them is another span.
            if not np.isnan(rotations[run, pair]).any():
                for array in (rotations, missing, *(() if trust is None else (trust,))):
                    array[run, pair] = array[run, pair[::-1]]
                swapped[run, pair] = True
        return replace(clip, rotations=rotations, missing=missing, confidence=trust), swapped

    def straightened(self, moved: Array, trust: Array | None) -> Array:
        """Return positions ``(frames, 3)`` without their spikes, given confidences ``(frames, 1)``."""
        if len(moved) < 2 or not len(self.threshold):
            return moved
        found = self.find(np.ascontiguousarray(moved[:, None]), trust, np.zeros(1), self.threshold[:1])
        gone = (found if trust is None else found | (trust == 0))[:, 0]
        if not gone.any() or gone.all():
            return moved
        frames = np.arange(len(moved))
        columns = [np.interp(frames[gone], frames[~gone], column[~gone]) for column in moved.T]
        result = moved.copy()
        result[gone] = np.stack(columns, axis=1)
        return result

    def find(
        self,
        x: Array,
        trust: Array | None,
        smallest: NDArray[np.float64],
        threshold: NDArray[np.float64],
        noise: NDArray[np.float64] | None = None,
    ) -> Mask:
        """Return where spikes are in rotations ``(frames, joints, 4)`` or positions ``(frames, points, 3)``."""
        if noise is None:
            known = x if trust is None or x.shape[-1] == 3 else _without(x, trust == 0)
            noise = np.asarray(ops().noise_level(known), np.float64)
        levels = np.unique(threshold)
        if len(levels) == 1:
            return cast("Mask", self._found(x, trust, noise, smallest, float(levels[0])))
        found: Mask = np.zeros(x.shape[:2], np.bool_)
        for level in levels:
            own = np.flatnonzero(threshold == level)
            weights = None if trust is None else np.ascontiguousarray(trust[:, own])
            part = np.ascontiguousarray(x[:, own])
            found[:, own] = self._found(part, weights, noise[own], smallest[own], float(level))
        return found

    def _found(
        self,
        x: Array,
        trust: Array | None,
        noise: NDArray[np.float64],
        smallest: NDArray[np.float64],
        threshold: float,
    ) -> Any:
        return ops().find_spikes(x, trust, noise, smallest, self.radius, threshold, self.longest)


def _limits(
    clip: _spans.Clip,
    *,
    radius: int | Literal["auto"],
    threshold: PerJoint,
    smallest: PerJoint | Literal["auto"],
    duration: float | Literal["auto"],
    fps: float,
) -> _Limits:
    rate = _validation.number(fps, "fps", above=0)
    if isinstance(radius, str):
        _validation.known(radius, "radius", ("auto",), "'auto' or a number of frames")
        radius = min(max(round(_REACH * rate) + 1, _LEAST_RADIUS), _LONGEST_RADIUS)
    if isinstance(duration, str):
        _validation.known(duration, "duration", ("auto",), "'auto' or a number of seconds")
        duration = _DURATION if rate > 1 else 0.0
    if isinstance(smallest, str):
        _validation.known(smallest, "smallest", ("auto",), "'auto', a number or one per joint")
        smallest = _JITTER if rate <= 1 else max(_JITTER, _ACCELERATION / 2 / rate**2)
    return _Limits(
        _validation.integer(radius, "radius", at_least=2, at_most=_LONGEST_RADIUS),
        _validation.per_joint(threshold, "threshold", clip.rotations.shape[1], above=0),
        _validation.per_joint(smallest, "smallest", clip.rotations.shape[1], at_least=0),
        gap_frames(duration, rate, _LONGEST_BURST, "duration"),
    )


def _normalized(clip: _spans.Clip) -> _spans.Clip:
    """Return the clip with unit quaternions; those that are of unit length up to rounding stay bit for bit."""
    q = clip.rotations
    squares = np.einsum("...i,...i->...", q, q)
    off = np.abs(squares - 1) > _ROUNDINGS * np.finfo(q.dtype).eps
    if not off.any():
        return clip
    rotations = q.copy()
    rotations[off] = ops().normalize(np.ascontiguousarray(q[off]))
    return replace(clip, rotations=rotations)


def _without(rotations: Array, gone: Mask) -> Array:
    known = rotations.copy()
    known[gone] = np.nan
    return known


__all__ = ["despike", "spikes", "with_translation"]
