"""The bilateral filter of a stream against the reference's filter of the whole clip."""

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


def noisy(rng, frames, joints, sigma=0.1):
    return clips.flipped(rng, clips.noisy(rng, clips.smooth(rng, frames, joints, swing=2), sigma))


def whole(
    q,
    *,
    radius=4,
    sigma_time=1.0,
    sigma_angle=0.2,
    kernel="gaussian",
    iterations=1,
    boundary="nearest",
    lookahead=0,
):
    """The reference's filter of the clip."""
    angles = np.broadcast_to(sigma_angle, q.shape[1]).astype(np.float64)
    return _reference.bilateral(q, None, radius, sigma_time, angles, kernel, iterations, boundary, lookahead)[
        0
    ]


def agree(q, **options):
    before = q.tobytes()
    result = streams.run(qf.BilateralStream(**options), q)
    assert q.tobytes() == before, "an input was written"
    same_samples(result, whole(q, **options), tolerances.filtered(q.dtype))
    return result


@given(
    seed=seeds,
    frames=st.integers(2, 50),
    joints=st.sampled_from([1, 2, 7, 8, 9, 31]),
    dtype=drawn.dtypes,
    chosen=st.fixed_dictionaries(
        {
            "radius": st.integers(1, 8),
            "sigma_time": st.sampled_from([0.5, 1.0, 10.0]),
            "kernel": st.sampled_from(["gaussian", "printed", "classic"]),
            "iterations": st.integers(1, 4),
            "boundary": st.sampled_from(["nearest", "linear"]),
        }
    ),
    sigma_angle=st.sampled_from([0.1, 0.2, 1.0, np.inf]),
    lookahead=st.floats(0, 1),
)
def test_any_options(seed, frames, joints, dtype, chosen, sigma_angle, lookahead):
    rng = np.random.default_rng(seed)
    least = 1 if chosen["boundary"] == "linear" else 0
    chosen["lookahead"] = round(least + lookahead * (chosen["radius"] - least))
    chosen["sigma_angle"] = sigma_angle * rng.uniform(0.5, 2, joints)
    agree(noisy(rng, frames, joints).astype(dtype), **chosen)


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("iterations", [1, 5])
@pytest.mark.parametrize("lookahead", [0, 1, 4])
def test_default_windows(lookahead, iterations, dtype):
    q = noisy(np.random.default_rng(1), 400, 31).astype(dtype)
    result = agree(q, iterations=iterations, lookahead=lookahead)
    assert clips.angles(result, q).max() > 0.01


def test_no_limit_at_the_longest_lookahead():
    q = noisy(np.random.default_rng(2), 80, 3)
    result = streams.run(qf.BilateralStream(iterations=3, lookahead=4), q)
    same_samples(result, whole(q, iterations=3, lookahead=-1), tolerances.FLOAT64)


def test_a_window_of_one_frame():
    q = noisy(np.random.default_rng(3), 20, 3)
    same_samples(agree(q, radius=0), qf.continuous(q), tolerances.FLOAT64)


@pytest.mark.parametrize("boundary", ["nearest", "linear"])
@pytest.mark.parametrize("frames", [2, 3, 12])
def test_windows_longer_than_the_clip(frames, boundary):
    q = noisy(np.random.default_rng(4), frames, 3)
    agree(q, radius=40, sigma_time=5, sigma_angle=0.5, lookahead=30, iterations=2, boundary=boundary)


@pytest.mark.parametrize("boundary", ["nearest", "linear"])
@pytest.mark.parametrize("lookahead", [1, 4])
def test_one_pose_comes_back_with_length_one(lookahead, boundary):
    q = noisy(np.random.default_rng(5), 1, 3)
    stream = qf.BilateralStream(iterations=2, lookahead=lookahead, boundary=boundary)
    same_samples(streams.run(stream, 1.05 * q), q, tolerances.FLOAT64)


@pytest.mark.parametrize("sigma", [1e-300, 1e-20, 1e-6, 1e6])
@pytest.mark.parametrize("kernel", ["gaussian", "printed", "classic"])
def test_extreme_scales(kernel, sigma):
    q = noisy(np.random.default_rng(6), 60, 3)
    agree(q, sigma_angle=sigma, kernel=kernel, lookahead=2)
    agree(q, sigma_time=sigma, kernel=kernel, lookahead=2)


@pytest.mark.parametrize(("boundary", "lookahead"), [("nearest", 0), ("nearest", 3), ("linear", 3)])
@given(q=drawn.spoilt_clips(lengths=st.integers(2, 60), joints=st.sampled_from([1, 3, 9])))
def test_missing_samples_are_held(q, boundary, lookahead):
    options = {"iterations": 3, "boundary": boundary, "lookahead": lookahead}
    result = streams.run(qf.BilateralStream(**options), q)
    clip, _, since = streams.held(q)
    expected = whole(clip, **options)
    expected[~since] = np.nan
    same_samples(result, expected, tolerances.filtered(q.dtype))


@pytest.mark.parametrize("name", ["cmu/02/02_01.amc", "cmu/05/05_02.amc"])
@pytest.mark.parametrize("lookahead", [0, 4])
@pytest.mark.parametrize("dtype", DTYPES)
def test_real_motion(data_dir, name, lookahead, dtype):
    q = qf.read_motion(data_dir / name).rotations[:600]
    q = qf.add_gaussian_noise(q, sigma=0.02, rng=0).astype(dtype)
    agree(q, iterations=2, lookahead=lookahead)
