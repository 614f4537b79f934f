"""What control points tell a local model: how far its examples are from them, and where their roots stand when laid on them."""

import numpy as np
from numpy.typing import NDArray

from quatfilt._reference.reconstruction.examples import Observations, Poses, State, fit, root_steps
from quatfilt._reference.reconstruction.frame import HORIZONTAL
from quatfilt._reference.reconstruction.kinematics import Floats


def signals(
    poses: Poses, examples: NDArray[np.intp], state: State, observations: Observations, up: int, scale: float
) -> tuple[Floats, Floats]:
    """Lay examples on the control points (`fit`), and tell what is left between them and how the roots come there.

    What is left is seen from the last heading, in units of `scale`, and so weighted that its sum of squares is `m` times what the control
    points add to the squared distance of the example (`nearest`).

    Where the points lie less than `scale` from their middle as seen from above, root mean square, they do not tell a heading, and
    roots come as they came in the database (`root_steps`), from the last pose on. With an infinite scale, or where nothing is seen, that
    is all there is.

    Parameters
    ----------
    poses : Poses
        The database.
    examples : array (K,) of intp
        The examples' next poses.
    state : State
        The last poses.
    observations : Observations
        The control points.
    up : int
        The up axis.
    scale : float
        Distance of control points that counts as much as a radian between poses.

    Returns
    -------
    differences : array (K, S)
        Three numbers of each control point of each frame that is seen.
    ways : array (K, 4)
        Step along two axes of the last heading, height, turn.
    """
    weights = observations.weights.reshape(-1)
    if weights.sum() == 0 or not np.isfinite(scale):
        return np.zeros((len(examples), 0)), root_steps(poses, examples, up)
    first, second = HORIZONTAL[up]
    marks = weights > 0
    share = weights[marks] / weights.sum()
    seen = observations.positions.reshape(-1, 3)[marks]
    points = poses.trajectories[examples[:, None] - observations.lags].astype(np.float64)
    points = points.reshape(len(examples), -1, 3)[:, marks]
    c = seen[:, first] + 1j * seen[:, second]

    found = fit(poses, examples, observations, up)
    turns, shifts = np.exp(1j * found.turn), found.shift[:, 0] + 1j * found.shift[:, 1]
    back = np.exp(-1j * state.heading)
    level = (turns[:, None] * (points[..., first] + 1j * points[..., second]) + shifts[:, None] - c) * back
    left = np.stack([level.real, level.imag, points[..., up] - seen[:, up]], axis=2)
    differences = (np.sqrt(len(state.recent) * share) / scale)[:, None] * left
    differences = differences.reshape(len(examples), -1)
    if np.sum(share * np.abs(c - c @ share) ** 2) <= scale**2:
        return differences, root_steps(poses, examples, up)

    here = poses.translation[examples].astype(np.float64)
    root = turns * (here[:, first] + 1j * here[:, second]) + shifts
    step = (root - (state.place[first] + 1j * state.place[second])) * back
    turn = poses.heading[examples].astype(np.float64) + found.turn - state.heading
    turn -= 2 * np.pi * np.round(turn / (2 * np.pi))
    return differences, np.stack([step.real, step.imag, here[:, up], turn], axis=1)
