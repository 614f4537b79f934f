"""Groups of similar patches: the non-local step of automatic smoothing.

What a clip does once more, with other noise, says more about a movement than its neighbours in time do. M. Lebrun, A. Buades and
J.-M. Morel, *A Nonlocal Bayesian Image Denoising Algorithm*, SIAM Journal on Imaging Sciences 6(3), 2013: for each patch of a
first estimate, the *pilot*, the patches most like it are gathered; they are taken as drawn from one normal distribution, and with
its mean and covariance those of them that are near in time are estimated from the noisy ones.
"""

import numpy as np

from quatfilt._reference._arrays import Reals
from quatfilt._reference.filters.development import developed_about
from quatfilt._reference.filters.nonlocal_pose_means.nonlocal_pose_means import in_hemisphere_of
from quatfilt._reference.rotations.quaternion import exp, multiply, normalize

LENGTH = 24
"""Frames of a patch."""

COEFFICIENTS = 8
"""Cosine coefficients of a patch that are estimated, from the lowest on; what the others hold is the pilot's."""

COMPANIONS = 2
"""Joints of a group: each joint, and the one that moves most like it."""

STEP = 24
"""Frames from one model, a mean and a covariance of patches, to the next."""

NEAR = 21
"""Frames about the patch of a model within which patches are estimated with it, if they are among those most like it. So each frame
is estimated with several models, whose errors differ."""

APART = 3
"""Frames from one patch that is estimated with a model to the next."""

RADIUS = 256
"""Frames within which similar patches are looked for, before and after."""

NEIGHBORS = 80
"""How many of the most similar patches count."""

SHORTEST = LENGTH + NEIGHBORS - 1
"""Frames of a clip that holds so many patches. In shorter ones the covariance has too few of them: the pilot stays."""

SHARE = 0.75
"""Of the covariance of the pilot's patches, how much counts: they differ by what noise the pilot still has, too."""

LEAST_NOISE = 1e-6
"""Radians per component below which a joint has no noise: little more than roundings in float32."""

LEAST_VARIANCE = 1e-13
"""Of the total variance of the patches, how much the noise has at least: some hundred roundings of float64."""

SAME = 1e-9
"""Differences of similarity below which two joints are equally alike."""


def smooth_patches(q: Reals, pilot: Reals, confidence: Reals | None, noise: Reals, rounds: int) -> Reals:
    """Improve an estimate of the clean rotations by groups of its similar patches.

    Parameters
    ----------
    q : array (frames, joints, 4)
        Noisy rotations without missing samples.
    pilot : array (frames, joints, 4)
        The estimate.
    confidence : array (frames, joints) or None
        From 0 to 1: how much of the way from the pilot to a sample counts.
    noise : array (joints,), float64, radians
        Deviation of the noise per component of the rotation vector. Joints with less than `LEAST_NOISE` stay as the
        pilot has them.
    rounds : int
        How often the step is made, each time with the result before as pilot.

    Returns
    -------
    array (frames, joints, 4)
        Unit quaternions, continuous in sign from the hemisphere of the first frame of `q`.
    """
    if q.size == 0:
        return q.copy()
    path = normalize(q.astype(np.float64))
    trust = np.ones(q.shape[:2]) if confidence is None else confidence.astype(np.float64)
    noisy = noise >= LEAST_NOISE
    result = in_hemisphere_of(normalize(pilot), q).astype(q.dtype)
    for _ in range(rounds if len(q) >= SHORTEST and noisy.any() else 0):
        moved = normalize(result.astype(np.float64))
        moved[:, noisy] = improved(moved[:, noisy], path[:, noisy], trust[:, noisy], noise[noisy])
        result = in_hemisphere_of(moved, q).astype(q.dtype)
    return result


def improved(pilot: Reals, path: Reals, trust: Reals, noise: Reals) -> Reals:
    """Make one step, with joints that all have noise.

    About the pilot, its development and the way from there to the samples are vectors; divided by the joint's noise, `P` and `X`,
    they have noise of variance 1.
    """
    pilot, development, vectors = developed_about(pilot, path)
    scale = noise[:, None]
    clean = development / scale
    rest = trust[..., None] * (vectors - development) / scale
    return normalize(multiply(pilot, exp(moves(clean, rest) * scale / 2)))


def moves(clean: Reals, rest: Reals) -> Reals:
    """Return how far the estimate lies from the pilot: the mean of what all patches that hold a sample say.

    Parameters
    ----------
    clean : array (frames, joints, 3)
        `P`.
    rest : array (frames, joints, 3)
        `X`.
    """
    frames, joints = clean.shape[:2]
    last = frames - LENGTH
    centres = sorted({*range(0, last, STEP), last})
    total = np.zeros_like(clean)
    count = np.zeros((frames, joints, 1))
    for group in groups(clean):
        pilots, rests = patches(clean[:, group]), patches(rest[:, group])
        for centre in centres:
            alike = nearest(pilots, centre)
            lags = alike - centre
            near = alike[(abs(lags) <= NEAR) & (lags % APART == 0)]
            estimates = wiener(pilots[alike], pilots[near], rests[near])
            for start, move in zip(near, estimates.reshape(-1, COEFFICIENTS, len(group), 3), strict=True):
                total[start : start + LENGTH, group] += np.einsum("kl,kjc->ljc", basis(), move)
                count[start : start + LENGTH, group] += 1
    return total / count


def groups(clean: Reals) -> list[list[int]]:
    """Return for each joint itself and the others that move most like it.

    With the steps `v` from frame to frame and `M_ij = Σ_t v_i v_jᵀ`, the similarity of two joints is
    `‖M_ij‖ / √(‖M_ii‖ ‖M_jj‖)`, Frobenius norms: whatever frames of reference they turn in. Among equals the first joint is
    taken.
    """
    steps = np.diff(clean, axis=0)
    joints = steps.shape[1]
    shared = np.linalg.norm(np.einsum("tia,tjb->ijab", steps, steps), axis=(2, 3))
    own = np.sqrt(np.outer(np.diag(shared), np.diag(shared)))
    similarity = np.divide(shared, own, out=np.zeros_like(shared), where=own > 0)
    result = []
    for joint in range(joints):
        group = [joint]
        while len(group) < min(COMPANIONS, joints):
            others = [i for i in range(joints) if i not in group]
            best = similarity[joint, others].max()
            group.append(next(i for i in others if similarity[joint, i] >= best - SAME))
        result.append(group)
    return result


def basis() -> Reals:
    """Cosines `(COEFFICIENTS, LENGTH)` of length 1, from the lowest frequency on."""
    order = np.arange(COEFFICIENTS)[:, None]
    cosines = np.cos(np.pi * order * (2 * np.arange(LENGTH) + 1) / (2 * LENGTH))
    return np.asarray(np.where(order == 0, np.sqrt(1 / LENGTH), np.sqrt(2 / LENGTH)) * cosines)


def patches(vectors: Reals) -> Reals:
    """Cosine coefficients of all patches, one row for each first frame; `(frames − LENGTH + 1, numbers)`."""
    windows = np.lib.stride_tricks.sliding_window_view(vectors, LENGTH, axis=0)
    return np.asarray(np.einsum("kl,tjcl->tkjc", basis(), windows).reshape(len(windows), -1))


def nearest(pilots: Reals, start: int) -> Reals:
    """Return the first frames of the patches most like that at `start`, itself among them, the most similar first.

    Among equals those nearer in time come first, then the earlier one.
    """
    first = max(start - RADIUS, 0)
    lags = np.arange(first, min(start + RADIUS + 1, len(pilots))) - start
    distances = np.sum((pilots[start + lags] - pilots[start]) ** 2, axis=1)
    order = np.lexsort((lags, np.abs(lags), distances))
    return np.asarray(start + lags[order[:NEIGHBORS]])


def wiener(alike: Reals, pilots: Reals, rests: Reals) -> Reals:
    """Estimate clean patches, as their differences from the pilot's, `(n, numbers)`.

    If patches are normal with the mean `μ` and the covariance `C`, and noise of variance 1 is added, the best estimate from a
    noisy one, `y = p + x`, is

        `f = μ + C (C + I)⁻¹ (y − μ)`,    hence    `f − p = x − (C + I)⁻¹ (y − μ)`.

    Parameters
    ----------
    alike : array (k, numbers)
        Patches of the pilot.
    pilots : array (n, numbers)
        `p` of each.
    rests : array (n, numbers)
        `x` of each.
    """
    mean = alike.mean(axis=0)
    around = alike - mean
    covariance = SHARE * around.T @ around / len(alike)
    variance = 1 + LEAST_VARIANCE * np.trace(covariance)
    surprises = (pilots + rests - mean).T
    noise = variance * np.linalg.solve(covariance + variance * np.eye(len(mean)), surprises)
    return np.asarray(rests - noise.T)
