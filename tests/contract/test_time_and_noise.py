"""Continuity, interpolation in time, gaps and noise: shapes, orders, options, messages word for word."""

import math

import clips
import numpy as np
import pytest
import quatfilt as qf
import tolerances


def clip(frames=40, joints=3):
    rng = np.random.default_rng(0)
    q = clips.smooth(rng, frames, joints)
    q[5:8, 0] = np.nan
    return q


CLIP_TO_CLIP = {
    "add_gaussian_noise": lambda q, **options: qf.add_gaussian_noise(q, sigma=0.1, rng=3, **options),
    "add_impulse_noise": lambda q, **options: qf.add_impulse_noise(q, probability=0.5, rng=3, **options),
    "continuous": qf.continuous,
    "fill_gaps": lambda q, **options: qf.fill_gaps(q, **options)[0],
    "fill_gaps by squad": lambda q, **options: qf.fill_gaps(q, method="squad", **options)[0],
    "resample": lambda q, **options: qf.resample(q, fps=30, new_fps=47, **options),
    "slerp": lambda q, **options: qf.slerp(q, np.arange(len(q)), np.linspace(0, len(q) - 1, 9), **options),
}


@pytest.mark.parametrize("name", CLIP_TO_CLIP)
def test_a_single_series_is_one_joint(name):
    call, q = CLIP_TO_CLIP[name], clip(joints=1)
    result = call(q[:, 0])
    assert result.shape == (*result.shape[:1], 4)
    np.testing.assert_array_equal(result, call(q)[:, 0])


@pytest.mark.parametrize("name", CLIP_TO_CLIP)
def test_scalar_last(name):
    call, q = CLIP_TO_CLIP[name], clip()
    last = call(np.roll(q, -1, axis=-1), scalar_first=False)
    np.testing.assert_array_equal(last, np.roll(call(q), -1, axis=-1))


@pytest.mark.parametrize("name", CLIP_TO_CLIP)
def test_the_input_is_not_written_and_the_type_stays(name):
    call, q = CLIP_TO_CLIP[name], clip()
    before = q.tobytes()
    assert call(q).dtype == np.float64
    assert call(q.astype(np.float32)).dtype == np.float32
    assert q.tobytes() == before


@pytest.mark.parametrize("name", CLIP_TO_CLIP)
def test_what_is_no_clip_of_rotations_is_refused(name):
    call = CLIP_TO_CLIP[name]
    for shape, expected in (((5, 3), "(..., 4)"), ((2, 5, 3, 4), "(frames, joints, 4) or (frames, 4)")):
        with pytest.raises(ValueError) as caught:
            call(np.ones(shape))
        assert str(caught.value) == f"q: expected shape {expected}, got {shape}"
    q = clip()
    q[30, 2] *= 2
    with pytest.raises(ValueError, match=r"^q: expected unit quaternions, got norm 2 at frame 30, joint 2$"):
        call(q)


@pytest.mark.parametrize("frames", [0, 1])
@pytest.mark.parametrize("name", ["continuous", "fill_gaps", "resample"])
def test_nothing_and_one_frame_come_back(name, frames):
    q = clip(frames)
    result = CLIP_TO_CLIP[name](q)
    np.testing.assert_array_equal(result, q)
    assert not np.shares_memory(result, q)


@pytest.mark.parametrize(
    ("times", "new_times", "message"),
    [
        ([0, 1], [0], "times: expected one time per frame, shape (3,), got (2,)"),
        ([0, 1, 1], [0], "times: expected strictly increasing times, got 1 after 1 at index 2"),
        ([0, 1, math.nan], [0], "times: expected finite times, got nan at index 2"),
        ([0, 1, 2], [0, 2.5], "new_times: expected times from 0 to 2, got 2.5 at index 1"),
        ([0, 1, 2], [-1], "new_times: expected times from 0 to 2, got -1 at index 0"),
        ([0, 1, 2], [math.inf], "new_times: expected finite times, got inf at index 0"),
        ([0, 1, 2], 1.0, "new_times: expected shape (n,), got ()"),
    ],
)
def test_times_that_do_not_fit(times, new_times, message):
    with pytest.raises(ValueError) as caught:
        qf.slerp(clip(3), times, new_times)
    assert str(caught.value) == message


def test_no_frames_have_no_times():
    assert qf.slerp(np.ones((0, 2, 4)), [], []).shape == (0, 2, 4)
    with pytest.raises(ValueError) as caught:
        qf.slerp(np.ones((0, 2, 4)), [], [0.0])
    assert str(caught.value) == "new_times: expected no times, since there are no frames, got 1"


@pytest.mark.parametrize(
    ("fps", "new_fps", "frames"), [(30, 60, 79), (60, 30, 20), (30, 30, 40), (25, 30, 47), (59.94, 29.97, 20)]
)
def test_frames_that_exist_are_kept(fps, new_fps, frames):
    q = clip()
    result = qf.resample(q, fps=fps, new_fps=new_fps)
    assert len(result) == frames
    seconds = np.arange(frames) / new_fps
    old = np.rint(seconds * fps).astype(int)
    kept = np.abs(seconds * fps - old) < 1e-6
    assert kept.sum() > 5
    valid = ~np.isnan(q[old[kept]])
    np.testing.assert_array_equal(~np.isnan(result[kept]), valid)
    np.testing.assert_allclose(
        np.abs(result[kept][valid]), np.abs(q[old[kept]][valid]), rtol=0, atol=tolerances.ALGEBRA
    )


@pytest.mark.parametrize("name", ["fps", "new_fps"])
@pytest.mark.parametrize("value", [0, -30])
def test_frame_rates_are_positive(name, value):
    with pytest.raises(ValueError) as caught:
        qf.resample(clip(), **({"fps": 30, "new_fps": 30} | {name: value}))
    assert str(caught.value) == f"{name}: expected a number above 0, got {value}"


@pytest.mark.parametrize(
    ("max_gap", "fps", "filled"),
    [(None, 1, 3), (0.1, 30, 3), (0.0999, 30, 0), (3, 1, 3), (2, 1, 0), (1e300, 60, 3)],
)
def test_gaps_are_measured_in_seconds(max_gap, fps, filled):
    result, where = qf.fill_gaps(clip()[:, 0], max_gap=max_gap, fps=fps)
    assert where.shape == (40,)
    assert where.sum() == filled
    assert np.isnan(result).any() == (not filled)


def test_gaps_have_no_negative_length():
    with pytest.raises(ValueError, match=r"^max_gap: expected a number of at least 0, got -1$"):
        qf.fill_gaps(clip(), max_gap=-1)


@pytest.mark.parametrize("method", ["linear", None])
def test_gaps_are_filled_in_known_ways(method):
    with pytest.raises(ValueError) as caught:
        qf.fill_gaps(clip(), method=method)
    assert str(caught.value) == f"method: expected one of 'slerp', 'squad', got {method!r}"


def test_the_level_has_the_shape_of_the_joints():
    q = clip(200)
    level = qf.noise_level(q)
    assert level.shape == (3,)
    assert np.shape(qf.noise_level(q[:, 1])) == ()
    assert qf.noise_level(q[:, 1]) == level[1]
    np.testing.assert_array_equal(qf.noise_level(np.roll(q, -1, axis=-1), scalar_first=False), level)


NOISES = ["add_gaussian_noise", "add_impulse_noise"]


@pytest.mark.parametrize("name", NOISES)
def test_a_seed_gives_one_noise_for_every_backend_and_type(name):
    call, q = CLIP_TO_CLIP[name], clip()
    result = call(q)
    with qf.use_backend("numpy"):
        np.testing.assert_allclose(call(q), result, rtol=0, atol=tolerances.ALGEBRA)
    single = call(q.astype(np.float32))
    np.testing.assert_allclose(single, result, rtol=0, atol=tolerances.ALGEBRA_FLOAT32)


@pytest.mark.parametrize("name", NOISES)
@pytest.mark.parametrize("kind", [np.nan, 0.0])
def test_missing_samples_stay_and_draw_their_noise(name, kind):
    whole = clip()
    whole[5:8, 0] = whole[4, 0]
    gaps = whole.copy()
    gaps[5:8, 0] = kind
    result = CLIP_TO_CLIP[name](gaps)
    np.testing.assert_array_equal(result[5:8, 0], gaps[5:8, 0])
    others = np.ones((40, 3), bool)
    others[5:8, 0] = False
    np.testing.assert_array_equal(result[others], CLIP_TO_CLIP[name](whole)[others])


def test_gaussian_noise_per_joint():
    still = np.tile([1.0, 0, 0, 0], (20_000, 2, 1))
    vectors = 2 * qf.log(qf.add_gaussian_noise(still, sigma=[0.0, 0.03], rng=np.random.default_rng(1)))
    assert not vectors[:, 0].any()
    # Five deviations of the estimate from 20 000 samples.
    np.testing.assert_allclose(vectors[:, 1].std(axis=0), 0.03, rtol=5 / math.sqrt(2 * 20_000))


def test_impulses_hit_as_often_and_as_hard_as_asked():
    still = np.tile([1.0, 0, 0, 0], (20_000, 2, 1))
    noisy = qf.add_impulse_noise(still, probability=[0.0, 0.1], magnitude=(0.5, 1.0), rng=1)
    angles = qf.geodesic_distance(still, noisy)
    assert not angles[:, 0].any()
    hit = angles[:, 1] > 0
    assert abs(hit.mean() - 0.1) < 5 * math.sqrt(0.1 * 0.9 / 20_000)
    assert angles[hit, 1].min() >= 0.5 - tolerances.ALGEBRA
    assert angles[hit, 1].max() <= 1.0 + tolerances.ALGEBRA
    assert np.abs(noisy[hit, 1, 1:].mean(axis=0)).max() < 5 / math.sqrt(hit.sum())


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        (
            {"magnitude": (0.5, 0.1)},
            ValueError,
            "magnitude: expected two numbers (low, high) in this order, got (0.5, 0.1)",
        ),
        ({"magnitude": 0.5}, TypeError, "magnitude: expected two numbers (low, high), got 0.5"),
        (
            {"magnitude": (-1, 1)},
            ValueError,
            "magnitude[0]: expected a number of at least 0 and at most 3.14159, got -1",
        ),
        (
            {"probability": 1.5},
            ValueError,
            "probability: expected a number of at least 0 and at most 1, got 1.5",
        ),
        (
            {"probability": [0.5]},
            ValueError,
            "probability: expected a number or one per joint, shape (3,), got (1,)",
        ),
        ({"rng": "1"}, TypeError, "rng: expected a numpy.random.Generator or a seed, got str"),
        ({"rng": -1}, ValueError, "rng: expected an integer of at least 0, got -1"),
    ],
)
def test_options_of_impulses(options, error, message):
    with pytest.raises(error) as caught:
        qf.add_impulse_noise(clip(), **({"probability": 0.1, "rng": 1} | options))
    assert str(caught.value) == message
