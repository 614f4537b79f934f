"""Rotations as vectors about a reference path: what filters for numbers can be applied to.

Of a noisy path `q_t` a smooth one `r_t` is made, an average in R⁴, and rolled out: the *development* adds up the turns
from frame to frame,

    `R_0 = 0`,    `R_{t+1} = R_t + 2 log(r_t⁻¹ r_{t+1})`,

and each sample becomes a vector beside it, `y_t = R_t + 2 log(r_t⁻¹ q_t)`, all in radians of rotation and in the frame of the
body. A linear filter `F` for numbers that keeps constants, applied to the columns of `y`, gives rotations back:

    `r_t · exp((F(y)_t − R_t) / 2)`.

The body's frame turns, and with it the vectors of later frames. Filters add vectors of many frames, so :func:`filtered` carries
the frame along by parallel transport, which turns it half as far as the body,

    `h_0 = 1`,    `h_{t+1} = h_t · (r_t⁻¹ r_{t+1})^½`,

and has `h ω h⁻¹` for each vector `ω` above. Then the filter of small rotations is the filter of rotation vectors, up to products
of three angles; and the filter of the inverse is the inverse of the filter's.

With `r = q` and `h = 1` this is Lee and Shin's construction. There the commutators of the noise add up from frame to frame; about a
smooth path they do not. Nothing has to stay within one chart, so joints may turn as far as they like; and about one fixed
axis `y` are the unrolled angles.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from quatfilt._reference._arrays import Reals
from quatfilt._reference.filters.columns import gaussian_mask, weighted_mean
from quatfilt._reference.filters.nonlocal_pose_means.nonlocal_pose_means import in_hemisphere_of
from quatfilt._reference.filters.spin import FAST, mean_turns, rolled
from quatfilt._reference.motion.skeleton import rotate
from quatfilt._reference.noise.coherence import coherence
from quatfilt._reference.rotations.quaternion import (
    between,
    conjugate,
    exp,
    log_short,
    multiply,
    norm,
    normalize,
)

SHORTEST_MEAN = 0.1
"""Length of an average of unit quaternions below which its direction is chance: the frames turn right round within the
mask."""

LONG_MEAN = 0.75
"""Length of an average of unit quaternions below which the joint may be spinning. At 1.5 rad within a deviation of the mask it
is `exp(−1.5²/8)`; noise alone leaves as little from 0.9 rad per component of the rotation vector on."""

LEAST_CLARITY = 1 / 16
"""Where noise leaves less, the reference path takes no more frames for it."""

CLEAR = 0.8
"""Clarity from which the sign of the first sample is to be relied on."""


def clarity(noise: Reals) -> Reals:
    """Return what noise leaves of the squared length of a mean of rotations, at least `LEAST_CLARITY`; `(joints,)`.

    So many times as many frames make a reference path that is as clear as without noise.
    """
    return np.maximum(coherence(noise) ** 2, LEAST_CLARITY)


def develop(q: Reals, confidence: Reals | None, reference_sigma: Reals) -> tuple[Reals, Reals, Reals]:
    """Roll rotations out about their reference path.

    Parameters
    ----------
    q : array (frames, joints, 4)
        Rotations without missing samples.
    confidence : array (frames, joints) or None
        Weights of the samples in the reference path, from 0 to 1.
    reference_sigma : array (joints,), frames
        Deviation of the Gaussian mask that makes the reference path.

    Returns
    -------
    reference : array (frames, joints, 4), float64
        The path `r` of unit quaternions.
    development : array (frames, joints, 3), float64, radians
        `R`.
    vectors : array (frames, joints, 3), float64, radians
        `y`.
    """
    path = aligned(normalize(q.astype(np.float64)), confidence, np.ones(q.shape[1]))
    return developed_about(reference_path_of_spins(path, confidence, reference_sigma), path)


def developed_about(reference: Reals, path: Reals) -> tuple[Reals, Reals, Reals]:
    """Roll a path out about another one, both `(frames, joints, 4)`; what is returned is that of `develop`."""
    turns = 2 * log_short(between(reference[:-1], reference[1:]))
    development = np.zeros((*reference.shape[:2], 3))
    development[1:] = np.cumsum(turns, axis=0)
    return reference, development, development + 2 * log_short(between(reference, path))


def carried_about(reference: Reals, path: Reals) -> tuple[Reals, Reals, Reals]:
    """Roll a path out about another one in the frame that is carried along, both `(frames, joints, 4)`.

    Returns
    -------
    frame : array (frames, joints, 4)
        `h`: from the frame of the body to the one that is carried.
    development, vectors : array (frames, joints, 3), radians
        `R` and `y`.
    """
    turns = 2 * log_short(between(reference[:-1], reference[1:]))
    frame = np.zeros(reference.shape)
    frame[:, :, 0] = 1
    for t in range(1, len(reference)):
        frame[t] = normalize(multiply(frame[t - 1], exp(turns[t - 1] / 4)))
    development = np.zeros((*reference.shape[:2], 3))
    development[1:] = np.cumsum(rotate(frame[:-1], turns), axis=0)
    way = 2 * log_short(between(reference, path))
    return frame, development, development + rotate(frame, way)


def undevelop(q: Reals, reference: Reals, development: Reals, vectors: Reals) -> Reals:
    """Turn vectors back into rotations: `r_t · exp((y_t − R_t) / 2)`.

    Parameters
    ----------
    q : array (frames, joints, 4)
        The rotations that were developed; they say the dtype, and on which hemisphere the result begins.
    reference : array (frames, joints, 4), float64
    development : array (frames, joints, 3), float64, radians
    vectors : array (frames, joints, 3), float64, radians

    Returns
    -------
    array (frames, joints, 4)
        Unit quaternions, continuous in sign from the hemisphere of the first frame of `q`.
    """
    if len(q) == 0:
        return q.copy()
    moved = normalize(multiply(reference, exp((vectors - development) / 2)))
    return in_hemisphere_of(moved, q).astype(q.dtype)


def aligned(path: Reals, confidence: Reals | None, clear: Reals) -> Reals:
    """Choose the signs of unit quaternions so that they can be averaged.

    Each takes the hemisphere of a running mean of those before it, to which it then adds half of itself, the less the less
    it is trusted and the less noise leaves `clear`. Beside the sample before alone, noise would turn the sign of the rest of the
    path too often. Joints in heavy noise go back to the first frame in the same way: it is not the one to begin with.
    """
    result = path.copy()
    if len(path) == 0:
        return result
    share = np.full(path.shape[:2], 0.5) if confidence is None else confidence.astype(np.float64) / 2
    share = share * clear
    mean = path[0].copy()

    def take(t: int, joints: NDArray[np.bool_] | slice) -> None:
        result[t, joints] *= np.where(np.sum(mean[joints] * result[t, joints], axis=-1) < 0, -1, 1)[:, None]
        mean[joints] += share[t, joints, None] * (result[t, joints] - mean[joints])

    for t in range(1, len(path)):
        take(t, slice(None))
    if (clear < CLEAR).any():
        for t in range(len(path) - 1, -1, -1):
            take(t, clear < CLEAR)
    return result


def reference_path(path: Reals, confidence: Reals | None, sigma: Reals) -> Reals:
    """Average aligned quaternions under a Gaussian mask, and make them unit again.

    Where the average is shorter than `SHORTEST_MEAN` the sample itself stands.
    """
    result = path.copy()
    for joint in range(path.shape[1] if len(path) > 1 else 0):
        result[:, joint], _ = mean_path(
            path[:, joint], trust_of(joint, confidence), gaussian_mask(sigma[joint])
        )
    return result


def reference_path_of_spins(path: Reals, confidence: Reals | None, sigma: Reals) -> Reals:
    """Make the reference path of :func:`reference_path`, for joints that may turn fast within the mask.

    Where an average is shorter than `LONG_MEAN`, and the joint turns steadily by more than `FAST` within a deviation of the mask,
    the path is seen from a frame that turns along: there it is slow, and its signs and its averages are those of slow motion.
    See :mod:`.spin`.
    """
    result = path.copy()
    for joint in range(path.shape[1] if len(path) > 1 else 0):
        own, trust, mask = path[:, joint], trust_of(joint, confidence), gaussian_mask(sigma[joint])
        result[:, joint], length = mean_path(own, trust, mask)
        if length.min() >= LONG_MEAN:
            continue
        of_world, of_body = mean_turns(own, trust, mask)
        if max(norm(of_world).max(), norm(of_body).max()) * sigma[joint] <= FAST:
            continue
        left, right = conjugate(rolled(-of_world)), rolled(of_body)
        slow = normalize(multiply(multiply(conjugate(left), own), conjugate(right)))
        weights = None if trust is None else trust[:, None]
        slow = aligned(slow[:, None], weights, np.ones(1))[:, 0]
        result[:, joint] = multiply(multiply(left, mean_path(slow, trust, mask)[0]), right)
    return result


def trust_of(joint: int, confidence: Reals | None) -> Reals | None:
    """Return the confidence of a joint's samples, `(frames,)`."""
    return None if confidence is None else confidence[:, joint].astype(np.float64)


def mean_path(path: Reals, trust: Reals | None, mask: Reals) -> tuple[Reals, Reals]:
    """Average the aligned quaternions `(frames, 4)` of a joint; return the path and how long the averages were."""
    mean = weighted_mean(path, trust, mask, "mirror")
    length = norm(mean)
    clear = length >= SHORTEST_MEAN
    result = path.copy()
    result[clear] = mean[clear] / length[clear, None]
    return result, length


@dataclass(frozen=True)
class Columns:
    """What a filter for numbers is applied to: the vectors of one joint, or a translation."""

    vectors: Reals
    """`(frames, 3)`."""
    mean: Reals
    """Their local mean, `(frames, 3)`: the development of the reference path."""
    trust: Reals | None
    """The samples' confidence, `(frames,)`."""

    def pulled(self) -> Reals:
        """Return the vectors, pulled towards their local mean by as much as they are not trusted."""
        if self.trust is None:
            return self.vectors
        return self.mean + self.trust[:, None] * (self.vectors - self.mean)


def filtered(
    q: Reals,
    translation: Reals | None,
    confidence: Reals | None,
    reference_sigma: Reals,
    smooth: Callable[[Columns, int], Reals],
) -> tuple[Reals, Reals | None]:
    """Apply a filter for numbers to rotations, and to a translation as it applies to joint 0.

    Parameters
    ----------
    q : array (frames, joints, 4)
        Rotations without missing samples.
    translation : array (frames, 3) or None
        Positions of the root.
    confidence : array (frames, joints) or None
        From 0 to 1; that of joint 0 is the translation's too.
    reference_sigma : array (joints,), frames
        Deviation of the Gaussian mask that makes the reference path.
    smooth : function
        The filter: from the columns of a joint, and the joint, to `(frames, 3)`.

    Returns
    -------
    rotations : array (frames, joints, 4)
        Unit quaternions, continuous in sign from the hemisphere of the input's first frame.
    translation : array (frames, 3) or None
    """
    frames, joints = q.shape[:2]
    if frames < 2 or joints == 0:
        return normalize(q), None if translation is None else translation.copy()
    trust = None if confidence is None else confidence.astype(np.float64)
    path = aligned(normalize(q.astype(np.float64)), confidence, np.ones(joints))
    reference = reference_path_of_spins(path, confidence, reference_sigma)
    frame, development, vectors = carried_about(reference, path)
    moved = np.empty_like(vectors)
    for joint in range(joints):
        own = None if trust is None else trust[:, joint]
        moved[:, joint] = smooth(Columns(vectors[:, joint], development[:, joint], own), joint)
    beside = rotate(conjugate(frame), moved - development)
    rotations = undevelop(q, reference, np.zeros_like(beside), beside)
    if translation is None:
        return rotations, None
    positions = translation.astype(np.float64)
    own = None if trust is None else trust[:, 0]
    mean = weighted_mean(positions, own, gaussian_mask(reference_sigma[0]), "mirror")
    return rotations, smooth(Columns(positions, mean, own), 0).astype(translation.dtype)
