"""Low rank in bands of frequencies: the core against the reference."""

import clips
import drawn
import numpy as np
import pytest
import quatfilt as qf
import tolerances
from drawn import same_samples, seeds
from hypothesis import given
from hypothesis import strategies as st
from plugins.properties import examples
from quatfilt import _core, _reference

DTYPES = [np.float32, np.float64]


def noisy(rng, frames, joints, sigma=0.05):
    """A gait with noise and random signs, and an estimate of it."""
    clean = clips.walk(rng, frames, joints)
    q = clips.flipped(rng, clips.noisy(rng, clean, sigma))
    return q, clips.flipped(rng, clips.noisy(rng, clean, sigma / 3))


def agree(q, pilot, confidence=None, *, noise=0.05, tolerance=0):
    level = np.broadcast_to(np.asarray(noise, np.float64), q.shape[1]).copy()
    confidence = None if confidence is None else confidence.astype(q.dtype)
    arguments = (q, pilot.astype(q.dtype), confidence, level)
    arrays = [x for x in arguments if isinstance(x, np.ndarray)]
    before = [x.tobytes() for x in arrays]
    result, expected = (backend.smooth_rank(*arguments) for backend in (_core, _reference))
    assert [x.tobytes() for x in arrays] == before, "an input was written"
    assert result.dtype == expected.dtype == q.dtype
    same_samples(result, expected, max(tolerance, tolerances.filtered(q.dtype)))
    return result


@examples(25)
@given(
    seed=seeds,
    frames=st.one_of(st.integers(0, 130), st.integers(131, 700)),
    joints=st.sampled_from([0, 1, 3, 4, 7]),
    dtype=drawn.dtypes,
    weighted=st.booleans(),
    silent=st.booleans(),
)
def test_any_clip(seed, frames, joints, dtype, weighted, silent):
    rng = np.random.default_rng(seed)
    q, pilot = (np.ascontiguousarray(x[:, :joints], dtype) for x in noisy(rng, frames, max(joints, 1)))
    trust = clips.confidences(rng, frames, joints) if weighted else None
    noise = np.where(rng.random(joints) < 0.3 * silent, 0.0, rng.uniform(0.02, 0.2, joints))
    agree(q, pilot, trust, noise=noise)


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("frames", [128, 511, 512, 513, 768, 1500])
def test_a_body(frames, dtype):
    """Bands have more rows than columns, or fewer."""
    q, pilot = (x.astype(dtype) for x in noisy(np.random.default_rng(frames), frames, 31))
    assert clips.angles(agree(q, pilot), pilot).max() > 1e-3


def test_windows_of_several_passes():
    agree(*noisy(np.random.default_rng(1), 17 * 256 + 100, 4))


@pytest.mark.parametrize("noise", [2e-6, 1e-4, 1e-3, 1.0, 100.0])
def test_any_strength(noise):
    """Roundings of the products show as the square of the motion over the noise."""
    q, pilot = noisy(np.random.default_rng(2), 300, 5, sigma=min(noise, 0.05))
    agree(q, pilot, noise=noise, tolerance=1e-15 / noise)


def test_motionless_pilots_and_clips():
    q, pilot = noisy(np.random.default_rng(3), 400, 6)
    pilot[:, 1] = pilot[0, 1]
    pilot[150:, 2] = pilot[150, 2]
    agree(q, pilot)
    still = np.repeat(pilot[:1], 400, axis=0)
    agree(still, still)


@pytest.mark.parametrize("dtype", DTYPES)
def test_the_number_of_threads_does_not_matter(dtype):
    q, pilot = (x.astype(dtype) for x in noisy(np.random.default_rng(5), 1500, 7))
    noise = np.full(7, 0.05)
    results = []
    try:
        for threads in (1, 2, 5):
            qf.set_num_threads(threads)
            results.append(_core.smooth_rank(q, pilot, None, noise).tobytes())
    finally:
        qf.set_num_threads(None)
    assert results[0] == results[1] == results[2]


def test_real_clips(data_dir):
    files = sorted((data_dir / "cmu").rglob("*.amc"))[:3]
    assert files
    for file in files:
        clean = np.ascontiguousarray(qf.read_motion(file).rotations[:600])
        q = qf.add_gaussian_noise(clean, sigma=0.05, rng=1)
        agree(q, qf.gaussian(q, sigma=3), noise=qf.noise_level(q))


def test_arrays_that_do_not_fit_are_refused():
    q, pilot = noisy(np.random.default_rng(4), 30, 2)
    for arguments in (
        (q, pilot[:-1].copy(), None, np.full(2, 0.05)),
        (q, pilot, np.ones((30, 3)), np.full(2, 0.05)),
        (q, pilot, None, np.full(3, 0.05)),
    ):
        with pytest.raises(ValueError, match="expected"):
            _core.smooth_rank(*arguments)
