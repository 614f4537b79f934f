"""What must hold for non-local pose means, whatever the clip."""

import clips
import nlpm
import numpy as np
import pytest
import tolerances
from hypothesis import given
from hypothesis import strategies as st
from nlpm import options

seeds = st.integers(0, 2**32 - 1)
charts = st.sampled_from(["mean", "identity", "local"])
equivariant_charts = st.sampled_from(["mean", "local"])
dtypes = st.sampled_from([np.float32, np.float64])


without_ties = options(neighbors=False)
"""Rounding decides between equally good candidates, so laws that move samples by a rounding leave the choice out."""


def sample(seed, frames=17, joints=3):
    """A noisy clip and the generator that made it."""
    rng = np.random.default_rng(seed)
    kind = rng.integers(3)
    if kind == 0:
        q = clips.smooth(rng, frames, joints, swing=2)
    elif kind == 1:
        q = clips.walk(rng, frames, joints)
    else:
        q = clips.turning(rng, frames, joints, turns=rng.uniform(0, 2))
    return clips.noisy(rng, q, 0.05), rng


def worst(a, b):
    return clips.angles(a, b).max()


@given(seed=seeds, chart=charts, chosen=without_ties, dtype=dtypes)
def test_signs_do_not_matter(backend, seed, chart, chosen, dtype):
    q, rng = sample(seed)
    q = q.astype(dtype)
    other = clips.flipped(rng, q).astype(dtype)
    result, flipped = (nlpm.rotations(backend, x, chart=chart, **chosen) for x in (q, other))
    sides = np.sign(np.sum(q[0] * other[0], axis=-1))[:, None]
    np.testing.assert_array_equal(result, flipped * sides)


@given(seed=seeds, chart=charts, chosen=options(), dtype=dtypes)
def test_output_is_unit_continuous_and_starts_in_the_hemisphere_of_the_input(
    backend, seed, chart, chosen, dtype
):
    q, rng = sample(seed)
    q = clips.flipped(rng, q).astype(dtype)
    result = nlpm.rotations(backend, q, chart=chart, **chosen)
    assert result.dtype == dtype
    np.testing.assert_allclose(np.linalg.norm(result, axis=-1), 1, atol=tolerances.algebra(dtype))
    assert (np.sum(result[1:] * result[:-1], axis=-1) >= 0).all()
    assert (np.sum(result[0] * q[0], axis=-1) >= 0).all()


@given(seed=seeds, chart=equivariant_charts, chosen=without_ties)
def test_constant_rotations_commute_with_the_filter(backend, seed, chart, chosen):
    q, rng = sample(seed)
    left, right = clips.random_rotations(rng, 2, q.shape[1])
    moved = clips.product(left, clips.product(q, right))
    result = nlpm.rotations(backend, q, chart=chart, **chosen)
    expected = clips.product(left, clips.product(result, right))
    assert worst(nlpm.rotations(backend, moved, chart=chart, **chosen), expected) < tolerances.FLOAT64


@given(seed=seeds, chart=equivariant_charts, chosen=options(neighbors=False, lookahead=False))
def test_time_reversal(backend, seed, chart, chosen):
    q, _ = sample(seed)
    result = nlpm.rotations(backend, q, chart=chart, **chosen)
    assert worst(nlpm.rotations(backend, q[::-1], chart=chart, **chosen)[::-1], result) < tolerances.FLOAT64


@given(seed=seeds, chart=charts, chosen=without_ties)
def test_the_order_of_the_joints_does_not_matter(backend, seed, chart, chosen):
    q, rng = sample(seed, joints=5)
    order = rng.permutation(5)
    confidence = clips.confidences(rng, *q.shape[:2])
    chosen = chosen | {"bandwidth": chosen["bandwidth"] * rng.uniform(0.5, 2, 5)}
    result = nlpm.rotations(backend, q, chart=chart, confidence=confidence, **chosen)
    chosen["bandwidth"] = chosen["bandwidth"][order]
    other = nlpm.rotations(backend, q[:, order], chart=chart, confidence=confidence[:, order], **chosen)
    assert worst(other, result[:, order]) < tolerances.FLOAT64


@given(seed=seeds, chart=charts, chosen=options(), dtype=dtypes, frames=st.integers(1, 9))
def test_a_constant_clip_is_a_fixed_point(backend, seed, chart, chosen, dtype, frames):
    rng = np.random.default_rng(seed)
    q = np.tile(clips.random_rotations(rng, 3), (frames, 1, 1)).astype(dtype)
    translation = np.tile(rng.standard_normal(3), (frames, 1)).astype(dtype)
    rotations, positions = backend.nonlocal_pose_means(
        *nlpm.arguments(q, translation=translation, chart=chart, **chosen)
    )
    assert worst(rotations, q) < tolerances.filtered(dtype)
    np.testing.assert_allclose(positions, translation, rtol=0, atol=tolerances.filtered(dtype))


@given(seed=seeds, chart=charts, chosen=options(), dtype=dtypes)
def test_a_tiny_bandwidth_is_the_identity(backend, seed, chart, chosen, dtype):
    q, _ = sample(seed)
    q = q.astype(dtype)
    chosen = chosen | {"bandwidth": 1e-4, "boundary": "linear"}
    assert worst(nlpm.rotations(backend, q, chart=chart, **chosen), q) < tolerances.filtered(dtype)


@given(seed=seeds, chart=st.sampled_from(["identity", "local"]), chosen=without_ties)
def test_samples_without_confidence_are_not_seen(backend, seed, chart, chosen):
    """With a boundary that copies frames; a linear one takes its velocity from the end frames all the same."""
    q, rng = sample(seed)
    chosen = chosen | {"boundary": "nearest"}
    confidence = np.ones(q.shape[:2])
    confidence[8, 1] = 0
    other = q.copy()
    other[8, 1] = clips.product(q[8, 1], clips.from_vectors(0.3 * rng.standard_normal(3)))
    result, changed = (
        nlpm.rotations(backend, x, chart=chart, confidence=confidence, **chosen) for x in (q, other)
    )
    elsewhere = np.ones(q.shape[:2], bool)
    elsewhere[8, 1] = False
    assert worst(changed[elsewhere], result[elsewhere]) < tolerances.FLOAT64


@given(seed=seeds, chosen=options(search_radius=(-1, 2, 4)), lookahead=st.integers(0, 6))
def test_frames_beyond_the_lookahead_do_not_matter(backend, seed, chosen, lookahead):
    q, rng = sample(seed)
    chosen = chosen | {"boundary": "nearest", "lookahead": lookahead}
    seen = 10
    other = q.copy()
    other[seen:] = clips.random_rotations(rng, *q[seen:].shape[:2])
    result, changed = (nlpm.rotations(backend, x, chart="local", **chosen) for x in (q, other))
    np.testing.assert_array_equal(changed[: seen - lookahead], result[: seen - lookahead])


@given(seed=seeds, chosen=options(search_radius=(0, 1, 3)))
def test_frames_beyond_window_and_patch_do_not_matter(backend, seed, chosen):
    q, rng = sample(seed)
    chosen = chosen | {"boundary": "nearest"}
    reach = chosen["search_radius"] + chosen["patch_radius"]
    other = q.copy()
    other[:3] = clips.random_rotations(rng, 3, q.shape[1])
    result, changed = (nlpm.rotations(backend, x, chart="local", **chosen) for x in (q, other))
    assert worst(changed[3 + reach :], result[3 + reach :]) < tolerances.FLOAT64


@given(seed=seeds, chart=charts, chosen=without_ties, radius=st.integers(0, 3))
def test_the_summed_distance_is_the_mean_with_a_smaller_bandwidth(backend, seed, chart, chosen, radius):
    q, _ = sample(seed)
    joints = q.shape[1] if chosen["weights"] == "pose" else 1
    terms = 3 * joints * (2 * radius + 1)
    chosen = chosen | {"patch_radius": radius, "lookahead": -1}
    averaged = nlpm.rotations(backend, q, chart=chart, **chosen | {"distance": "mean", "bandwidth": 0.1})
    wider = {"distance": "sum", "bandwidth": 0.1 * np.sqrt(terms)}
    assert worst(nlpm.rotations(backend, q, chart=chart, **chosen | wider), averaged) < tolerances.FLOAT64


@given(seed=seeds, chart=charts, chosen=options())
def test_of_one_joint_pose_weights_are_joint_weights(backend, seed, chart, chosen):
    q, _ = sample(seed, joints=1)
    pose, joint = (
        nlpm.rotations(backend, q, chart=chart, **chosen | {"weights": w}) for w in ("pose", "joint")
    )
    assert worst(pose, joint) < tolerances.FLOAT64


@given(seed=seeds, chart=charts, chosen=without_ties)
def test_full_confidence_is_no_confidence(backend, seed, chart, chosen):
    q, _ = sample(seed)
    without = nlpm.rotations(backend, q, chart=chart, **chosen)
    full = nlpm.rotations(backend, q, chart=chart, confidence=np.ones(q.shape[:2]), **chosen)
    assert worst(without, full) < tolerances.FLOAT64


@given(seed=seeds, chart=charts, chosen=without_ties)
def test_more_neighbors_than_candidates_are_all(backend, seed, chart, chosen):
    q, _ = sample(seed)
    every = nlpm.rotations(backend, q, chart=chart, **chosen)
    many = nlpm.rotations(backend, q, chart=chart, **chosen | {"neighbors": 100})
    assert worst(every, many) < tolerances.FLOAT64


@given(seed=seeds, chart=charts, chosen=without_ties)
def test_positions_move_and_scale_with_the_input(backend, seed, chart, chosen):
    q, rng = sample(seed)
    path, shift = clips.path(rng, len(q)), rng.standard_normal(3)
    result = nlpm.positions(backend, q, chart=chart, translation=path, **chosen)
    moved = nlpm.positions(backend, q, chart=chart, translation=3 * path + shift, **chosen)
    np.testing.assert_allclose(moved, 3 * result + shift, rtol=0, atol=10 * tolerances.FLOAT64)


@given(seed=seeds, chart=charts, chosen=options())
def test_positions_do_not_change_rotations_and_inputs_are_not_written(backend, seed, chart, chosen):
    q, rng = sample(seed)
    path, confidence = clips.path(rng, len(q)), clips.confidences(rng, *q.shape[:2])
    arguments = nlpm.arguments(q, chart=chart, translation=path, confidence=confidence, **chosen)
    before = [np.copy(x) for x in arguments[:4]]
    with_path, _ = backend.nonlocal_pose_means(*arguments)
    for was, now in zip(before, arguments, strict=False):
        np.testing.assert_array_equal(was, now)
    without, none = backend.nonlocal_pose_means(arguments[0], None, *arguments[2:])
    assert none is None
    np.testing.assert_array_equal(with_path, without)


@pytest.mark.parametrize("chart", ["mean", "identity", "local"])
@pytest.mark.parametrize("frames", [0, 1])
@pytest.mark.parametrize("search_radius", [-1, 3])
def test_shortest_clips_come_back(backend, chart, frames, search_radius):
    q = clips.flipped(np.random.default_rng(0), clips.random_rotations(np.random.default_rng(1), frames, 2))
    path = np.ones((frames, 3))
    arguments = nlpm.arguments(q, translation=path, chart=chart, search_radius=search_radius)
    rotations, positions = backend.nonlocal_pose_means(*arguments)
    np.testing.assert_allclose(rotations, q, rtol=0, atol=tolerances.ALGEBRA)
    np.testing.assert_array_equal(positions, path)


@pytest.mark.parametrize("chart", ["mean", "identity", "local"])
def test_it_removes_noise(backend, chart):
    """A third less error on a walk of four cycles, all of which look alike."""
    rng = np.random.default_rng(3)
    clean = clips.walk(rng, 480, 10)
    q = clips.noisy(rng, clean, 0.03)
    result = nlpm.rotations(
        backend, q, chart=chart, bandwidth=0.03, search_radius=-1, patch_radius=5, neighbors=24
    )
    before, after = (np.sqrt(np.mean(clips.angles(clean, x) ** 2)) for x in (q, result))
    assert after < 2 / 3 * before


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize(
    ("distance", "moves"), [(1, True), (80, True), (119, True), (121, False), (300, False)]
)
@pytest.mark.parametrize("neighbors", [-1, 1])
def test_an_untrusted_frame_follows_others_however_faint_down_to_one_limit(
    backend, dtype, distance, moves, neighbors
):
    """In a steady turn, seen with its past alone, frame 3 has one candidate, frame 2, at a known patch distance."""
    step = 0.25
    q = clips.from_vectors(step * np.arange(6)[:, None, None] * np.array([0.6, 0.8, 0])).astype(dtype)
    confidence = np.ones((6, 1))
    confidence[3] = 0
    chosen = {"search_radius": 1, "patch_radius": 1, "lookahead": 0, "distance": "sum", "chart": "local"}
    bandwidth = step / np.sqrt(2 * distance)
    result = nlpm.rotations(
        backend, q, confidence=confidence, bandwidth=bandwidth, neighbors=neighbors, **chosen
    )
    assert clips.angles(result[3], q[2] if moves else q[3]) < tolerances.filtered(dtype)


# ---- a library


def with_library(backend, q, library, **options):
    return nlpm.rotations(backend, q, library=library, **{"chart": "local", "neighbors": 5} | options)


def repeated(seed):
    """Return a walk, the same with noise, other takes of it, and a source of random numbers."""
    rng = np.random.default_rng(seed)
    whole = clips.walk(rng, 400, 2)
    return whole[:120], clips.noisy(rng, whole[:120], 0.2), [whole[120:260], whole[260:]], rng


@pytest.mark.parametrize("seed", range(3))
def test_clean_takes_of_the_same_motion_take_the_noise_away(backend, seed):
    rng = np.random.default_rng(seed)
    whole = clips.walk(rng, 400, 8)
    clean, noisy = whole[:120], clips.noisy(rng, whole[:120], 0.2)
    options = {"bandwidth": 0.2, "search_radius": 10, "patch_radius": 5}
    alone = nlpm.rotations(backend, noisy, **options)
    result = with_library(backend, noisy, [whole[120:260], whole[260:]], **options, neighbors=20)
    inside = slice(10, -10)
    assert clips.angles(result, clean)[inside].mean() < 0.4 * clips.angles(alone, clean)[inside].mean()


@pytest.mark.parametrize("seed", range(3))
def test_a_library_may_be_cut_and_ordered_and_signed_as_one_likes(backend, seed):
    _, noisy, library, rng = repeated(seed)
    expected = with_library(backend, noisy, library)
    for other in (library[::-1], [clips.flipped(rng, clip) for clip in library]):
        assert clips.angles(with_library(backend, noisy, other), expected).max() < tolerances.FLOAT64
    left, right = clips.random_rotations(rng, 2, 2)
    moved = [clips.product(clips.product(left, clip), right) for clip in (noisy, *library)]
    result = clips.product(clips.product(left, expected), right)
    assert clips.angles(with_library(backend, moved[0], moved[1:]), result).max() < tolerances.FLOAT64


@pytest.mark.parametrize("seed", range(3))
def test_what_is_missing_in_a_library_or_unlike_changes_nothing(backend, seed):
    _, noisy, library, _ = repeated(seed)
    expected = with_library(backend, noisy, library)
    gone = np.full((30, 2, 4), np.nan)
    far = clips.product(noisy[:40], clips.from_vectors(np.array([3.0, 0, 0])))
    for more in ([gone, *library], [*library, far]):
        assert clips.angles(with_library(backend, noisy, more), expected).max() < tolerances.FLOAT64
    alone = nlpm.rotations(backend, noisy, chart="local", neighbors=5)
    assert clips.angles(with_library(backend, noisy, [gone]), alone).max() < tolerances.FLOAT64
    tiny = with_library(backend, noisy, library, bandwidth=1e-6)
    assert clips.angles(tiny, noisy).max() < tolerances.FLOAT64


@pytest.mark.parametrize("seed", range(3))
def test_a_library_weighs_nothing_in_the_translation(backend, seed):
    clean, _, _, rng = repeated(seed)
    path = clips.path(rng, 120)
    options = {"chart": "local", "translation": path, "neighbors": 300, "bandwidth": 0.5}
    alone = nlpm.positions(backend, clean, **options)
    far = [clips.product(clean[:40], clips.from_vectors(np.array([0.9, 0, 0])))]
    # Its weights are smaller than those of neighbours in time: the frame's own stays what it was.
    np.testing.assert_allclose(
        nlpm.positions(backend, clean, **options, library=far), alone, rtol=0, atol=tolerances.FLOAT64
    )
