"""Local models: the core against the reference."""

import contextlib
import functools

import clips
import numpy as np
import pytest
import tolerances
from drawn import dtypes, seeds
from hypothesis import given
from hypothesis import strategies as st
from local_models import MODELS, examples, predict
from quatfilt import _core, _reference
from quatfilt._reference.reconstruction.local_models import principal
from quatfilt._reference.reconstruction.local_models.examples import Examples

SHAKEN = 1e-13
"""Relative, of the examples, of sums over them and of eigenvectors: hundreds of roundings of float64."""

RESIDUAL = 1e-14
"""Of an inverse, in units of the condition: tens of roundings."""

TIMES = 3
"""They are shaken so often."""


def compared(prediction):
    """Chart, mean, deviation, and the covariance along the axes, which have no sign of their own and turn into each other."""
    chart, mean, deviation, axes = prediction
    return {"chart": chart, "mean": mean, "deviation": deviation, "covariance": axes @ axes.T}


@contextlib.contextmanager
def shaken(rng):
    """Let the reference differ by hundreds of roundings in what it goes on with."""
    with pytest.MonkeyPatch.context() as patch:
        whole = {name: getattr(Examples, name).func for name in ("gram", "total", "inverse")}

        def gram(own):
            exact = whole["gram"](own)
            noise = rng.standard_normal(exact.shape)
            return exact + SHAKEN * np.abs(exact).max(initial=0) * (noise + noise.T)

        def inverse(own):
            exact = whole["inverse"](own)
            condition = np.linalg.norm(exact, 2) * (np.trace(own.gram) + own.ridge)
            return exact + RESIDUAL * condition * exact @ rng.standard_normal(exact.shape)

        def total(own):
            return whole["total"](own) * (1 + SHAKEN * rng.choice([-1, 1]))

        def components(matrix, share, exact=principal.components):
            values, vectors = exact(matrix, share)
            return values, vectors * (1 + SHAKEN * rng.standard_normal(vectors.shape))

        for function in (gram, inverse, total):
            kept = functools.cached_property(function)
            kept.__set_name__(Examples, function.__name__)
            patch.setattr(Examples, function.__name__, kept)
        patch.setattr(principal, "components", components)
        yield


def predict_shaken(given_examples, model, seed, **options):
    """Predict with the reference from what differs by hundreds of roundings."""
    rng = np.random.default_rng(seed)

    def moved(x):
        return x * (1 + SHAKEN * rng.standard_normal(np.shape(x)))

    if "signals" in options:
        options["signals"] = moved(options["signals"])
    with shaken(rng):
        return predict(_reference, *(moved(np.float64(x)) for x in given_examples), model, **options)


def agree(given_examples, model, **options):
    """Compare what hundreds of roundings do not change, by what they change.

    What is left of an example where it is left out may be a hundred thousandth of what it is the difference of, and the number of
    components may hang on a rounding.
    """
    before = [array.tobytes() for array in given_examples]
    result, expected = (
        predict(backend, *given_examples, model, **options) for backend in (_core, _reference)
    )
    assert [array.tobytes() for array in given_examples] == before, "the input was written"
    others = [predict_shaken(given_examples, model, seed, **options) for seed in range(TIMES)]
    if all(other[3].shape == expected[3].shape for other in others):
        assert result[3].shape == expected[3].shape
    result, expected, *others = map(compared, (result, expected, *others))
    for name, b in expected.items():
        assert result[name].dtype == b.dtype == np.float64
        change = max(np.abs(other[name] - b).max(initial=0) for other in others)
        size = max(1, np.abs(b).max(initial=0))
        np.testing.assert_allclose(
            result[name], b, rtol=0, atol=tolerances.FLOAT64 * size + change, err_msg=name
        )


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
