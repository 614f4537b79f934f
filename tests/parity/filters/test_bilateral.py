"""The bilateral orientation filter: the core against the reference."""

import clips
import drawn
import numpy as np
import pytest
import quatfilt as qf
import tolerances
from drawn import same_samples, seeds
from hypothesis import given
from hypothesis import strategies as st
from layouts import LAYOUTS
from quatfilt import _core, _reference

DTYPES = [np.float32, np.float64]
BOUNDARIES = ["nearest", "mirror", "linear"]
KERNELS = ["gaussian", "printed", "classic"]


def noisy(rng, frames, joints, sigma=0.05):
    """A clip with random signs to filter."""
    return clips.flipped(rng, clips.noisy(rng, clips.smooth(rng, frames, joints, swing=2), sigma))


def agree(
    q,
    *,
    translation=None,
    radius=4,
    sigma_time=1.0,
    sigma_angle=0.2,
    kernel="gaussian",
    iterations=1,
    boundary="mirror",
    lookahead=-1,
):
    sigma_angle = np.broadcast_to(sigma_angle, q.shape[1]).astype(np.float64)
    translation = None if translation is None else np.require(translation, q.dtype, "C")
    arguments = (q, translation, radius, sigma_time, sigma_angle, kernel, iterations, boundary, lookahead)
    before = [x.tobytes() for x in arguments[:2] if x is not None]
    (result, moved), (expected, path) = (backend.bilateral(*arguments) for backend in (_core, _reference))
    assert [x.tobytes() for x in arguments[:2] if x is not None] == before, "an input was written"
    assert result.dtype == expected.dtype == q.dtype
    assert result.shape == expected.shape == q.shape
    tolerance = tolerances.filtered(q.dtype)
    same_samples(result, expected, tolerance)
    if path is None:
        assert moved is None
    else:
        assert moved.dtype == path.dtype
        np.testing.assert_allclose(moved, path, rtol=0, atol=tolerance)


@given(
    seed=seeds,
    frames=st.one_of(st.integers(0, 5), st.integers(6, 90)),
    joints=st.sampled_from([0, 1, 2, 3, 17]),
    dtype=drawn.dtypes,
    chosen=st.fixed_dictionaries(
        {
            "radius": st.sampled_from([0, 1, 4, 20]),
            "sigma_time": st.sampled_from([0.5, 1.0, 10.0]),
            "kernel": st.sampled_from(KERNELS),
            "iterations": st.integers(1, 4),
            "boundary": st.sampled_from(BOUNDARIES),
            "lookahead": st.sampled_from([-1, 0, 1, 3, 30]),
        }
    ),
    sigma_angle=st.sampled_from([0.1, 0.2, 1.0, np.inf]),
    along=st.booleans(),
)
def test_any_options(seed, frames, joints, dtype, chosen, sigma_angle, along):
    rng = np.random.default_rng(seed)
    q = noisy(rng, frames, max(joints, 1), 0.1)[:, :joints]
    sigma_angle = sigma_angle * rng.uniform(0.5, 2, joints)
    translation = clips.path(rng, frames) if along else None
    agree(np.ascontiguousarray(q, dtype), translation=translation, sigma_angle=sigma_angle, **chosen)


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize(("joints", "lengths"), [(1, [2047, 2048, 2049]), (31, [127, 129, 319, 321, 577])])
def test_around_the_ends_of_tiles(joints, lengths, dtype):
    for frames in lengths:
        rng = np.random.default_rng(frames)
        q = noisy(rng, frames, joints).astype(dtype)
        agree(q, iterations=2, translation=clips.path(rng, frames))


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("boundary", BOUNDARIES)
@pytest.mark.parametrize("frames", [2, 3, 12, 400])
def test_windows_longer_than_the_clip(frames, boundary, dtype):
    rng = np.random.default_rng(2)
    q = noisy(rng, frames, 3).astype(dtype)
    agree(q, radius=50, sigma_time=5, sigma_angle=0.5, boundary=boundary, translation=clips.path(rng, frames))


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("sigma_angle", [1e-300, 1e-20, 1e-6, 1e6])
@pytest.mark.parametrize("kernel", KERNELS)
def test_extreme_scales(kernel, sigma_angle, dtype):
    q = noisy(np.random.default_rng(3), 300, 3).astype(dtype)
    agree(q, sigma_angle=sigma_angle, kernel=kernel)
    agree(q, sigma_time=sigma_angle, kernel=kernel)


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("layout", LAYOUTS)
def test_layouts(layout, dtype):
    plain = noisy(np.random.default_rng(4), 80, 3).astype(dtype)
    result = qf.bilateral(LAYOUTS[layout](plain))
    assert result.dtype == dtype
    np.testing.assert_array_equal(result, qf.bilateral(plain))


@given(
    q=drawn.spoilt_clips(lengths=st.integers(0, 60), joints=st.sampled_from([1, 3, 5])),
    gaps=st.sampled_from(["fill", "keep"]),
    max_gap=st.sampled_from([None, 0, 1, 3, 1000]),
)
def test_missing_samples(q, gaps, max_gap):
    result = qf.bilateral(q, gaps=gaps, max_gap=max_gap)
    with qf.use_backend("numpy"):
        expected = qf.bilateral(q, gaps=gaps, max_gap=max_gap)
    same_samples(result, expected, tolerances.filtered(result.dtype))
