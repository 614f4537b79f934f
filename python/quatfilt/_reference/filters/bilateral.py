"""The bilateral orientation filter: neighbours in time count the more, the nearer their rotations are.

N. Courty, *Bilateral Human Motion Filtering*, EUSIPCO 2008.
"""

from typing import Literal

import numpy as np

from quatfilt._reference._arrays import Reals
from quatfilt._reference.filters.boundary import Boundary, extend_rotations, extend_vectors
from quatfilt._reference.filters.nonlocal_pose_means.nonlocal_pose_means import in_hemisphere_of
from quatfilt._reference.filters.orientation_filter import coefficients, increments_around
from quatfilt._reference.rotations.quaternion import exp, geodesic_distance, multiply, normalize

Kernel = Literal["gaussian", "printed", "classic"]


def bilateral(
    q: Reals,
    translation: Reals | None,
    radius: int,
    sigma_time: float,
    sigma_angle: Reals,
    kernel: Kernel,
    iterations: int,
    boundary: Boundary,
    lookahead: int,
) -> tuple[Reals, Reals | None]:
    """Filter orientations with a mask of their own for each frame and joint.

    The mask is `m_r = W(r) / Σ W` over `r = −radius … min(radius, lookahead)`, with the weights `W` of :func:`weights`, and it is applied
    as :func:`.orientation_filter.orientation_filter` applies it.

    Parameters
    ----------
    q : array (frames, joints, 4)
        Rotations without missing samples.
    translation : array (frames, 3) or None
        Positions of the root, averaged in each pass with the weights of joint 0.
    radius : int, frames
        The window is `t − radius … t + radius`.
    sigma_time : float, frames
        Scale of the distances in time.
    sigma_angle : array (joints,), radians of rotation
        Scale of the distances between rotations; infinite: they do not matter.
    kernel : "gaussian", "printed" or "classic"
        The shape of the weights.
    iterations : int
        How often the filter is applied, each time with weights of the result before.
    boundary : "mirror", "linear" or "nearest"
        How the clip goes on beyond its ends, anew for each pass; see :mod:`.boundary`.
    lookahead : int, frames
        How many later frames have a weight, in each pass; −1: as many as earlier ones.

    Returns
    -------
    rotations : array (frames, joints, 4)
        Unit quaternions, continuous in sign from the hemisphere of the input's first frame.
    translation : array (frames, 3) or None
    """
    frames, joints = q.shape[:2]
    if frames < 2 or joints == 0:
        return normalize(q), None if translation is None else translation.copy()
    result = normalize(q.astype(np.float64))
    moved = None if translation is None else translation.astype(np.float64)
    for _ in range(iterations):
        mask = weights(result, radius, sigma_time, sigma_angle, kernel, boundary)
        if lookahead >= 0:
            mask[..., radius + lookahead + 1 :] = 0
        if moved is not None:
            share = mask[:, 0] / mask[:, 0].sum(axis=-1, keepdims=True)
            around = extend_vectors(moved, radius, boundary)
            moved = np.zeros((frames, 3))
            for j in range(2 * radius + 1):
                moved += share[:, j, None] * around[j : j + frames]
        increments = increments_around(result, radius, boundary)
        b = coefficients(mask)
        turn = np.zeros((frames, joints, 3))
        for r in range(2 * radius):
            turn += b[..., r, None] * increments[r : r + frames]
        result = normalize(multiply(result, exp(turn)))
    rotations = in_hemisphere_of(result, q).astype(q.dtype)
    return rotations, None if translation is None or moved is None else moved.astype(translation.dtype)


def weights(
    q: Reals, radius: int, sigma_time: float, sigma_angle: Reals, kernel: Kernel, boundary: Boundary
) -> Reals:
    """Weights of the frames `t − radius … t + radius` for each frame and joint, `(frames, joints, 2·radius + 1)`.

    With the rotation angle `θ` from frame `t` to frame `t + r`, the weight is the product of

    - `"gaussian"`: `exp(−|r| / 2σ_t²)` and `exp(−θ² / 2σ_a²)`;
    - `"classic"`: `exp(−r² / 2σ_t²)` and `exp(−θ² / 2σ_a²)`;
    - `"printed"`: `exp(−|r| / 2σ_t²)` and `exp(−d / 2σ_g²)` with the paper's distance `d = θ/2` on S³, not squared, and
      `σ_g = σ_a/2`.
    """
    frames = len(q)
    path = extend_rotations(q, radius, boundary)
    result = np.empty((*q.shape[:2], 2 * radius + 1))
    with np.errstate(over="ignore", divide="ignore"):
        for j in range(2 * radius + 1):
            r = np.float64(abs(j - radius))
            time = (r / sigma_time) ** 2 / 2 if kernel == "classic" else r / sigma_time / sigma_time / 2
            theta = geodesic_distance(q, path[j : j + frames]) if r else np.zeros(q.shape[:2])
            scaled = theta / sigma_angle
            angle = scaled / sigma_angle if kernel == "printed" else scaled**2 / 2
            result[..., j] = np.exp(-(time + angle))
    return result
