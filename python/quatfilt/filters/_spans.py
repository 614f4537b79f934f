"""What becomes of missing samples, the same for every filter.

Gaps up to `max_gap` are filled along geodesics, and what was filled has confidence 0. Longer gaps stay missing: a joint
is cut where one begins or ends, and its spans are filtered apart. A filter that looks at whole poses has all joints cut
where one of them comes or goes.

Samples of confidence 0 are filled in the same way, however long they last: a filter sees nothing of them. Filters with weights of their
own take the other confidences. For the rest `Clip.pulled` prepares the samples.
"""

import itertools
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Literal, TypeAlias, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from quatfilt import _validation
from quatfilt._backend import ops
from quatfilt._typing import Array, Mask
from quatfilt.filters.gaps import gap_frames

Gaps: TypeAlias = Literal["fill", "keep", "raise"]
"""What becomes of missing samples: filled, left missing, or refused."""

GAPS: tuple[Gaps, ...] = ("fill", "keep", "raise")


@dataclass(frozen=True)
class Span:
    """Frames of a clip, and joints that are there and are filtered in them."""

    frames: slice
    joints: NDArray[np.intp]


@dataclass(frozen=True)
class Clip:
    """A checked clip, its gaps filled, and what is to be said of the result."""

    rotations: Array
    """``(frames, joints, 4)``; NaN only in gaps longer than `max_gap`."""
    confidence: Array | None
    """``(frames, joints)``; 0 where samples were filled in."""
    weighed: bool
    """Whether the caller said how far samples are to be trusted."""
    missing: Mask
    spans: tuple[Span, ...]
    gaps: Gaps
    shape: tuple[int, ...]
    scalar_first: bool

    @property
    def unchanged(self) -> bool:
        """Whether the clip is too short to be filtered."""
        return len(self.rotations) < 2 or self.rotations.size == 0

    @property
    def observed(self) -> Array:
        """The rotations without those that have no confidence, filled ones among them: what noise is measured on."""
        if self.confidence is None:
            return self.rotations
        return np.where(self.confidence[..., None] > 0, self.rotations, np.nan).astype(self.rotations.dtype)

    def finish(self, rotations: Array) -> Array:
        """Return a result in the shape and order of the input, with gaps kept if that was asked for."""
        if self.gaps == "keep" and not self.unchanged:
            rotations[self.missing] = np.nan
        return _validation.scalar_order(rotations.reshape(self.shape), scalar_first=self.scalar_first)

    def filter(self, run: Callable[[Array, Array | None, Span], Array]) -> Array:
        """Run a filter over each span, ``(rotations, confidence, span) -> rotations``, and finish."""
        return self.finish(self.rotations.copy() if self.unchanged else self._each(run))

    def pulled(self) -> "Clip":
        """Return the clip for a filter without weights of its own: samples gave way as far as they are not trusted."""
        if not self.weighed or self.unchanged:
            return self

        def run(rotations: Array, trust: Array | None, _span: Span) -> Array:
            return rotations if trust is None else cast("Array", ops().pulled_by_confidence(rotations, trust))

        return replace(self, rotations=self._each(run))

    def _each(self, run: Callable[[Array, Array | None, Span], Array]) -> Array:
        """Run a filter over each span."""
        frames, joints, _ = self.rotations.shape
        if [(span.frames, len(span.joints)) for span in self.spans] == [(slice(0, frames), joints)]:
            return run(*self.part(self.spans[0]), self.spans[0])
        result = np.full_like(self.rotations, np.nan)
        for span in self.spans:
            result[span.frames, span.joints] = run(*self.part(span), span)
        return result

    def part(self, span: Span) -> tuple[Array, Array | None]:
        """Return the rotations and the confidences of a span; samples of confidence 0 are filled in as missing ones are."""
        frames, joints, _ = self.rotations.shape
        rotations, trust = self.rotations, self.confidence
        if (span.frames, len(span.joints)) != (slice(0, frames), joints):
            rotations = np.ascontiguousarray(rotations[span.frames, span.joints])
            trust = None if trust is None else np.ascontiguousarray(trust[span.frames, span.joints])
        if trust is not None and self.weighed:
            rotations = refilled(rotations, trust == 0)
        return rotations, trust


def refilled(rotations: Array, unknown: Mask) -> Array:
    """Return rotations with samples filled in along geodesics, the joints still in the hemisphere of their first sample.

    A joint of which nothing is known stays as it is.
    """
    unknown = unknown & ~unknown.all(axis=0)
    if not unknown.any():
        return rotations
    known = rotations.copy()
    known[unknown] = np.nan
    filled = cast("Array", ops().fill_gaps(known, -1, "slerp")[0])
    # A rotation and its opposite are the same: this chooses a sign and does no arithmetic.
    opposite = unknown[0] & ((filled[0] * rotations[0]).sum(axis=-1) < 0)
    filled[:, opposite] *= -1
    return filled


def prepare(
    q: ArrayLike,
    *,
    gaps: Gaps,
    max_gap: float | None,
    fps: float,
    confidence: ArrayLike | None,
    scalar_first: bool,
    together: bool = False,
) -> Clip:
    """Check a clip and its options, and fill its gaps; `together` is for filters that look at whole poses."""
    array = _validation.quaternions(q, "rotations", scalar_first=scalar_first)
    rotations, count = _validation.clip(array)
    frames, joints = rotations.shape[:2]
    policy = _validation.choice(gaps, "gaps", GAPS)
    longest = gap_frames(max_gap, fps, frames)
    trust = _validation.confidence(confidence, frames, joints, rotations.dtype)
    missing = np.zeros((frames, joints), dtype=np.bool_)
    spans: tuple[Span, ...] = (Span(slice(0, frames), np.arange(joints)),)
    if count and policy == "raise":
        raise ValueError(f"rotations: expected no missing samples with gaps='raise', got {count}")
    if count and frames > 1:
        missing = ~np.isfinite(rotations).all(axis=-1) | (rotations == 0).all(axis=-1)
        rotations, _ = ops().fill_gaps(rotations, longest, "slerp")
        trust = np.where(missing, 0, 1 if trust is None else trust).astype(rotations.dtype)
        spans = tuple(_spans(np.isnan(rotations[..., 0]), together=together))
    return Clip(rotations, trust, confidence is not None, missing, spans, policy, array.shape, scalar_first)


def _spans(missing: Mask, *, together: bool) -> Iterator[Span]:
    """Cut a clip wherever a joint comes or goes; joints that have the same gaps stay beside each other."""
    groups = np.zeros(missing.shape[1], np.intp)
    if not together:
        groups = np.unique(missing, axis=1, return_inverse=True)[1].ravel()
    for group in range(groups.max(initial=-1) + 1):
        joints = np.flatnonzero(groups == group)
        gone = missing[:, joints]
        changes = 1 + np.flatnonzero((gone[1:] != gone[:-1]).any(axis=1))
        for start, end in itertools.pairwise([0, *changes.tolist(), len(gone)]):
            there = joints[~gone[start]]
            if len(there):
                yield Span(slice(start, end), there)
