"""The learned last step: the core against the reference."""

import clips
import drawn
import networks
import numpy as np
import pytest
import quatfilt as qf
import tolerances
from drawn import same_samples, seeds
from hypothesis import given, settings
from hypothesis import strategies as st
from quatfilt import _core, _reference
from quatfilt.filters._gains import weights

DTYPES = [np.float32, np.float64]


def noisy(rng, frames, joints, sigma=0.05):
    """A gait with noise and random signs, and two estimates of it."""
    clean = clips.walk(rng, frames, joints)
    return [clips.flipped(rng, clips.noisy(rng, clean, s)) for s in (sigma, sigma / 3, sigma / 4)]


def agree(q, patches, pilot, confidence=None, *, noise=0.05, share=1.0, layers=None):
    level = np.broadcast_to(np.asarray(noise, np.float64), q.shape[1]).copy()
    confidence = None if confidence is None else confidence.astype(q.dtype)
    layers = networks.drawn(0) if layers is None else layers
    arguments = (q, patches.astype(q.dtype), pilot.astype(q.dtype), confidence, level, share, *layers)
    arrays = [x for x in arguments if isinstance(x, np.ndarray)]
    before = [x.tobytes() for x in arrays]
    result, expected = (backend.smooth_gains(*arguments) for backend in (_core, _reference))
    assert [x.tobytes() for x in arrays] == before, "an input was written"
    assert result.dtype == expected.dtype == q.dtype
    same_samples(result, expected, tolerances.gains(q.dtype))
    return result


@settings(max_examples=25)
@given(
    seed=seeds,
    frames=st.one_of(st.integers(0, 130), st.integers(131, 700)),
    joints=st.sampled_from([0, 1, 3, 14]),
    dtype=drawn.dtypes,
    weighted=st.booleans(),
    silent=st.booleans(),
)
def test_any_clip(seed, frames, joints, dtype, weighted, silent):
    rng = np.random.default_rng(seed)
    q, patches, pilot = (
        np.ascontiguousarray(x[:, :joints], dtype) for x in noisy(rng, frames, max(joints, 1))
    )
    trust = clips.confidences(rng, frames, joints) if weighted else None
    noise = np.where(rng.random(joints) < 0.3 * silent, 0.0, rng.uniform(0.02, 0.2, joints))
    agree(q, patches, pilot, trust, noise=noise, share=rng.uniform(0, 1))


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("frames", [128, 129, 2039, 2040, 2041, 4500])
def test_blocks(frames, dtype):
    """Each block of 2040 frames sees what its gains depend on."""
    q, patches, pilot = (x.astype(dtype) for x in noisy(np.random.default_rng(frames), frames, 5))
    assert clips.angles(agree(q, patches, pilot), pilot).max() > 1e-3


def test_the_weights_of_the_package():
    rng = np.random.default_rng(7)
    agree(*noisy(rng, 400, 20), layers=weights())


@pytest.mark.parametrize("units", [1, 3, 30])
def test_networks_of_any_size(units):
    agree(*noisy(np.random.default_rng(8), 200, 3), layers=networks.drawn(1, units))


def test_skeletons_too_wide_for_axes_of_the_body():
    agree(*noisy(np.random.default_rng(9), 130, 171))


@pytest.mark.parametrize("noise", [2e-6, 1e-3, 1.0, 100.0])
def test_any_strength(noise):
    agree(
        *noisy(np.random.default_rng(2), 300, 5, sigma=min(noise, 0.05)),
        noise=noise,
        share=min(1, 0.1 / noise),
    )


def test_motionless_pilots():
    q, patches, pilot = noisy(np.random.default_rng(3), 400, 6)
    pilot[:, 1] = pilot[0, 1]
    agree(q, patches, pilot)


@pytest.mark.parametrize("dtype", DTYPES)
def test_the_number_of_threads_does_not_matter(dtype):
    q, patches, pilot = (x.astype(dtype) for x in noisy(np.random.default_rng(5), 2500, 7))
    results = []
    try:
        for threads in (1, 2, 5):
            qf.set_num_threads(threads)
            arguments = (q, patches, pilot, None, np.full(7, 0.05), 1.0, *networks.drawn(0))
            results.append(_core.smooth_gains(*arguments).tobytes())
    finally:
        qf.set_num_threads(None)
    assert results[0] == results[1] == results[2]


def test_arrays_that_do_not_fit_are_refused():
    q, patches, pilot = noisy(np.random.default_rng(4), 30, 2)
    noise = np.full(2, 0.05)
    first, second, last = networks.drawn(0)
    for arguments in (
        (q, patches[:-1].copy(), pilot, None, noise, 1.0, first, second, last),
        (q, patches, pilot[:-1].copy(), None, noise, 1.0, first, second, last),
        (q, patches, pilot, np.ones((30, 3)), noise, 1.0, first, second, last),
        (q, patches, pilot, None, np.full(3, 0.05), 1.0, first, second, last),
        (q, patches, pilot, None, noise, 1.0, first[:-1].copy(), second, last),
        (q, patches, pilot, None, noise, 1.0, first, second[:-1].copy(), last),
        (q, patches, pilot, None, noise, 1.0, first, second, last[:-1].copy()),
    ):
        with pytest.raises(ValueError, match="expected"):
            _core.smooth_gains(*arguments)
