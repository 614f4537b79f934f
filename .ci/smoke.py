"""Tries an installed quatfilt on a small array; the argument is the checkout, which must not be what is imported."""

import sys
from pathlib import Path

import numpy as np
import quatfilt as qf

checkout = Path(sys.argv[1]).resolve()
if checkout in Path(qf.__file__).resolve().parents:
    sys.exit(f"smoke: imported {qf.__file__} from the checkout")

turns = np.linspace(0.0, 1.0, 200)[:, None] * np.array([0.3, -0.2, 0.1])
rotations = qf.exp(turns)[:, None, :]
error = float(np.abs(qf.log(rotations)[:, 0] - turns).max())
if not error < 1e-15:
    sys.exit(f"smoke: log(exp(v)) differs from v by {error}")
if hasattr(qf, "nonlocal_pose_means"):
    rng = np.random.default_rng(1)
    noisy = qf.multiply(rotations, qf.exp(0.02 * rng.standard_normal((200, 1, 3))))
    before = float(np.square(qf.geodesic_distance(rotations, noisy)).mean())
    after = float(np.square(qf.geodesic_distance(rotations, qf.nonlocal_pose_means(noisy))).mean())
    if not after < 0.5 * before:
        sys.exit(f"smoke: the filter left {after / before:.0%} of the noise")
sys.stdout.write(f"quatfilt at level {qf.simd_level()} with {qf.get_num_threads()} threads\n")
