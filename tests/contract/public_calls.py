"""One call of every public function that computes, for tests that ask all of them the same question."""

import numpy as np
import quatfilt as qf

NOT_KERNELS = {
    "get_backend": "asks who computes",
    "get_num_threads": "asks for the number of threads",
    "set_num_threads": "sets the number of threads",
    "simd_level": "asks for the vector instructions",
    "use_backend": "chooses who computes",
}
"""Public names that no array goes through, and why."""

FRAMES = 12_007
"""With three joints more than two tasks, and no multiple of a vector."""


def samples(dtype):
    """Return unit quaternions, others, vectors: ``(frames, 3, 4)`` twice and ``(frames, 3, 3)``."""
    rng = np.random.default_rng(20)
    a = rng.standard_normal((FRAMES, 3, 4))
    b = rng.standard_normal((FRAMES, 3, 4))
    v = rng.standard_normal((FRAMES, 3, 3)) * np.exp(rng.uniform(-20, 2, (FRAMES, 3, 1)))
    a /= np.linalg.norm(a, axis=-1, keepdims=True)
    b /= np.linalg.norm(b, axis=-1, keepdims=True)
    b[::7] = a[::7]
    return a.astype(dtype), b.astype(dtype), v.astype(dtype)


CALLS = {
    "conjugate": lambda a, _b, _v: qf.conjugate(a),
    "exp": lambda _a, _b, v: qf.exp(v),
    "geodesic_distance": lambda a, b, _v: qf.geodesic_distance(a, b),
    "log": lambda a, _b, _v: qf.log(a),
    "multiply": lambda a, b, _v: qf.multiply(a, b),
    "normalize": lambda a, _b, _v: qf.normalize(2 * a),
}
"""From the name to a call with what `samples` returns."""
