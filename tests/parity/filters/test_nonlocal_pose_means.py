"""Non-local pose means: the core against the reference."""

import clips
import drawn
import nlpm
import numpy as np
import pytest
import quatfilt as qf
import tolerances
from drawn import same_samples, seeds
from hypothesis import given
from hypothesis import strategies as st
from layouts import LAYOUTS
from plugins.properties import examples
from quatfilt import _core, _reference
from quatfilt._reference.filters.nonlocal_pose_means.candidates import (
    Comparison,
    frames_with_candidate,
    library_distances,
    patch_distances,
)
from quatfilt._reference.filters.nonlocal_pose_means.nonlocal_pose_means import causal_window, extend
from quatfilt._reference.search.patch_neighbors import extended

DTYPES = [np.float32, np.float64]
CHARTS = ["mean", "identity", "local"]
BOUNDARIES = ["nearest", "mirror", "linear"]

CLOSE = {np.dtype(np.float32): 1e-3, np.dtype(np.float64): 1e-9}
"""Relative difference of patch distances that rounding may explain: the vectors that they compare are a hundred times
longer than the differences between them."""

MOSTLY_CLEAR = 0.2
"""Share of samples whose last neighbour may tie with the next: float32, and frames that ends repeat."""


def clear(q, options):
    """Tell where rounding does not decide which candidate is the last of the neighbours, ``(frames, joints)``."""
    chosen = nlpm.DEFAULTS | options
    count, joint_wise = chosen["neighbors"], chosen["weights"] == "joint"
    everywhere = np.ones(q.shape[:2], bool)
    if count < 0 or len(q) < 2:
        return everywhere
    window, patch = chosen["search_radius"], chosen["patch_radius"]
    lags, future = causal_window(len(q), window, patch, chosen["lookahead"])
    bandwidth = np.broadcast_to(chosen["bandwidth"], q.shape[1]).astype(np.float64)
    how = Comparison(lags, window < 0, patch, future, bandwidth, chosen["distance"] == "mean", joint_wise)
    clip = extend(q, None, chosen["confidence"], max(window, 0) + patch, chosen["boundary"], chosen["chart"])
    library = chosen["library"]
    more = sum(map(len, library)) if library else 0
    distances = np.full((len(lags) + more + count + 1, len(q), q.shape[1] if joint_wise else 1), np.inf)
    for row, lag in zip(distances, lags, strict=False):
        row[frames_with_candidate(clip, how, lag)] = patch_distances(clip, how, lag)
    for t in range(len(q) if library else 0):
        others = extended([part.astype(q.dtype) for part in library], patch)
        distances[len(lags) : len(lags) + more, t] = library_distances(clip, how, others, t)
    last, following = np.sort(distances, axis=0)[count - 1 : count + 1]
    with np.errstate(invalid="ignore"):
        return everywhere & ((last == np.inf) | (following - last > CLOSE[q.dtype] * following))


def agree(q, **options):
    """Compare rotations and positions, and return where the answer is clear."""
    arguments = nlpm.arguments(q, **options)
    before = [x.tobytes() for x in arguments[:4] if x is not None]
    (result, moved), (expected, path) = (
        backend.nonlocal_pose_means(*arguments) for backend in (_core, _reference)
    )
    assert [x.tobytes() for x in arguments[:4] if x is not None] == before, "an input was written"
    assert result.dtype == expected.dtype == q.dtype
    assert result.shape == expected.shape == q.shape
    sure = clear(q, options)
    tolerance = tolerances.filtered(q.dtype)
    if sure.all():
        same_samples(result, expected, tolerance)
    elif sure.any():
        # A neighbour that is replaced may turn the signs of all later frames.
        assert clips.angles(expected[sure], result[sure]).max() <= tolerance
    if path is None:
        assert moved is None
    elif q.shape[1]:
        assert moved.dtype == path.dtype
        np.testing.assert_allclose(moved[sure[:, 0]], path[sure[:, 0]], rtol=0, atol=tolerance)
    return sure


def noisy(rng, frames, joints, sigma=0.05, *, turns=None, chart=None):
    """A clip to filter; with `turns`, one whose root turns so often.

    In the chart "identity" it starts there: near a full turn away, roundings grow without limit.
    """
    clean = clips.smooth(rng, frames, joints, swing=2)
    if turns is not None:
        clean = clips.turning(rng, frames, joints, turns=turns)
    if chart == "identity":
        clean = clips.product(clean[:1] * [1, -1, -1, -1], clean)
    return clips.flipped(rng, clips.noisy(rng, clean, sigma))


@given(
    seed=seeds,
    frames=st.one_of(st.integers(0, 5), st.integers(6, 90)),
    joints=st.sampled_from([1, 2, 3, 8, 17, 40]),
    dtype=drawn.dtypes,
    chart=st.sampled_from(CHARTS),
    chosen=nlpm.options(),
    extras=st.sampled_from(["", "confidence", "translation", "both"]),
    turns=st.one_of(st.none(), st.floats(0, 6)),
)
def test_any_options(seed, frames, joints, dtype, chart, chosen, extras, turns):
    rng = np.random.default_rng(seed)
    turns = turns if chart != "identity" else None
    q = noisy(rng, frames, joints, turns=turns, chart=chart).astype(dtype)
    if extras in ("confidence", "both"):
        chosen = chosen | {"confidence": clips.confidences(rng, frames, joints)}
    if extras in ("translation", "both"):
        chosen = chosen | {"translation": clips.path(rng, frames)}
    chosen["bandwidth"] = chosen["bandwidth"] * rng.uniform(0.5, 2, joints)
    agree(q, chart=chart, **chosen)


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize(
    ("joints", "lengths"), [(1, [2047, 2048, 2049]), (31, [319, 321, 575, 576, 577, 1153])]
)
@pytest.mark.parametrize("chart", CHARTS)
def test_around_the_ends_of_tiles(chart, joints, lengths, dtype):
    for frames in lengths:
        rng = np.random.default_rng(frames)
        q = noisy(rng, frames, joints, chart=chart).astype(dtype)
        agree(q, chart=chart, search_radius=7, patch_radius=3, translation=clips.path(rng, frames))


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("boundary", BOUNDARIES)
@pytest.mark.parametrize("weights", ["pose", "joint"])
def test_a_long_clip(weights, boundary, dtype):
    rng = np.random.default_rng(5)
    q = noisy(rng, 5000, 31).astype(dtype)
    agree(q, search_radius=10, patch_radius=5, weights=weights, boundary=boundary)


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("weights", ["pose", "joint"])
def test_neighbors_of_a_long_clip(weights, dtype):
    rng = np.random.default_rng(6)
    q = noisy(rng, 1500, 12).astype(dtype)
    sure = agree(q, search_radius=20, neighbors=7, weights=weights, translation=clips.path(rng, 1500))
    assert sure.mean() > 1 - MOSTLY_CLEAR


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("neighbors", [-1, 16])
@pytest.mark.parametrize("chart", CHARTS)
def test_the_whole_clip(chart, neighbors, dtype):
    rng = np.random.default_rng(7)
    q = noisy(rng, 450, 5, chart=chart).astype(dtype)
    sure = agree(q, chart=chart, search_radius=-1, patch_radius=5, neighbors=neighbors, bandwidth=0.2)
    assert sure.mean() > 1 - MOSTLY_CLEAR


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize(
    ("chart", "turns"),
    [("identity", 0.7), *((c, t) for c in ("mean", "local") for t in (0.7, 0.9, 1.3, 5.0))],
)
def test_turning_roots(chart, turns, dtype):
    rng = np.random.default_rng(8)
    q = noisy(rng, 900, 4, turns=turns, chart=chart).astype(dtype)
    agree(q, chart=chart, search_radius=10, patch_radius=5, boundary="linear")


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("boundary", BOUNDARIES)
@pytest.mark.parametrize("frames", [2, 3, 12])
def test_windows_longer_than_the_clip(frames, boundary, dtype):
    rng = np.random.default_rng(9)
    for chart in CHARTS:
        q = noisy(rng, frames, 3, chart=chart).astype(dtype)
        agree(q, chart=chart, boundary=boundary, search_radius=100, patch_radius=60, bandwidth=0.2)


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("sigma", [1e-4, 0.008, 1.2])
def test_little_and_much_noise(sigma, dtype):
    """As filters are used: the bandwidth is the noise."""
    rng = np.random.default_rng(10)
    agree(noisy(rng, 700, 31, sigma).astype(dtype), bandwidth=sigma, search_radius=10, patch_radius=5)


def with_both(q, **options):
    """Compare what the public function returns with either backend."""
    result = qf.nonlocal_pose_means(q, **options)
    with qf.use_backend("numpy"):
        expected = qf.nonlocal_pose_means(q, **options)
    same_samples(result, expected, tolerances.filtered(result.dtype))
    return result


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("layout", LAYOUTS)
def test_layouts(layout, dtype):
    plain = noisy(np.random.default_rng(11), 80, 3).astype(dtype)
    q = LAYOUTS[layout](plain)
    before = q.tobytes()
    result = with_both(q, chart="local")
    assert result.dtype == dtype
    assert result.dtype.isnative
    assert q.tobytes() == before, "the input was written"
    np.testing.assert_array_equal(result, qf.nonlocal_pose_means(plain, chart="local"))


@given(
    q=drawn.spoilt_clips(lengths=st.integers(0, 60), joints=st.sampled_from([1, 3, 5])),
    gaps=st.sampled_from(["fill", "keep"]),
    max_gap=st.sampled_from([None, 0, 1, 3, 1000]),
    chart=st.sampled_from(CHARTS),
    weights=st.sampled_from(["pose", "joint"]),
    bandwidth=st.sampled_from(["auto", 0.1]),
)
def test_missing_samples(q, gaps, max_gap, chart, weights, bandwidth):
    with_both(q, gaps=gaps, max_gap=max_gap, chart=chart, weights=weights, bandwidth=bandwidth)


@given(
    q=drawn.spoilt_clips(lengths=st.integers(0, 60), joints=st.sampled_from([1, 3]), missing=st.just(0.1)),
    seed=seeds,
)
def test_missing_samples_and_confidence(q, seed):
    confidence = clips.confidences(np.random.default_rng(seed), *q.shape[:2])
    with_both(q, confidence=confidence, bandwidth=0.1, lookahead=2)


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("boundary", ["nearest", "mirror"])
def test_equal_patches_without_noise(boundary, dtype):
    """A frame without confidence is averaged over the equal patches around it, however far below a rounding the bandwidth is."""
    rng = np.random.default_rng(13)
    q = noisy(rng, 3, 200).astype(dtype)
    confidence = np.ones(q.shape[:2])
    confidence[1] = 0
    agree(q, confidence=confidence, bandwidth=1e-9, chart="local", weights="joint", boundary=boundary)


@examples(25)
@given(
    seed=seeds,
    dtype=st.sampled_from(DTYPES),
    options=nlpm.options(neighbors=False),
    count=st.sampled_from([1, 3, 40]),
)
def test_a_library(seed, dtype, options, count):
    rng = np.random.default_rng(seed)
    q = clips.noisy(rng, clips.smooth(rng, 100, 2), 0.05)
    library = [clips.noisy(rng, q[10:60], 0.05), q[50:51], clips.smooth(rng, 30, 2)]
    confidence = clips.confidences(rng, 70, 2) if rng.random() < 0.5 else None
    if rng.random() < 0.5:
        drawn.spoil(rng, library[0], 0.2)
    library = [library, [q[:0]], [q[:0], *library]][rng.integers(3)]
    agree(
        q[:70].astype(dtype),
        **options | {"neighbors": count, "chart": "local"},
        library=library,
        confidence=confidence,
        translation=clips.path(rng, 70),
    )


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("weights", ["pose", "joint"])
def test_the_whole_clip_and_a_library_with_much_to_pass_over(dtype, weights):
    rng = np.random.default_rng(5)
    q = clips.noisy(rng, clips.walk(rng, 700, 2), 0.02).astype(dtype)
    options = {"neighbors": 6, "search_radius": -1, "weights": weights, "bandwidth": 0.1}
    agree(q[:400], **options)
    agree(q[:400], **options, boundary="mirror", lookahead=20)
    agree(q[:400], **options, chart="local", library=[q[400:], q[:90]])
