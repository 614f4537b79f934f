"""The Kalman filter of a stream against the reference's filter of the whole clip."""

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


def whole(q, confidence=None, *, process_noise=0.01, measurement_noise=0.05, lookahead=0):
    """The reference's filter of the clip."""
    noises = [np.broadcast_to(x, q.shape[1]).astype(np.float64) for x in (process_noise, measurement_noise)]
    confidence = None if confidence is None else confidence.astype(q.dtype)
    return _reference.kalman(q, confidence, *noises, lookahead)


def agree(q, confidence=None, **options):
    before = q.tobytes()
    chosen = {"process_noise": 0.01, "measurement_noise": 0.05} | options
    result = streams.run(qf.KalmanStream(**chosen), q, confidence)
    assert q.tobytes() == before, "an input was written"
    expected = whole(q, confidence, **options)
    if confidence is not None:
        # A stream cannot know where the first sample with confidence will be.
        unknown = np.cumsum(confidence > 0, axis=0) == 0
        expected[unknown] = result[unknown]
        assert clips.angles(expected[unknown], q[unknown]).max(initial=0) < tolerances.filtered(q.dtype)
        result = qf.continuous(result) * np.sign(np.sum(result[0] * q[0], axis=-1))[:, None]
        expected = qf.continuous(expected)
    same_samples(result, expected, tolerances.filtered(q.dtype))
    return result


@given(
    seed=seeds,
    frames=st.integers(2, 25),
    joints=st.sampled_from([1, 2, 7, 8, 9, 17]),
    dtype=drawn.dtypes,
    process=st.sampled_from([0.0, 1e-3, 0.1, 3.0]),
    measurement=st.sampled_from([1e-3, 0.05, 1.0]),
    lookahead=st.sampled_from([0, 1, 5, 30]),
)
def test_any_options(seed, frames, joints, dtype, process, measurement, lookahead):
    rng = np.random.default_rng(seed)
    agree(
        noisy(rng, frames, joints).astype(dtype),
        process_noise=process * rng.uniform(0.5, 2, joints),
        measurement_noise=measurement * rng.uniform(0.5, 2, joints),
        lookahead=lookahead,
    )


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("lookahead", [0, 1, 12])
def test_many_frames(lookahead, dtype):
    q = noisy(np.random.default_rng(1), 300, 9).astype(dtype)
    result = agree(q, lookahead=lookahead)
    assert clips.angles(result, q).max() > 0.01


@pytest.mark.parametrize("lookahead", [0, 3, 30])
@given(seed=seeds)
def test_confidences(lookahead, seed):
    rng = np.random.default_rng(seed)
    agree(noisy(rng, 25, 3), clips.confidences(rng, 25, 3), lookahead=lookahead)


@pytest.mark.parametrize("lookahead", [0, 3, 30])
@given(q=drawn.spoilt_clips(lengths=st.integers(2, 25), joints=st.sampled_from([1, 3, 9])))
def test_missing_samples_are_those_of_the_clip(q, lookahead):
    """Also for the filter of the clip, whose gaps are filled: what they are filled with does not matter."""
    options = {"process_noise": 0.01, "measurement_noise": 0.05, "lookahead": lookahead}
    result = streams.run(qf.KalmanStream(**options), q)
    clip, there, since = streams.held(q)
    expected = whole(clip, there.astype(float), **options)
    expected[~since] = np.nan
    same_samples(qf.continuous(result), qf.continuous(expected), tolerances.filtered(q.dtype))
    filled = qf.kalman(q, **options)
    filled[~since] = np.nan
    same_samples(qf.continuous(result), qf.continuous(filled), tolerances.filtered(q.dtype))


@pytest.mark.parametrize("lookahead", [1, 4])
def test_one_pose_comes_back_with_length_one(lookahead):
    q = noisy(np.random.default_rng(5), 1, 3)
    stream = qf.KalmanStream(process_noise=0.1, measurement_noise=0.1, lookahead=lookahead)
    same_samples(streams.run(stream, 1.05 * q), q, tolerances.FLOAT64)


def test_seconds():
    q = noisy(np.random.default_rng(6), 60, 3)
    options = {"fps": 120.0, "process_noise": 5.0, "measurement_noise": 0.05, "lookahead": 4}
    same_samples(streams.run(qf.KalmanStream(**options), q), qf.kalman(q, **options), tolerances.FLOAT64)


@pytest.mark.parametrize("name", ["cmu/02/02_01.amc", "cmu/05/05_02.amc"])
@pytest.mark.parametrize("lookahead", [0, 8])
@pytest.mark.parametrize("dtype", DTYPES)
def test_real_motion(data_dir, name, lookahead, dtype):
    q = qf.read_motion(data_dir / name).rotations[:300]
    q = qf.add_gaussian_noise(q, sigma=0.02, rng=0).astype(dtype)
    process, measurement = qf.kalman_noises(q[:120], fps=120, lookahead=lookahead)
    agree(q, process_noise=process * 120**-1.5, measurement_noise=measurement, lookahead=lookahead)
