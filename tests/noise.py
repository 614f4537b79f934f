"""The noise level of what is no clip of rotations."""

import numpy as np


def of_path(backend, path):
    """Return the level of a path ``(frames, 3)``."""
    return float(backend.noise_level(np.ascontiguousarray(path)[:, None])[0])
