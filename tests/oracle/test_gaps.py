"""Gaps along spherical cubics beside Shoemake's construction with SciPy's rotations and interpolation."""

import clips
import numpy as np
import tolerances
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation, Slerp


def slerp(a, b, part):
    return Slerp([0, 1], Rotation.concatenate([a, b]))(part)


def control_point(before, key, after):
    """Shoemake's inner quadrangle point: ``q exp(−(log(q⁻¹ after) + log(q⁻¹ before)) / 4)``."""
    return key * Rotation.from_rotvec(
        -((key.inv() * after).as_rotvec() + (key.inv() * before).as_rotvec()) / 4
    )


@given(seed=st.integers(0, 2**32 - 1), spacing=st.integers(2, 5))
def test_squad_between_keys_at_equal_distances(backend, seed, spacing):
    rng = np.random.default_rng(seed)
    keys = clips.smooth(rng, 8, 1, swing=0.4)[:, 0]
    q = np.full((7 * spacing + 1, 1, 4), np.nan)
    q[::spacing, 0] = keys
    result, _ = backend.fill_gaps(q, -1, "squad")
    path = Rotation.from_quat(keys, scalar_first=True)
    for i in range(1, 6):
        before, a, b, after = (path[j] for j in range(i - 1, i + 3))
        inner = control_point(before, a, b), control_point(a, b, after)
        for step in range(1, spacing):
            part = step / spacing
            expected = slerp(slerp(a, b, part), slerp(*inner, part), 2 * part * (1 - part))
            filled = Rotation.from_quat(result[i * spacing + step, 0], scalar_first=True)
            assert (filled.inv() * expected).magnitude() < tolerances.FLOAT64
