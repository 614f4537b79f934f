"""Confidence: the core against the reference."""

import clips
import drawn
import numpy as np
import tolerances
from drawn import same_samples, seeds
from hypothesis import given
from hypothesis import strategies as st
from quatfilt import _core, _reference


def agree(q, confidence):
    before = q.tobytes(), confidence.tobytes()
    result, expected = (backend.pulled_by_confidence(q, confidence) for backend in (_core, _reference))
    assert (q.tobytes(), confidence.tobytes()) == before, "an input was written"
    same_samples(result, expected, tolerances.filtered(q.dtype))


@given(
    seed=seeds,
    frames=st.one_of(st.integers(0, 20), st.sampled_from([64, 300])),
    joints=st.sampled_from([0, 1, 2, 17]),
    dtype=drawn.dtypes,
    least=st.sampled_from([0.0, 0.5, 1.0]),
)
def test_trusted(seed, frames, joints, dtype, least):
    rng = np.random.default_rng(seed)
    q = clips.flipped(rng, clips.noisy(rng, clips.smooth(rng, frames, max(joints, 1)), 0.1))[:, :joints]
    confidence = np.maximum(clips.confidences(rng, frames, joints), least)
    agree(np.ascontiguousarray(q, dtype), confidence.astype(dtype))


def test_across_tiles():
    rng = np.random.default_rng(1)
    q = clips.flipped(rng, clips.noisy(rng, clips.smooth(rng, 20_000, 3), 0.1))
    confidence = clips.confidences(rng, 20_000, 3)
    confidence[:, 1] = 0
    confidence[5_000:15_000, 2] = 0
    agree(q, confidence)
