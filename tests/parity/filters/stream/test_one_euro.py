"""The 1€ filter of a stream against the reference's filter of the whole clip."""

import clips
import drawn
import numpy as np
import pytest
import quatfilt as qf
import streams
import tolerances
from drawn import same_samples, seeds
from hypothesis import given
from hypothesis import strategies as st
from quatfilt import _reference

DTYPES = [np.float32, np.float64]


def noisy(rng, frames, joints, sigma=0.05):
    return clips.flipped(rng, clips.noisy(rng, clips.smooth(rng, frames, joints, swing=2), sigma))


def whole(q, confidence=None, *, min_cutoff=0.02, beta=0.1, derivative_cutoff=0.05):
    """The reference's filter of the clip."""
    numbers = [
        np.broadcast_to(x, q.shape[1]).astype(np.float64) for x in (min_cutoff, beta, derivative_cutoff)
    ]
    confidence = None if confidence is None else confidence.astype(q.dtype)
    return _reference.one_euro(q, None, confidence, *numbers)[0]


def agree(q, confidence=None, **options):
    before = q.tobytes()
    chosen = {"min_cutoff": 0.02, "beta": 0.1, "derivative_cutoff": 0.05} | options
    result = streams.run(qf.OneEuroStream(**chosen), q, confidence)
    assert q.tobytes() == before, "an input was written"
    expected = whole(q, confidence, **options)
    if confidence is not None:
        # A stream cannot know where the first sample with confidence will be.
        unknown = np.cumsum(confidence > 0, axis=0) == 0
        expected[unknown] = result[unknown]
        assert clips.angles(expected[unknown], q[unknown]).max(initial=0) < tolerances.filtered(q.dtype)
        expected = qf.continuous(expected)
    same_samples(result, expected, tolerances.filtered(q.dtype))
    return result


@given(
    seed=seeds,
    frames=st.integers(2, 60),
    joints=st.sampled_from([1, 2, 7, 8, 9, 17]),
    dtype=drawn.dtypes,
    min_cutoff=st.sampled_from([1e-3, 0.1, 10.0, np.inf]),
    beta=st.sampled_from([0.0, 0.1, 1e6]),
    derivative_cutoff=st.sampled_from([1e-3, 0.1, np.inf]),
)
def test_any_options(seed, frames, joints, dtype, min_cutoff, beta, derivative_cutoff):
    rng = np.random.default_rng(seed)
    agree(
        noisy(rng, frames, joints).astype(dtype),
        min_cutoff=min_cutoff * rng.uniform(0.5, 2, joints),
        beta=beta * rng.uniform(0.5, 2, joints),
        derivative_cutoff=derivative_cutoff * rng.uniform(0.5, 2, joints),
    )


@given(seed=seeds)
def test_confidences(seed):
    rng = np.random.default_rng(seed)
    agree(noisy(rng, 40, 3), clips.confidences(rng, 40, 3))


@given(q=drawn.spoilt_clips(lengths=st.integers(2, 60), joints=st.sampled_from([1, 3, 9])))
def test_missing_samples_are_those_of_the_clip(q):
    """Also for the filter of the clip, whose gaps are filled: what they are filled with does not matter."""
    options = {"min_cutoff": 0.02, "beta": 0.1, "derivative_cutoff": 0.05}
    result = streams.run(qf.OneEuroStream(**options), q)
    clip, there, since = streams.held(q)
    expected = whole(clip, there.astype(float), **options)
    expected[~since] = np.nan
    same_samples(qf.continuous(result), qf.continuous(expected), tolerances.filtered(q.dtype))
    filled = qf.one_euro(q, **options)
    filled[~since] = np.nan
    same_samples(qf.continuous(result), qf.continuous(filled), tolerances.filtered(q.dtype))


def test_seconds():
    q = noisy(np.random.default_rng(6), 60, 3)
    options = {"fps": 120.0, "min_cutoff": 2.0, "beta": 0.3, "derivative_cutoff": 4.0}
    same_samples(streams.run(qf.OneEuroStream(**options), q), qf.one_euro(q, **options), tolerances.FLOAT64)


@pytest.mark.parametrize("name", ["cmu/02/02_01.amc", "cmu/05/05_02.amc"])
@pytest.mark.parametrize("dtype", DTYPES)
def test_real_motion(data_dir, name, dtype):
    q = qf.read_motion(data_dir / name).rotations[:300]
    agree(qf.add_gaussian_noise(q, sigma=0.02, rng=0).astype(dtype))
