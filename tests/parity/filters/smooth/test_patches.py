"""Groups of similar patches: the core against the reference.

Both take the same neighbours unless the distances of two differ by no more than rounding. The clips are noisy, and have no such ties
but those between patches that are equal.
"""

import clips
import numpy as np
import pytest
import quatfilt as qf
import tolerances
from drawn import dtypes, same_samples, seeds
from hypothesis import given
from hypothesis import strategies as st
from plugins.properties import examples
from quatfilt import _core, _reference

DTYPES = [np.float32, np.float64]


def noisy(rng, frames, joints, sigma=0.05):
    """A clip with random signs, and an estimate of it."""
    clean = clips.smooth(rng, frames, joints, swing=2)
    q = clips.flipped(rng, clips.noisy(rng, clean, sigma))
    return q, clips.flipped(rng, clips.noisy(rng, clean, sigma / 3))


def agree(q, pilot, confidence=None, *, noise=0.05, rounds=1, tolerance=0):
    level = np.broadcast_to(np.asarray(noise, np.float64), q.shape[1]).copy()
    confidence = None if confidence is None else confidence.astype(q.dtype)
    arguments = (q, pilot.astype(q.dtype), confidence, level, rounds)
    arrays = [x for x in arguments if isinstance(x, np.ndarray)]
    before = [x.tobytes() for x in arrays]
    result, expected = (backend.smooth_patches(*arguments) for backend in (_core, _reference))
    assert [x.tobytes() for x in arrays] == before, "an input was written"
    assert result.dtype == expected.dtype == q.dtype
    same_samples(result, expected, max(tolerance, tolerances.filtered(q.dtype)))


@examples(25)
@given(
    seed=seeds,
    frames=st.one_of(st.integers(0, 110), st.integers(111, 300)),
    joints=st.sampled_from([0, 1, 2, 3, 6]),
    dtype=dtypes,
    weighted=st.booleans(),
    silent=st.booleans(),
    rounds=st.integers(0, 2),
)
def test_any_clip(seed, frames, joints, dtype, weighted, silent, rounds):
    rng = np.random.default_rng(seed)
    q, pilot = (np.ascontiguousarray(x[:, :joints], dtype) for x in noisy(rng, frames, max(joints, 1)))
    trust = clips.confidences(rng, frames, joints) if weighted else None
    noise = np.where(rng.random(joints) < 0.4 * silent, 0.0, rng.uniform(0.02, 0.2, joints))
    agree(q, pilot, trust, noise=noise, rounds=rounds)


@pytest.mark.parametrize("frames", [768 + 23, 768 + 24, 768 + 25, 768 + 47, 768 + 48, 1536 + 27])
def test_around_the_ends_of_tasks(frames):
    agree(*noisy(np.random.default_rng(frames), frames, 2))


@pytest.mark.parametrize("frames", [6144 + 16, 6144 + 24, 6144 + 29, 6144 + 600])
def test_around_the_ends_of_passes(frames):
    agree(*noisy(np.random.default_rng(frames), frames, 1))


@pytest.mark.parametrize("noise", [2e-6, 1e-4, 1e-3, 1.0, 100.0])
def test_any_strength(noise):
    """Roundings of the covariance show as the square of the motion over the noise."""
    rng = np.random.default_rng(1)
    q, pilot = noisy(rng, 200, 3, sigma=min(noise, 0.05))
    agree(q, pilot, noise=noise, tolerance=1e-15 / noise)


def test_motionless_pilots():
    """All of their patches are equal: those nearest in time count, and say nothing."""
    rng = np.random.default_rng(2)
    q, pilot = noisy(rng, 400, 3)
    pilot[:, 1] = pilot[0, 1]
    pilot[150:, 2] = pilot[150, 2]
    agree(q, pilot)


def test_joints_that_move_alike_choose_the_first():
    """All turn about one axis each by the same angle: every similarity is 1 but for roundings."""
    rng = np.random.default_rng(3)
    angle = np.cumsum(rng.normal(0, 0.05, 200))
    axes = rng.standard_normal((5, 3))
    axes /= np.linalg.norm(axes, axis=-1, keepdims=True)
    pilot = clips.from_vectors(angle[:, None, None] * axes)
    agree(clips.noisy(rng, pilot, 0.05), pilot)


@pytest.mark.parametrize("joints", [64, 65, 130])
def test_joints_of_several_tiles_find_the_ones_that_move_like_them(joints):
    """The core takes the products of the steps of 64 joints at a time; joints are equally alike to some in other tiles."""
    rng = np.random.default_rng(joints)
    order = rng.integers(0, joints // 2, joints)
    agree(*(np.ascontiguousarray(x[:, order]) for x in noisy(rng, 110, joints // 2)))


@pytest.mark.parametrize("dtype", DTYPES)
def test_the_number_of_threads_does_not_matter(dtype):
    q, pilot = (x.astype(dtype) for x in noisy(np.random.default_rng(5), 1500, 7))
    noise = np.full(7, 0.05)
    results = []
    try:
        for threads in (1, 2, 5):
            qf.set_num_threads(threads)
            results.append(_core.smooth_patches(q, pilot, None, noise, 2).tobytes())
    finally:
        qf.set_num_threads(None)
    assert results[0] == results[1] == results[2]


def test_real_clips(data_dir):
    files = sorted((data_dir / "cmu").rglob("*.amc"))[:3]
    assert files
    for file in files:
        clean = np.ascontiguousarray(qf.read_motion(file).rotations[:260])
        q = qf.add_gaussian_noise(clean, sigma=0.05, rng=1)
        noise = qf.noise_level(q)
        agree(q, qf.gaussian(q, sigma=3), noise=noise)
