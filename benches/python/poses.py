"""Whole poses: principal geodesics of the body, beside tangent principal component analysis."""

import agreement
import numpy as np
import quatfilt as qf
from clips import JOINTS, Array, rotations
from report import Results
from timing import Contender, ours, race, reference

FRAMES = 10_000
REFERENCE_FRAMES = 1_000
COMPONENTS = 5

MOST_SECONDS = 2.0
"""What the issue of principal geodesic analysis asks of a fit with all threads."""


def run(repetitions: int) -> Results:
    """Measure."""
    results = Results()
    q = rotations(FRAMES)
    part = q[:REFERENCE_FRAMES].copy()
    slow = reference(lambda: _fitted(part), scale=FRAMES / REFERENCE_FRAMES)
    agreement.numbers("body: reference", _fitted(part), slow.call())
    own = ours(lambda: _fitted(q))
    table = results.table(
        f"{COMPONENTS} principal geodesics of whole poses, {JOINTS} joints × {FRAMES:,} frames, {q.dtype}",
        race([*own, slow, Contender("tangent PCA: numpy.linalg.svd", lambda: _tangent(q))], repetitions),
        rotations=FRAMES * JOINTS,
        beside=[contender.name for contender in own],
        notes=[
            (
                "Tangent PCA is something else, and less: all axes at once, of the logarithms at the same means. "
                f"* on {REFERENCE_FRAMES:,} frames, multiplied."
            )
        ],
    )
    best = own[-1].name
    results.aim(f"Principal geodesics of poses, seconds, {best}", table.median(best), at_most=MOST_SECONDS)
    return results


def _fitted(q: Array) -> Array:
    return qf.PrincipalGeodesicAnalysis(COMPONENTS, body=True).fit(q).residuals_


def _tangent(q: Array) -> Array:
    """Principal axes of the logarithms at the means."""
    seen = qf.multiply(qf.conjugate(np.broadcast_to(qf.mean(q), q.shape)), q)
    vectors = qf.log(seen * np.copysign(1, seen[..., :1]).astype(q.dtype))
    axes: Array = np.linalg.svd(vectors.reshape(len(q), -1), full_matrices=False)[2][:COMPONENTS]
    return axes
