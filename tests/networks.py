"""Networks of gains with drawn weights."""

import numpy as np

GATES, BASES = 101, 19


def drawn(seed, units=16, size=0.3):
    """Three layers that give gains of about `size`."""
    rng = np.random.default_rng(seed)
    shapes = [(GATES + 1, units), (units + 1, units), (units + 1, BASES)]
    scales = [1 / np.sqrt(GATES), 1 / np.sqrt(units), size / np.sqrt(units)]
    return [
        (s * rng.standard_normal(shape)).astype(np.float32) for shape, s in zip(shapes, scales, strict=True)
    ]


def constant(gains):
    """Three layers that give the same gains everywhere."""
    first, second, last = (
        np.zeros((rows, columns), np.float32) for rows, columns in ((GATES + 1, 4), (5, 4), (5, BASES))
    )
    last[-1] = gains
    return [first, second, last]
