"""Local models: the core against the reference."""

import clips
import numpy as np
import pytest
import tolerances
from drawn import dtypes, seeds
from hypothesis import given
from hypothesis import strategies as st
from local_models import MODELS, examples, predict
from quatfilt import _core, _reference


def agree(given_examples, model, **options):
    before = [array.tobytes() for array in given_examples]
    result, expected = (
        predict(backend, *given_examples, model, **options) for backend in (_core, _reference)
    )
    assert [array.tobytes() for array in given_examples] == before, "the input was written"
    for name, a, b in zip(("chart", "mean", "deviation"), result[:3], expected[:3], strict=True):
        assert a.dtype == b.dtype == np.float64
        np.testing.assert_allclose(a, b, atol=tolerances.LOCAL_MODELS, err_msg=name)
    assert result[3].shape == expected[3].shape
    # Axes have no sign of their own, and those of the same length turn into each other.
    covariances = [axes @ axes.T for axes in (result[3], expected[3])]
    np.testing.assert_allclose(*covariances, atol=tolerances.LOCAL_MODELS)


@given(
    seed=seeds,
    model=st.sampled_from(MODELS),
    target=st.sampled_from(["pose", "change"]),
    deviation=st.sampled_from(["predictive", "leave_one_out"]),
    count=st.sampled_from([1, 2, 3, 15, 16, 17, 40]),
    order=st.sampled_from([1, 2, 5]),
    joints=st.sampled_from([1, 2, 5, 31]),
    bandwidth=st.sampled_from([0.0, 0.3]),
    ridge=st.sampled_from([1e-4, 0.01, 1.0]),
    share=st.sampled_from([0.5, 0.97]),
    signals=st.sampled_from([0, 1, 24]),
    dtype=dtypes,
)
def test_of_motion(
    seed, model, target, deviation, count, order, joints, bandwidth, ridge, share, signals, dtype
):
    rng = np.random.default_rng(seed)
    segments, steps, recent = examples(rng, count, order, joints)
    segments, recent = (clips.flipped(rng, q) * rng.uniform(0.99, 1.01) for q in (segments, recent))
    agree(
        [np.ascontiguousarray(array, dtype) for array in (segments, steps, recent)],
        model,
        signals=np.ascontiguousarray(rng.standard_normal((count, signals)), dtype),
        target=target,
        deviation=deviation,
        weights=rng.random(joints),
        bandwidth=bandwidth,
        ridge=ridge,
        share=share,
    )


@pytest.mark.parametrize("model", MODELS)
def test_of_equal_examples(model):
    segments, steps, recent = examples(np.random.default_rng(0), 20, 3, 5)
    segments = np.broadcast_to(segments[:1], segments.shape).copy()
    agree([segments, steps, recent], model)
    agree([segments, 0 * steps, segments[0, :-1].copy()], model)


@pytest.mark.parametrize("model", MODELS)
def test_without_numbers_of_the_root(model):
    segments, _, recent = examples(np.random.default_rng(1), 20, 3, 5)
    agree([segments, np.zeros((20, 0)), recent], model)


@pytest.mark.parametrize("target", ["pose", "change"])
@pytest.mark.parametrize("model", MODELS)
def test_of_recordings(data_dir, model, target):
    import quatfilt as qf

    q = qf.read_motion(data_dir / "cmu" / "16" / "16_15.amc").rotations[::2].astype(np.float32)
    starts = np.arange(0, len(q) - 4, 3)[:64]
    segments = np.stack([q[start : start + 4] for start in starts])
    steps = np.zeros((len(starts), 4), np.float32)
    agree([segments, steps, q[100:103].copy()], model, target=target)
