"""Noise: its level, estimated from a clip."""

import agreement
import numpy as np
import quatfilt as qf
from clips import JOINTS, rotations
from report import Results
from timing import Contender, ours, race, reference

FRAMES = 100_000
REFERENCE_FRAMES = 20_000


def run(repetitions: int) -> Results:
    """Measure."""
    results = Results()
    for dtype in (np.float32, np.float64):
        q = rotations(FRAMES, dtype=dtype)
        part = q[:REFERENCE_FRAMES].copy()
        slow = reference(lambda part=part: qf.noise_level(part), scale=FRAMES / REFERENCE_FRAMES)
        agreement.numbers("noise_level: reference", qf.noise_level(part), slow.call())
        own = ours(lambda q=q: qf.noise_level(q))
        results.table(
            f"noise_level, {JOINTS} joints × {FRAMES:,} frames, {q.dtype}",
            race([*own, slow, Contender("numpy.copy", q.copy)], repetitions),
            rotations=FRAMES * JOINTS,
            beside=[contender.name for contender in own],
            notes=[f"* on {REFERENCE_FRAMES:,} frames, multiplied."],
        )
    return results
