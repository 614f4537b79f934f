"""What the filters for numbers have in common: rotations become vectors about a reference path, and rotations again."""

from collections.abc import Callable
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from quatfilt._typing import Array
from quatfilt.filters import _spans

_SHORTEST, _LONGEST = 1.0, 12.0
"""Frames: a reference path that follows the noise lets its commutators add up, and one that lags far behind sees the
samples where the vectors are bent."""

Run: TypeAlias = Callable[[Array, Array | None, Array | None, NDArray[np.intp]], tuple[Array, Array | None]]
"""From rotations, translation, confidence and the joints that they are, to rotations and translation."""


def reference_sigma(frames: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the deviation of the mask that makes the reference path, for the scale of a filter in frames."""
    return np.clip(frames, _SHORTEST, _LONGEST)


RunSpan: TypeAlias = Callable[[Array, Array | None, Array | None, _spans.Span], tuple[Array, Array | None]]
"""The same, given the span."""


def filtered(clip: _spans.Clip, translation: Array | None, run: Run) -> tuple[Array, Array | None]:
    """Run a filter over each span of a clip, and over a translation ``(frames, 3)`` where joint 0 is there."""

    def one(
        rotations: Array, part: Array | None, trust: Array | None, span: _spans.Span
    ) -> tuple[Array, Array | None]:
        return run(rotations, part, trust, span.joints)

    return filtered_spans(clip, translation, one)


def filtered_spans(clip: _spans.Clip, translation: Array | None, run: RunSpan) -> tuple[Array, Array | None]:
    """Run a filter as `filtered` does, one that knows where its span lies."""
    moved = None if translation is None else translation.astype(clip.rotations.dtype)

    def one(rotations: Array, trust: Array | None, span: _spans.Span) -> Array:
        part = moved[span.frames] if moved is not None and 0 in span.joints else None
        result, along = run(rotations, part, trust, span)
        if moved is not None and along is not None:
            moved[span.frames] = along
        return result

    return clip.filter(one), moved
