"""Rotations with measured noise, made such that a filter for white and steady noise is right for them, and back."""

import math
from dataclasses import dataclass
from typing import cast

import numpy as np
from numpy.typing import NDArray

from quatfilt._backend import ops
from quatfilt._typing import Array
from quatfilt.filters import _spans
from quatfilt.filters.kalman import kalman
from quatfilt.noise._measure import Measured

_REFERENCE_SIGMA = 10.0
"""Frames: deviation of the Gaussian mask of the path that vectors are whitened about."""

_OUTLYING = 9.0
"""Variances above so many times that of the quiet part are cut down to it: a sample keeps at most three deviations."""

_LEAST_CONFIDENCE = 0.01
"""Confidence of the noisiest samples."""

_QUIET = 0.25
"""Quantile over time of the variance that stands for the quiet part."""

_LEAST_SHARE = 0.35
"""Share of the level that is taken for noise where it may as well be what fast motion leaves in the differences."""

_LEARNED_EVIDENCE = 0.5
"""Evidence of noise up to which there is no learned correction: the network has seen noise alone, and takes the motion of a clean clip for it."""

_LEARNED_SHARE = 1 / 3
"""Share of the learned correction where the noise is coloured or unsteady: what its network reads there depends on how well the noise was
measured."""


@dataclass(frozen=True)
class White:
    """Rotations whose noise is white, steady and alike in all directions."""

    rotations: Array
    confidence: Array | None
    noise: NDArray[np.float64]
    """``(joints,)``, radians."""
    before: Array
    developed: tuple[NDArray[np.float64], ...] | None
    """Reference path and development of the rotations before, and of the white ones; None where both are the same."""
    shape: tuple[float, NDArray[np.float64], NDArray[np.float64]]
    """Colour, spread and axes of the noise, as `whiten` takes them."""

    def back(self, result: Array) -> Array:
        """Return filtered white rotations as what they stand for."""
        if self.developed is None:
            return result
        reference, development, path, flat = self.developed
        vectors = ops().unwhiten(result, path, flat, *self.shape)
        return cast("Array", ops().undevelop(self.before, reference, development, vectors))


def assumed_level(model: Measured) -> NDArray[np.float64]:
    """Return the level that a filter takes for white noise, ``(joints,)``, radians."""
    return np.asarray(model.white * (_LEAST_SHARE + (1 - _LEAST_SHARE) * model.evidence))


def learned_share(model: Measured) -> float:
    """Return the part of the learned correction that counts, from 0 to 1."""
    sure = max(model.evidence - _LEARNED_EVIDENCE, 0) / (1 - _LEARNED_EVIDENCE)
    return sure if model.colour == 0 and model.steady else sure * _LEARNED_SHARE


def whitened(
    rotations: Array, confidence: Array | None, noise: NDArray[np.float64], span: _spans.Span, model: Measured
) -> White:
    """Prepare the rotations of a span without missing samples; `noise` is the level that a filter takes for white noise.

    Where the variance changes along time, samples in noisy stretches are drawn towards what the Kalman smoother makes of the quiet
    ones, and have less confidence. Coloured noise, and noise that differs between axes, is whitened.
    """
    if not model.steady:
        rotations, confidence, noise = _calmed(rotations, confidence, noise, span, model)
    joints = span.joints
    shape = (model.colour, *_rounded(model, joints))
    if model.colour == 0 and model.round:
        return White(rotations, confidence, noise, rotations, None, shape)
    sigma = np.full(len(joints), _REFERENCE_SIGMA)
    reference, development, vectors = ops().develop(rotations, confidence, sigma)
    path, flat, white = ops().whiten(reference, development, vectors, *shape)
    result = ops().undevelop(rotations, path, flat, white)
    observed = [rotations, result]
    if confidence is not None:
        observed = [np.where(confidence[..., None] > 0, x, np.nan).astype(x.dtype) for x in observed]
    before, after = (ops().noise_level(x).astype(np.float64) for x in observed)
    scale = np.divide(after, before, out=np.ones_like(after), where=before > 0)
    return White(result, confidence, noise * scale, rotations, (reference, development, path, flat), shape)


def _rounded(model: Measured, joints: NDArray[np.intp]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    if model.round:
        return np.ones((len(joints), 3)), np.tile(np.eye(3), (len(joints), 1, 1))
    # The smallest deviation is 1: whitening never makes rotations larger, which would bend them.
    spread = model.spread[joints] / model.spread[joints, :1]
    return np.ascontiguousarray(spread), np.ascontiguousarray(model.axes[joints])


def _calmed(
    rotations: Array, confidence: Array | None, noise: NDArray[np.float64], span: _spans.Span, model: Measured
) -> tuple[Array, Array, NDArray[np.float64]]:
    """Return rotations without the worst of noisy stretches, their confidence, and their level."""
    quiet = float(np.quantile(model.variance, _QUIET))
    variance = model.variance[span.frames]
    trust = np.ones(rotations.shape[:2], rotations.dtype) if confidence is None else confidence
    sure = np.minimum(quiet / variance, 1).astype(trust.dtype)
    first = np.ascontiguousarray(kalman(rotations, confidence=trust * sure[:, None]))
    share = np.minimum(np.sqrt(_OUTLYING * quiet / variance), 1)
    calm = ops().drawn_towards(rotations, first, share)
    left = np.minimum(variance, _OUTLYING * quiet)
    mean = float(left.mean())
    weights = np.clip(mean / left, _LEAST_CONFIDENCE, 1).astype(trust.dtype)
    steady = model.white[span.joints]
    at_one = np.divide(model.quiet[span.joints], steady, out=np.ones_like(steady), where=steady > 0)
    return calm, np.ascontiguousarray(trust * weights[:, None]), noise * at_one * math.sqrt(mean)


__all__ = ["White", "assumed_level", "learned_share", "whitened"]
