"""Non-local pose means of a stream against the reference's filter of the whole clip."""

import clips
import drawn
import nlpm
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


def noisy(rng, frames, joints, sigma=0.05, *, chart="local"):
    """A clip to filter; in the chart "identity" it starts there, away from a full turn."""
    clean = clips.smooth(rng, frames, joints, swing=2)
    if chart == "identity":
        clean = clips.product(clean[:1] * [1, -1, -1, -1], clean)
    return clips.flipped(rng, clips.noisy(rng, clean, sigma))


def whole(q, *, neighbors=None, confidence=None, **options):
    """The reference's filter of the clip."""
    defaults = {"search_radius": 10, "patch_radius": 5, "chart": "local", "lookahead": 0}
    neighbors = -1 if neighbors is None else neighbors
    chosen = defaults | options | {"neighbors": neighbors, "confidence": confidence}
    return nlpm.rotations(_reference, q, **chosen)


def agree(q, *, confidence=None, **options):
    before = q.tobytes()
    result = streams.run(qf.NonlocalPoseMeansStream(**options), q, confidence)
    assert q.tobytes() == before, "an input was written"
    expected = whole(q, confidence=confidence, **options)
    same_samples(result, expected, tolerances.filtered(q.dtype))
    return result


@given(
    seed=seeds,
    frames=st.integers(2, 60),
    joints=st.sampled_from([1, 2, 7, 8, 9, 31]),
    dtype=drawn.dtypes,
    chosen=st.fixed_dictionaries(
        {
            "search_radius": st.integers(1, 8),
            "patch_radius": st.integers(0, 4),
            "distance": st.sampled_from(["mean", "sum"]),
            "weights": st.sampled_from(["pose", "joint"]),
            "chart": st.sampled_from(["local", "identity"]),
            "boundary": st.sampled_from(["nearest", "linear"]),
        }
    ),
    bandwidth=st.sampled_from([0.02, 0.1, 1.0]),
    lookahead=st.floats(0, 1),
    trusted=st.booleans(),
)
def test_any_options(seed, frames, joints, dtype, chosen, bandwidth, lookahead, trusted):
    rng = np.random.default_rng(seed)
    least = 1 if chosen["boundary"] == "linear" else 0
    most = chosen["search_radius"] + chosen["patch_radius"]
    chosen["lookahead"] = round(least + lookahead * (most - least))
    chosen["bandwidth"] = bandwidth * rng.uniform(0.5, 2, joints)
    q = noisy(rng, frames, joints, chart=chosen["chart"]).astype(dtype)
    agree(q, confidence=clips.confidences(rng, frames, joints) if trusted else None, **chosen)


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("lookahead", [0, 3, 5, 10, 15])
@pytest.mark.parametrize("weights", ["pose", "joint"])
def test_default_windows(weights, lookahead, dtype):
    rng = np.random.default_rng(1)
    q = noisy(rng, 400, 31).astype(dtype)
    result = agree(q, bandwidth=0.05, weights=weights, lookahead=lookahead)
    assert clips.angles(result, q).max() > 0.01


@pytest.mark.parametrize("lookahead", [0, 4, 11])
@pytest.mark.parametrize("weights", ["pose", "joint"])
@pytest.mark.parametrize("neighbors", [1, 3, 1000])
def test_neighbors(neighbors, weights, lookahead):
    rng = np.random.default_rng(2)
    agree(noisy(rng, 200, 5), bandwidth=0.1, neighbors=neighbors, weights=weights, lookahead=lookahead)


def test_no_limit_at_the_longest_lookahead():
    q = noisy(np.random.default_rng(3), 80, 3)
    result = streams.run(
        qf.NonlocalPoseMeansStream(bandwidth=0.1, search_radius=4, patch_radius=2, lookahead=6), q
    )
    expected = whole(q, bandwidth=0.1, search_radius=4, patch_radius=2, lookahead=-1)
    same_samples(result, expected, tolerances.FLOAT64)


@pytest.mark.parametrize("boundary", ["nearest", "linear"])
@pytest.mark.parametrize("frames", [2, 3, 12])
def test_windows_longer_than_the_clip(frames, boundary):
    q = noisy(np.random.default_rng(4), frames, 3)
    agree(q, bandwidth=0.2, search_radius=40, patch_radius=30, lookahead=50, boundary=boundary)


@pytest.mark.parametrize("boundary", ["nearest", "linear"])
@pytest.mark.parametrize("lookahead", [1, 5, 12])
def test_one_pose_comes_back_with_length_one(lookahead, boundary):
    q = noisy(np.random.default_rng(5), 1, 3)
    stream = qf.NonlocalPoseMeansStream(bandwidth=0.2, lookahead=lookahead, boundary=boundary)
    same_samples(streams.run(stream, 1.05 * q), q, tolerances.FLOAT64)


@pytest.mark.parametrize("chart", ["local", "identity"])
@pytest.mark.parametrize(("boundary", "lookahead"), [("nearest", 0), ("nearest", 7), ("linear", 7)])
@given(q=drawn.spoilt_clips(lengths=st.integers(2, 60), joints=st.sampled_from([1, 3, 9])), seed=seeds)
def test_missing_samples_are_held_without_confidence(q, seed, boundary, lookahead, chart):
    trust = np.random.default_rng(seed).uniform(0.1, 1, q.shape[:2]).astype(q.dtype)
    options = {"bandwidth": 0.1, "boundary": boundary, "lookahead": lookahead, "chart": chart}
    result = streams.run(qf.NonlocalPoseMeansStream(**options), q, trust)
    clip, there, since = streams.held(q)
    expected = whole(clip, confidence=np.where(there, trust, 0), **options)
    expected[~since] = np.nan
    same_samples(result, expected, tolerances.filtered(q.dtype))


@pytest.mark.parametrize("name", ["cmu/02/02_01.amc", "cmu/05/05_02.amc"])
@pytest.mark.parametrize("lookahead", [0, 10])
@pytest.mark.parametrize("dtype", DTYPES)
def test_real_motion(data_dir, name, lookahead, dtype):
    q = qf.read_motion(data_dir / name).rotations[:600]
    q = qf.add_gaussian_noise(q, sigma=0.02, rng=0).astype(dtype)
    agree(q, bandwidth=0.02, lookahead=lookahead)
