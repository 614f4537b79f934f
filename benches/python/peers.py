"""How one filters rotations with other packages: as columns of rotation vectors."""

from collections.abc import Callable

import numpy as np
from clips import Array
from numpy.typing import NDArray
from scipy import signal
from scipy.ndimage import gaussian_filter1d
from scipy.spatial.transform import Rotation

Filter = Callable[[Array], Array]
"""From columns along time to columns."""

SIGMA = 3.0
"""Frames."""

CUTOFF, FPS = 6.0, 120.0
"""Hertz."""

WINDOW, DEGREE = 11, 3

SCIPY: dict[str, Filter] = {
    "gaussian": lambda x: gaussian_filter1d(x, SIGMA, axis=0, mode="mirror"),
    "butterworth": lambda x: signal.sosfiltfilt(signal.butter(4, CUTOFF, fs=FPS, output="sos"), x, axis=0),
    "savgol": lambda x: signal.savgol_filter(x, WINDOW, DEGREE, axis=0),
}
"""SciPy's filters, along the first axis."""


def on_rotation_vectors(q: Array, filtered: Filter) -> Array:
    """Filter the rotation vectors of quaternions `(frames, joints, 4)` with SciPy, there and back."""
    flat = Rotation.from_quat(q.reshape(-1, 4), scalar_first=True).as_rotvec()
    columns = filtered(flat.reshape(len(q), -1))
    return Rotation.from_rotvec(columns.reshape(-1, 3)).as_quat(scalar_first=True).reshape(q.shape)


def kalman_smoother(
    z: NDArray[np.float64], process_noise: float, measurement_noise: float
) -> NDArray[np.float64]:
    """Smooth a column of angles at constant velocity with filterpy, forth and back, from rest at its first value."""
    from filterpy.kalman import KalmanFilter

    kalman = KalmanFilter(dim_x=2, dim_z=1)
    kalman.F = np.array([[1.0, 1], [0, 1]])
    kalman.H = np.array([[1.0, 0]])
    kalman.Q = process_noise**2 * np.array([[1 / 3, 1 / 2], [1 / 2, 1]])
    kalman.R = np.array([[measurement_noise**2]])
    kalman.x = np.array([[z[0]], [0.0]])
    kalman.P = np.diag([measurement_noise**2, np.pi**2])
    means, covariances, _, _ = kalman.batch_filter(z[1:])
    smooth, _, _, _ = kalman.rts_smoother(means, covariances)
    return np.asarray(smooth)[:, 0, 0]
