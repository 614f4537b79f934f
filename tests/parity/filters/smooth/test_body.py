"""Smoothing along the axes of the body: the core against the reference."""

import clips
import drawn
import numpy as np
import pytest
import quatfilt as qf
import tolerances
from drawn import same_samples, seeds
from hypothesis import given
from hypothesis import strategies as st
from quatfilt import _core, _reference

DTYPES = [np.float32, np.float64]

NOISE = 0.05


def together(rng, frames, joints):
    """A gait with noise, and its pilot: each joint smoothed by itself."""
    q = clips.flipped(rng, clips.noisy(rng, clips.walk(rng, frames, joints), NOISE))
    return q, _core.smooth(q, None, None, np.full(joints, NOISE), 0.0)[0]


def agree(q, pilot, noise, confidence=None):
    q, pilot = np.ascontiguousarray(q), np.require(pilot, q.dtype, "C")
    confidence = None if confidence is None else np.require(confidence, q.dtype, "C")
    arguments = (q, pilot, confidence, np.broadcast_to(noise, q.shape[1]).astype(np.float64))
    arrays = [x for x in arguments if x is not None]
    before = [x.tobytes() for x in arrays]
    result, expected = (backend.smooth_body(*arguments) for backend in (_core, _reference))
    assert [x.tobytes() for x in arrays] == before, "an input was written"
    same_samples(result, expected, tolerances.principal_axes(q.dtype, len(q)))
    return result


@given(
    seed=seeds,
    frames=st.one_of(st.integers(0, 30), st.sampled_from([63, 64, 65, 200, 513])),
    joints=st.sampled_from([0, 1, 2, 4]),
    dtype=drawn.dtypes,
    trusting=st.booleans(),
)
def test_any_clip(seed, frames, joints, dtype, trusting):
    rng = np.random.default_rng(seed)
    q, pilot = together(rng, frames, max(joints, 1))
    trust = clips.confidences(rng, frames, joints) if trusting else None
    agree(q[:, :joints].astype(dtype), pilot[:, :joints], NOISE, trust)


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("frames", [279, 280, 600])
def test_a_body(frames, dtype):
    """Of fewer than 3 · 93 frames for 31 joints nothing is to be learnt."""
    rng = np.random.default_rng(frames)
    q, pilot = together(rng, frames, 31)
    result = agree(q.astype(dtype), pilot, NOISE)
    assert clips.angles(result, pilot).max() > 1e-3
    if frames == 279:
        result = agree(q[1:].astype(dtype), pilot[1:], NOISE)
        assert clips.angles(result, pilot[1:]).max() < tolerances.algebra(dtype)


@pytest.mark.parametrize(("joints", "frames"), [(64, 580), (65, 300), (65, 296)])
def test_more_joints_are_several_bodies(joints, frames):
    """65 joints are bodies of 33 and 32, of which at 296 frames the smaller one alone has as many frames as it needs."""
    rng = np.random.default_rng(joints)
    q, pilot = together(rng, frames, joints)
    result = agree(q, pilot, NOISE)
    moved = clips.angles(result, pilot).max(axis=0) > 1e-3
    assert moved[33:].all()
    assert moved[:33].any() == (frames != 296)


@pytest.mark.parametrize("dtype", DTYPES)
def test_joints_that_are_still_and_joints_without_noise(dtype):
    rng = np.random.default_rng(0)
    q, pilot = together(rng, 300, 9)
    pilot[:, 2] = pilot[0, 2]
    pilot[:, 7] = q[:, 7] = q[0, 7]
    noise = np.full(9, NOISE)
    noise[[4, 5]] = 0
    agree(q.astype(dtype), pilot, noise)


@pytest.mark.parametrize("dtype", DTYPES)
def test_a_pilot_that_stands_still(dtype):
    rng = np.random.default_rng(1)
    q, pilot = together(rng, 200, 3)
    still = np.repeat(pilot[:1], 200, axis=0)
    result = agree(q.astype(dtype), still, NOISE)
    assert clips.angles(result, still).max() < 2 * tolerances.algebra(dtype)


@pytest.mark.parametrize("dtype", DTYPES)
def test_a_pilot_that_is_as_rough_as_the_clip(dtype):
    rng = np.random.default_rng(2)
    q, _ = together(rng, 200, 3)
    agree(q.astype(dtype), clips.flipped(rng, clips.noisy(rng, q, 0.2)), NOISE)


@pytest.mark.parametrize("frames", [300, 5000])
def test_threads_do_not_matter(frames):
    rng = np.random.default_rng(3)
    q, pilot = together(rng, frames, 6)
    try:
        results = []
        for threads in (1, 2, 5):
            qf.set_num_threads(threads)
            results.append(_core.smooth_body(q, pilot, None, np.full(6, NOISE)))
    finally:
        qf.set_num_threads(None)
    for result in results[1:]:
        np.testing.assert_array_equal(result, results[0])


def test_arrays_that_do_not_fit_are_refused():
    rng = np.random.default_rng(4)
    q, pilot = together(rng, 30, 2)
    for arguments in (
        (q, pilot[:-1].copy(), None, np.full(2, NOISE)),
        (q, pilot, np.ones((30, 3)), np.full(2, NOISE)),
        (q, pilot, None, np.full(3, NOISE)),
    ):
        with pytest.raises(ValueError, match="expected"):
            _core.smooth_body(*arguments)
