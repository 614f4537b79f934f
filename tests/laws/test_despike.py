"""What must hold for the search for spikes, whatever the clip."""

import clips
import numpy as np
import pytest
import quatfilt as qf
import tolerances
from drawn import dtypes, seeds
from hypothesis import given
from hypothesis import strategies as st
from plugins.properties import examples
from quatfilt.evaluation.clips import load, thinned
from quatfilt.filters import despike

RADIUS = 3
SMALLEST = 0.1
FRAMES = 60
REACH = 3 * RADIUS
"""Frames among which a run looks for neighbours, and for runs to be compared with."""

AXIS = np.array([2.0, -1, 2]) / 3


slow = examples(6)
"""The reference looks at each run by itself."""


def found_in(backend, x, *, confidence=None, radius=RADIUS, threshold=4.0, smallest=SMALLEST, longest=0):
    noise = np.asarray(backend.noise_level(x), np.float64)
    limits = np.full(x.shape[1], float(smallest))
    return backend.find_spikes(x, confidence, noise, limits, radius, threshold, longest)


def about_axis(angles):
    """Return a joint that turns about one axis by `angles` ``(frames,)``."""
    return clips.from_vectors(np.asarray(angles, float)[:, None, None] * AXIS)


def turned(q, frames, joint, vector):
    """Return `q` with one joint turned away in some frames."""
    other = q.copy()
    other[frames, joint] = clips.product(q[frames, joint], clips.from_vectors(np.asarray(vector)))
    return other


def spoilt(rng, q, share):
    """Return a clip with spikes of 10° to 60°, and where they are."""
    hit = rng.random(q.shape[:2]) < share
    vectors = rng.standard_normal((hit.sum(), 3))
    vectors *= rng.uniform(0.17, 1.05, (len(vectors), 1)) / np.linalg.norm(vectors, axis=1, keepdims=True)
    other = q.copy()
    other[hit] = clips.product(q[hit], clips.from_vectors(vectors))
    return other, hit


def sample(seed, share=0.02):
    rng = np.random.default_rng(seed)
    q = clips.noisy(rng, clips.smooth(rng, FRAMES, 3), 0.002)
    return *spoilt(rng, q, share), rng


# ---- what is a spike


@pytest.mark.parametrize("noise", [0, 0.002])
@pytest.mark.parametrize("size", [0.15, 0.5, 1.8, 3.1])
@pytest.mark.parametrize(("radius", "length"), [(2, 1), (3, 1), (3, 2), (6, 1), (6, 5)])
def test_runs_shorter_than_the_radius(backend, radius, length, size, noise):
    """Wherever they point, and however fast the joint moves, which here is up to 4 degrees in a frame."""
    rng = np.random.default_rng(length)
    clean = clips.noisy(rng, about_axis(0.9 * np.sin(np.arange(FRAMES) / 13)), noise)
    for start in (1, 17, 30, FRAMES - 1 - length):
        away = np.cross(AXIS, rng.standard_normal(3))
        q = turned(clean, slice(start, start + length), 0, size * away / np.linalg.norm(away))
        found = found_in(backend, q, radius=radius)
        np.testing.assert_array_equal(np.flatnonzero(found), np.arange(start, start + length))


def test_spikes_do_not_hide_each_other(backend):
    rng = np.random.default_rng(1)
    clean = clips.noisy(rng, about_axis(0.5 * np.sin(np.arange(FRAMES) / 9)), 0.001)
    for frames in ([20, 22], [20, 21], [20, 23, 25], [20, 22, 24], [20, 21, 24, 26, 27]):
        q = clean
        for i, frame in enumerate(frames):
            vector = np.array([[0.7, 0, 0], [0, -0.4, 0], [0, 0.9, 0.2]][i % 3])
            q = turned(q, frame, 0, vector)
        np.testing.assert_array_equal(np.flatnonzero(found_in(backend, q)), frames)


# ---- what is none

TIME = np.arange(FRAMES) - 30
MOTIONS = {
    "rest": 0.0 * TIME,
    "step": np.where(TIME < 0, 0.0, 2.5),
    "steps": 1.2 * (TIME // 3 % 2),
    "fast swing": 2.5 * np.sin(TIME / 4),
    "onset": 0.3 * np.maximum(TIME, 0),
    "end": -0.3 * np.maximum(-TIME, 0),
    "impact": 0.3 * np.abs(TIME),
    "impact between frames": 0.3 * np.abs(TIME + 0.4),
    "impact that rings": np.where(TIME < 0, -0.3 * TIME, 0.4 * np.exp(-TIME / 4) * np.sin(TIME)),
    "burst": 1.5 * np.exp(-((TIME / 3.0) ** 2)),
    "frozen frame": 0.2 * np.where(TIME == 0, -1, TIME),
    "repeated frames": 0.2 * (TIME // 2 * 2),
    "there for as long as the radius": np.where((TIME >= 0) & (TIME < RADIUS), 1.0, 0.0),
    "one frame at the start": np.where(np.arange(FRAMES) == 0, 1.0, 0.0),
    "one frame at the end": np.where(np.arange(FRAMES) == FRAMES - 1, 1.0, 0.0),
}


@pytest.mark.parametrize("noise", [0, 0.002, 0.02])
@pytest.mark.parametrize("name", MOTIONS)
def test_motion_is_no_spike(backend, name, noise):
    rng = np.random.default_rng(2)
    q = clips.noisy(rng, about_axis(MOTIONS[name]), noise)
    assert not found_in(backend, q).any()


@pytest.mark.parametrize("sigma", [0.001, 0.016, 0.08, 0.24, 0.48])
def test_noise_of_any_level_is_no_spike(backend, sigma):
    rng = np.random.default_rng(3)
    q = clips.noisy(rng, clips.smooth(rng, 400, 3), sigma)
    assert found_in(backend, q, smallest=0).sum() == 0


def test_ten_times_as_far_as_noise_is_a_spike(backend):
    rng = np.random.default_rng(4)
    q = clips.noisy(rng, clips.smooth(rng, 200, 1), 0.03)
    assert found_in(backend, turned(q, 90, 0, [0.3, 0, 0]))[:, 0].nonzero()[0].tolist() == [90]
    assert not found_in(backend, turned(q, 90, 0, [0.3, 0, 0]), threshold=12.0).any()


def test_spikes_are_larger_than_the_smallest(backend):
    q = turned(about_axis(0.01 * TIME), 20, 0, [0.2, 0, 0])
    assert found_in(backend, q, smallest=0.19).sum() == 1
    assert found_in(backend, q, smallest=0.21).sum() == 0


# ---- bursts

LONGEST = 11
LONG = np.arange(110)
"""Frames of clips that bursts lie in."""


def calm_clip(rng, noise=0.002):
    """Return one joint that swings by 30 degrees, at most 2 degrees in a frame."""
    return clips.noisy(rng, about_axis(0.5 * np.sin(LONG / 14)), noise)


@pytest.mark.parametrize("noise", [0, 0.01])
@pytest.mark.parametrize("length", [3, 8, LONGEST])
def test_displaced_runs_are_bursts(backend, length, noise):
    rng = np.random.default_rng(length)
    clean = calm_clip(rng, noise)
    q = turned(clean, slice(60, 60 + length), 0, [0.3, 0.5, -0.4])
    found = found_in(backend, q, longest=LONGEST)
    np.testing.assert_array_equal(np.flatnonzero(found), np.arange(60, 60 + length))
    assert not found_in(backend, q, longest=length - 1).any()


def test_a_burst_beside_another_is_found_once_the_shorter_one_is(backend):
    clean = calm_clip(np.random.default_rng(10))
    q = turned(clean, slice(60, 64), 0, [0.6, 0, 0])
    q = turned(q, slice(70, 80), 0, [0, 0.6, 0])
    expected = [*range(60, 64), *range(70, 80)]
    assert np.flatnonzero(found_in(backend, q, longest=LONGEST)).tolist() == expected


QUICK = {
    "claps at 4 Hz, 30 fps": 1.0 * np.sin(2 * np.pi * 4 * LONG / 30 + 0.3),
    "claps at 4 Hz, 60 fps": 1.0 * np.sin(2 * np.pi * 4 * LONG / 60 + 0.3),
    "claps at 4 Hz, 120 fps": 1.5 * np.sin(2 * np.pi * 4 * LONG / 120 + 0.3),
    "kick and back, 30 fps": 1.8 * np.exp(-(((LONG - 60) / 2.5) ** 2)),
    "kick that is held": 0.75 * (np.tanh((LONG - 50) / 1.5) - np.tanh((LONG - 60) / 1.5)),
    "states that take turns": 0.9 * (LONG // 7 % 2),
    "held frames": 1.5 * np.sin(LONG // 5 * 5 / 12),
    "held frames, irregular": 1.5 * np.sin(np.maximum.accumulate(LONG * (LONG % 13 % 5 == 0)) / 12),
    "teleports between held poses": np.repeat(np.array([0, 1, 0.1, 2, 1.1]), 22),
    "step": np.where(LONG < 50, 0.0, 1.2),
}


@pytest.mark.parametrize("name", QUICK)
def test_quick_motion_and_held_frames_are_no_bursts(backend, name):
    q = about_axis(QUICK[name])
    if "held" not in name:
        q = clips.noisy(np.random.default_rng(11), q, 0.002)
    # A radius of 2 leaves runs of two samples to the search for bursts too.
    assert not found_in(backend, q, radius=2, longest=45).any()


@slow
@given(seed=seeds)
def test_bursts_in_any_frame_sign_and_direction_of_time(backend, seed):
    rng = np.random.default_rng(seed)
    q = turned(calm_clip(rng), slice(50, 57), 0, [0.3, 0.5, -0.4])
    found = found_in(backend, q, longest=LONGEST)
    assert found.sum() == 7
    a, b = clips.random_rotations(rng, 2)
    moved = clips.flipped(rng, clips.product(a, clips.product(q, b)))
    np.testing.assert_array_equal(found, found_in(backend, moved, longest=LONGEST))
    backwards = found_in(backend, np.ascontiguousarray(q[::-1]), longest=LONGEST)
    np.testing.assert_array_equal(found, backwards[::-1])


# ---- swaps


def legs(rng, noise=0.002):
    """Return four joints: two legs that swing against each other, and a knee of each."""
    swing = 0.6 * np.sin(LONG / 7)
    angles = np.stack([swing, -swing, 0.8 + 0.3 * swing, 0.2 - 0.3 * swing], axis=1)
    return clips.noisy(rng, clips.from_vectors(angles[..., None] * AXIS), noise)


def swaps_in(backend, q, *, confidence=None, longest=LONGEST):
    noise, smallest = np.full(q.shape[1], 0.002), np.full(q.shape[1], SMALLEST)
    return backend.find_swaps(q, confidence, noise, smallest, 4.0, longest).tolist()


@pytest.mark.parametrize("length", [1, 3, 7, LONGEST])
def test_joints_that_change_places(backend, length):
    clean = legs(np.random.default_rng(12))
    q = clean.copy()
    q[50 : 50 + length] = q[50 : 50 + length, [1, 0, 3, 2]]
    end = 50 + length
    assert swaps_in(backend, q) == [[0, 1, 50, end], [2, 3, 50, end]]
    assert swaps_in(backend, clean) == []
    assert swaps_in(backend, q, longest=length - 1) == []
    trust = np.ones(q.shape[:2])
    trust[49, 0] = 0
    assert swaps_in(backend, q, confidence=trust) == [[2, 3, 50, end]]
    backwards = swaps_in(backend, np.ascontiguousarray(q[::-1]))
    assert backwards == [[0, 1, 110 - end, 60], [2, 3, 110 - end, 60]]


def test_joints_that_change_places_for_good_are_left(backend):
    q = legs(np.random.default_rng(13))
    q[50:] = q[50:, [1, 0, 3, 2]]
    assert swaps_in(backend, q) == []


@pytest.mark.usefixtures("backend")
def test_swapped_joints_get_back_what_is_theirs():
    clean = legs(np.random.default_rng(14))
    q = clean.copy()
    q[50:57] = q[50:57, [1, 0, 3, 2]]
    q[53, 1] = np.nan
    result = qf.despike(q, fps=30)
    expected = clean.copy()
    expected[53, 0] = np.nan
    np.testing.assert_array_equal(np.abs(result), np.abs(qf.despike(expected, fps=30)))
    found = despike.spikes(q, fps=30)
    assert found[50:57].all()
    assert found.sum() == 4 * 7
    assert not despike.spikes(q, fps=30, duration=0).any()


@pytest.mark.usefixtures("backend")
def test_without_a_frame_rate_there_are_no_bursts():
    q = turned(calm_clip(np.random.default_rng(15)), slice(50, 57), 0, [0.3, 0.5, -0.4])
    assert not despike.spikes(q).any()
    assert despike.spikes(q, duration=8).sum() == 7
    assert despike.spikes(q, fps=30).sum() == 7
    assert not despike.spikes(q, fps=30, duration=0.2).any()


@pytest.mark.parametrize(("fps", "radius"), [(1, 3), (24, 3), (30, 3), (60, 5), (120, 10), (240, 19)])
def test_the_radius_follows_the_frame_rate(fps, radius):
    rng = np.random.default_rng(17)
    q = turned(clips.noisy(rng, clips.smooth(rng, 120, 2), 0.01), slice(60, 64), 0, [0.3, 0.5, -0.4])
    auto, same = (qf.despike(q, radius=r, fps=fps) for r in ("auto", radius))
    np.testing.assert_array_equal(auto, same)


def test_bursts_that_lie_close_together_are_no_motion():
    rng = np.random.default_rng(18)
    clean = clips.noisy(rng, about_axis(0.25 * np.sin(np.arange(240) / 30)), 0.01)
    q = turned(turned(clean, slice(60, 65), 0, [0.6, 0, 0]), slice(70, 77), 0, [0, 0.6, 0])
    found = despike.spikes(q, radius="auto", fps=120)[:, 0]
    assert np.flatnonzero(found).tolist() == [*range(60, 65), *range(70, 77)]


def test_quick_limbs_stay(data_dir):
    """Kicks, a run and boxing at 30 frames per second, and claps at 4 Hz: nothing is replaced."""
    names = dict.fromkeys(("86_01", "09_01", "14_13", "14_32"), "")
    claps = about_axis(1.0 * np.sin(2 * np.pi * 4 * LONG / 30 + 0.3))
    for q in (*(thinned(clip, 4).steady_rotations for clip in load(data_dir, names, longest=2400)), claps):
        result = qf.despike(q, radius="auto", fps=30)
        assert clips.angles(result, q).max() < np.radians(3)


@pytest.mark.usefixtures("backend")
def test_lengths_become_1():
    q = calm_clip(np.random.default_rng(16))
    result = qf.despike(1.05 * q, fps=30)
    assert np.abs(np.linalg.norm(result, axis=-1) - 1).max() < tolerances.ALGEBRA
    assert clips.angles(result, q).max() < tolerances.ALGEBRA


# ---- symmetries


@slow
@given(seed=seeds)
def test_constant_rotations_on_either_side_and_signs_do_not_matter(backend, seed):
    q, _, rng = sample(seed)
    a, b = clips.random_rotations(rng, 2)
    moved = clips.flipped(rng, clips.product(a, clips.product(q, b)))
    np.testing.assert_array_equal(found_in(backend, q), found_in(backend, moved))


@slow
@given(seed=seeds)
def test_time_may_run_backwards(backend, seed):
    q, _, _ = sample(seed)
    backwards = found_in(backend, np.ascontiguousarray(q[::-1]))
    np.testing.assert_array_equal(found_in(backend, q), backwards[::-1])


@slow
@given(seed=seeds)
def test_joints_do_not_matter_to_each_other(backend, seed):
    q, _, _ = sample(seed)
    alone = [found_in(backend, np.ascontiguousarray(q[:, [joint]])) for joint in range(q.shape[1])]
    np.testing.assert_array_equal(found_in(backend, q), np.concatenate(alone, axis=1))


@slow
@given(seed=seeds, dtype=dtypes)
def test_most_spikes_are_found_and_little_else(backend, seed, dtype):
    q, hit, _ = sample(seed)
    found = found_in(backend, q.astype(dtype))
    assert (found & ~hit).sum() <= 1
    # Not those at the ends, of three in a row, and of a clip in which many come together.
    assert (hit & ~found).sum() <= 1 + 0.5 * hit.sum()


def test_what_is_far_away_does_not_matter(backend):
    q, _, rng = sample(5, share=0.05)
    looks = 3
    far = 30 + looks * 3 * REACH
    noise, smallest = np.full(3, 0.002), np.full(3, SMALLEST)
    long = np.concatenate([q, clips.noisy(rng, np.repeat(q[-1:], far, axis=0), 0.002)])
    other = long.copy()
    other[far:] = clips.random_rotations(rng, len(long) - far, 3)
    first, second = (
        backend.find_spikes(x, None, noise, smallest, RADIUS, 4.0, 0)[:30] for x in (long, other)
    )
    assert first.any()
    np.testing.assert_array_equal(first, second)


# ---- confidence


@slow
@given(seed=seeds)
def test_full_confidence_is_none(backend, seed):
    q, _, _ = sample(seed)
    np.testing.assert_array_equal(found_in(backend, q), found_in(backend, q, confidence=np.ones(q.shape[:2])))


@slow
@given(seed=seeds)
def test_samples_without_confidence_do_not_matter(backend, seed):
    q, _, rng = sample(seed)
    trust = np.where(rng.random(q.shape[:2]) < 0.1, 0.0, 1.0)
    other = np.where(trust[..., None] == 0, clips.random_rotations(rng, *q.shape[:2]), q)
    noise, smallest = np.full(3, 0.002), np.full(3, SMALLEST)
    first, second = (
        backend.find_spikes(x, trust, noise, smallest, RADIUS, 4.0, 0)
        for x in (q, np.ascontiguousarray(other))
    )
    np.testing.assert_array_equal(first, second)
    assert not first[trust == 0].any()


def test_little_confidence_takes_off_the_threshold(backend):
    rng = np.random.default_rng(6)
    q = turned(clips.noisy(rng, clips.smooth(rng, 200, 1), 0.03), 90, 0, [0.3, 0, 0])
    trust = np.ones((200, 1))
    assert not found_in(backend, q, threshold=12.0, confidence=trust).any()
    trust[90] = 0.3
    assert found_in(backend, q, threshold=12.0, confidence=trust).nonzero()[0].tolist() == [90]


# ---- positions


@slow
@given(seed=seeds, scale=st.sampled_from([1e-3, 1.0, 2.54, 1e4]))
def test_positions_in_any_unit(backend, seed, scale):
    rng = np.random.default_rng(seed)
    path = np.cumsum(clips.path(rng, FRAMES), axis=0)[:, None]
    hit = [12, 30, 31, 45]
    path[hit] += 40 * rng.uniform(0.5, 1, (4, 1, 3))
    found = found_in(backend, scale * path, smallest=0)
    np.testing.assert_array_equal(found, found_in(backend, path, smallest=0))
    assert found[hit].all()


def test_positions_and_small_rotations_are_judged_alike(backend):
    rng = np.random.default_rng(7)
    vectors = 1e-4 * (np.cumsum(clips.path(rng, FRAMES), axis=0) + 0.05 * rng.standard_normal((FRAMES, 3)))
    vectors[[9, 25, 26, 44]] += 1e-3
    vectors = vectors[:, None]
    found = found_in(backend, vectors, smallest=0)
    assert found.any()
    np.testing.assert_array_equal(found, found_in(backend, clips.from_vectors(vectors), smallest=0))


# ---- what becomes of them


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.usefixtures("backend")
def test_nothing_else_is_touched(dtype):
    q, _, rng = sample(8, share=0.05)
    q = clips.flipped(rng, q).astype(dtype)
    found = despike.spikes(q)
    assert 0.02 < found.mean() < 0.1
    result = qf.despike(q)
    np.testing.assert_array_equal(np.abs(result[~found]), np.abs(q[~found]))
    np.testing.assert_array_equal(result, qf.continuous(result))
    assert (clips.angles(result, q)[found] > SMALLEST / 2).all()


@pytest.mark.usefixtures("backend")
def test_spikes_are_replaced_along_geodesics():
    clean = about_axis(0.05 * TIME)
    for frames in (slice(30, 31), slice(30, 32)):
        result = qf.despike(turned(clean, frames, 0, [0.9, 0, 0]))
        assert clips.angles(result, clean).max() < tolerances.ALGEBRA


@pytest.mark.usefixtures("backend")
def test_gaps_beside_spikes_are_filled_from_good_samples():
    clean = about_axis(0.05 * TIME)
    q = turned(clean, 31, 0, [0.9, 0, 0])
    q[32:35] = np.nan
    assert clips.angles(qf.despike(q), clean).max() < tolerances.ALGEBRA
    kept = qf.despike(q, gaps="keep")
    assert np.isnan(kept[32:35]).all()
    assert clips.angles(kept[31], clean[31]).max() < tolerances.ALGEBRA


@pytest.mark.usefixtures("backend")
def test_samples_without_confidence_are_replaced():
    q, _, rng = sample(9)
    trust = np.ones(q.shape[:2])
    trust[10:14, 1] = 0
    trust[0, 2] = 0
    trust[:, 0] = 0
    result = qf.despike(q, confidence=trust)
    wild = q.copy()
    wild[10:14, 1] = clips.random_rotations(rng, 4)
    wild[0, 2] *= -1
    # The first sample still says in which hemisphere the result begins.
    np.testing.assert_array_equal(np.abs(result), np.abs(qf.despike(wild, confidence=trust)))
    # Nothing could replace a joint that is trusted nowhere.
    np.testing.assert_array_equal(np.abs(result[:, 0]), np.abs(q[:, 0]))


@pytest.mark.usefixtures("backend")
def test_the_translation_is_judged_by_itself():
    q, _, _ = sample(10, share=0.03)
    line = np.linspace([0.0, 1, 2], [9, 0, 5], FRAMES)
    spoilt_path = line.copy()
    spoilt_path[[20, 41, 42]] += 3.0
    options = {
        "radius": RADIUS,
        "threshold": 4.0,
        "smallest": SMALLEST,
        "duration": "auto",
        "confidence": None,
    }
    missing = {"gaps": "fill", "max_gap": None, "fps": 1.0, "scalar_first": True}
    before = spoilt_path.tobytes()
    result, moved = despike.with_translation(q, spoilt_path, **options, **missing)
    assert spoilt_path.tobytes() == before
    np.testing.assert_array_equal(result, qf.despike(q, smallest=SMALLEST))
    np.testing.assert_allclose(moved, line, rtol=0, atol=tolerances.FLOAT64)
    trust = np.ones(FRAMES)
    trust[50:] = 0
    _, moved = despike.with_translation(q, line, **(options | {"confidence": trust}), **missing)
    np.testing.assert_array_equal(moved[:50], line[:50])
    np.testing.assert_array_equal(moved[50:], np.repeat(line[49:50], FRAMES - 50, axis=0))
