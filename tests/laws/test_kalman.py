"""What must hold for the Kalman filter and its smoother, whatever the clip."""

import clips
import numpy as np
import pytest
import tolerances
from drawn import dtypes, seeds
from hypothesis import given
from hypothesis import strategies as st
from plugins.properties import examples

WHOLE = -1
SIGMA = 0.05

lookaheads = pytest.mark.parametrize("lookahead", [WHOLE, 0, 4])

few = examples(12)
"""Each is a whole clip; the reference takes its time."""


def sample(seed, frames=23, joints=3):
    rng = np.random.default_rng(seed)
    return clips.noisy(rng, clips.smooth(rng, frames, joints, swing=2), SIGMA), rng


def filtered(backend, q, lookahead=WHOLE, *, confidence=None, process=0.01, measurement=SIGMA):
    joints = q.shape[1]
    confidence = None if confidence is None else confidence.astype(q.dtype)
    return backend.kalman(q, confidence, np.full(joints, process), np.full(joints, measurement), lookahead)


def automatic(backend, q, lookahead=WHOLE):
    return backend.kalman_process_noise(q, None, np.full(q.shape[1], SIGMA), len(q), lookahead)


# ---- symmetries of rotations


@lookaheads
@few
@given(seed=seeds)
def test_constant_rotations_on_either_side_go_through(backend, lookahead, seed):
    q, rng = sample(seed)
    a, b = clips.random_rotations(rng, 2)
    moved = clips.product(a, clips.product(q, b))
    result = clips.product(a, clips.product(filtered(backend, q, lookahead), b))
    assert clips.angles(filtered(backend, moved, lookahead), result).max() < tolerances.FLOAT64
    np.testing.assert_allclose(
        automatic(backend, moved, lookahead), automatic(backend, q, lookahead), rtol=tolerances.RATIO
    )


@lookaheads
@few
@given(seed=seeds)
def test_whether_rotations_lead_from_the_parent_or_to_it_does_not_matter(backend, lookahead, seed):
    """The velocity of the one is that of the other as seen from the parent: transport knows of no side."""
    q, _ = sample(seed)
    result = filtered(backend, q * [1, -1, -1, -1], lookahead) * [1, -1, -1, -1]
    assert clips.angles(result, filtered(backend, q, lookahead)).max() < tolerances.FLOAT64


@lookaheads
@few
@given(seed=seeds, dtype=dtypes)
def test_signs_do_not_matter(backend, lookahead, seed, dtype):
    q, rng = sample(seed)
    q = q.astype(dtype)
    other = clips.flipped(rng, q).astype(dtype)
    result, flipped = (filtered(backend, x, lookahead) for x in (q, other))
    sides = np.sign(np.sum(q[0] * other[0], axis=-1))[:, None]
    np.testing.assert_allclose(result, flipped * sides, rtol=0, atol=tolerances.algebra(dtype))


@lookaheads
@few
@given(seed=seeds, dtype=dtypes)
def test_output_is_unit_continuous_and_starts_in_the_hemisphere_of_the_input(backend, lookahead, seed, dtype):
    q, rng = sample(seed)
    q = clips.flipped(rng, q).astype(dtype)
    result = filtered(backend, q, lookahead)
    assert result.dtype == dtype
    np.testing.assert_allclose(np.linalg.norm(result, axis=-1), 1, atol=tolerances.algebra(dtype))
    assert (np.sum(result[1:] * result[:-1], axis=-1) >= 0).all()
    assert (np.sum(result[0] * q[0], axis=-1) >= 0).all()


@lookaheads
def test_constant_clips_stay(backend, lookahead):
    q = np.repeat(clips.random_rotations(np.random.default_rng(1), 1, 4), 30, axis=0)
    np.testing.assert_allclose(filtered(backend, q, lookahead), q, rtol=0, atol=tolerances.ALGEBRA)


def test_joints_do_not_matter_to_each_other(backend):
    q, _ = sample(2, joints=11)
    for joint in range(11):
        alone = filtered(backend, q[:, joint : joint + 1].copy())
        np.testing.assert_array_equal(alone[:, 0], filtered(backend, q)[:, joint])


# ---- time


@pytest.mark.parametrize("lookahead", [0, 1, 4])
def test_what_comes_later_than_the_lookahead_does_not_matter(backend, lookahead):
    q, _ = sample(3, 40)
    whole = filtered(backend, q, lookahead)
    for end in (20, 30):
        part = filtered(backend, q[:end].copy(), lookahead)
        np.testing.assert_array_equal(part[: end - lookahead], whole[: end - lookahead])
        last = end - lookahead - 1
        changed = q.copy()
        changed[last + lookahead] = clips.product(q[last + lookahead], clips.from_vectors([0, 0.2, 0]))
        assert clips.angles(filtered(backend, changed, lookahead)[last], whole[last]).max() > 0


def test_a_lookahead_beyond_the_end_is_the_whole_clip(backend):
    q, _ = sample(4)
    for lookahead in (len(q) - 1, len(q), 10**9):
        np.testing.assert_array_equal(filtered(backend, q, lookahead), filtered(backend, q))


def test_the_smoother_does_not_know_which_way_time_runs(backend):
    """Up to what rotations bend within the memory of the filter: a hundredth of what it changes."""
    q, _ = sample(5, 200)
    there, back = (filtered(backend, x) for x in (q, q[::-1].copy()))
    change = clips.angles(there, q).max()
    assert clips.angles(there, back[::-1]).max() < 0.01 * change
    there, back = (filtered(backend, x, 0) for x in (q, q[::-1].copy()))
    assert clips.angles(there, back[::-1]).max() > 0.2 * change


def motion(rate):
    """Four seconds of three joints that swing, without noise."""
    rng = np.random.default_rng(6)
    frequency = rng.uniform(0.2, 2, (3, 3, 4))
    phase = rng.uniform(0, 2 * np.pi, frequency.shape)
    t = np.arange(4 * rate + 1)[:, None, None, None] / rate
    return clips.from_vectors(
        np.sum(0.3 * np.sin(2 * np.pi * frequency * t + phase) / (1 + frequency), axis=-1)
    )


@pytest.mark.parametrize("noise", [1.0, 5.0])
def test_twice_the_frames_of_half_the_weight_are_the_same(backend, noise):
    """Between the frames the filter knows nothing of the motion's acceleration."""
    once, twice = (
        filtered(backend, motion(rate), process=noise * rate**-1.5, measurement=0.02 * np.sqrt(rate / 120))
        for rate in (120, 240)
    )
    inside = slice(60, -60)
    changed = clips.angles(once, motion(120))[inside].max()
    assert changed > 1e-4
    assert clips.angles(once, twice[::2])[inside].max() < 0.001 * changed


def test_a_forward_filter_at_twice_the_rate_lags_half_a_frame_less(backend):
    once, twice = (
        filtered(backend, motion(rate), 0, process=2 * rate**-1.5, measurement=0.02 * np.sqrt(rate / 120))
        for rate in (120, 240)
    )
    speed = clips.angles(motion(120)[1:], motion(120)[:-1]).max()
    assert clips.angles(once, twice[::2])[60:].max() < speed / 2


# ---- the model


def test_even_turns_stay(backend):
    """The prior of the velocity, half a turn per frame about none, is of little weight."""
    turns = clips.from_vectors(np.arange(200)[:, None, None] * np.array([0.1, 0.2, -0.1]))
    q = clips.product(clips.random_rotations(np.random.default_rng(7), 1, 1), turns)
    for lookahead in (WHOLE, 0, 3):
        assert clips.angles(filtered(backend, q, lookahead), q).max() < 1e-4
        assert clips.angles(filtered(backend, q, lookahead, measurement=1e-7), q).max() < tolerances.FLOAT64


def test_certain_measurements_are_not_changed(backend):
    q, _ = sample(8)
    assert clips.angles(filtered(backend, q, measurement=1e-9), q).max() < tolerances.FLOAT64


def test_it_removes_noise_and_the_smoother_more_of_it(backend):
    rng = np.random.default_rng(9)
    clean = clips.smooth(rng, 400, 3)
    q = clips.noisy(rng, clean, 0.03)

    def error(lookahead):
        process = backend.kalman_process_noise(q, None, np.full(3, 0.03), 400, lookahead)
        result = backend.kalman(q, None, process, np.full(3, 0.03), lookahead)
        return np.sqrt(np.mean(clips.angles(result, clean) ** 2))

    noise = np.sqrt(np.mean(clips.angles(q, clean) ** 2))
    assert error(0) < 0.7 * noise
    assert error(5) < 0.6 * error(0)
    assert error(WHOLE) < error(5)


# ---- confidence and gaps


@lookaheads
def test_confidence_of_one_is_none_given(backend, lookahead):
    q, _ = sample(10)
    np.testing.assert_array_equal(
        filtered(backend, q, lookahead, confidence=np.ones(q.shape[:2])), filtered(backend, q, lookahead)
    )


@lookaheads
@few
@given(seed=seeds)
def test_samples_without_confidence_do_not_matter(backend, lookahead, seed):
    q, rng = sample(seed)
    confidence = clips.confidences(rng, *q.shape[:2])
    other = np.where(confidence[..., None] > 0, q, clips.random_rotations(rng, *q.shape[:2]))
    result, changed = (filtered(backend, x, lookahead, confidence=confidence) for x in (q, other))
    sides = np.sign(np.sum(result[0] * changed[0], axis=-1))[:, None]
    np.testing.assert_array_equal(result, changed * sides)


@few
@given(seed=seeds, share=st.sampled_from([0.01, 0.25]))
def test_confidence_divides_the_variance(backend, seed, share):
    q, _ = sample(seed)
    result = filtered(backend, q, confidence=np.full(q.shape[:2], share))
    expected = filtered(backend, q, measurement=SIGMA / np.sqrt(share))
    assert clips.angles(result, expected).max() < tolerances.FLOAT64


@lookaheads
def test_before_its_first_sample_a_joint_stands_still(backend, lookahead):
    q, _ = sample(11, 40)
    confidence = np.ones(q.shape[:2])
    confidence[:10, 1] = 0
    confidence[:, 2] = 0
    result = filtered(backend, q, lookahead, confidence=confidence)
    np.testing.assert_array_equal(result[:11, 1], np.repeat(result[10:11, 1], 11, axis=0))
    assert clips.angles(result[10:, 1], filtered(backend, q[10:].copy(), lookahead)[:, 1]).max() == 0
    assert clips.angles(result[:, 2], q[:, 2]).max() < tolerances.ALGEBRA


FAST = np.array([0.0, 0.0, 0.05])
"""Radians per frame: 6 rad/s at 120 frames per second."""


def swing_with_a_gap(length):
    """A joint that turns fast, is lost, and found where it was lost, turning back."""
    before = FAST * np.arange(-30, 1)[:, None]
    vectors = np.concatenate([before, np.zeros((length, 3)), before[::-1]])
    confidence = np.ones((len(vectors), 1))
    confidence[31 : 31 + length] = 0
    return clips.from_vectors(vectors[:, None]), confidence


@pytest.mark.parametrize("length", [40, 60, 80, 110])
def test_no_gap_is_crossed_by_a_turn_the_long_way_round(backend, length):
    """A forecast of 110 frames would be 5.5 radians away; the sample that follows would seem to lie ahead of it."""
    q, confidence = swing_with_a_gap(length)
    result = filtered(backend, q, confidence=confidence, process=0.002, measurement=0.005)
    way = clips.angles(result[1:], result[:-1])[:, 0]
    assert way[31 : 31 + length].max() < 1.5 * FAST[2]
    # There and back: a cubic of these slopes rises by a quarter of their way.
    assert clips.angles(result, q[30:31]).max() == pytest.approx(max(1.5, 0.05 * length / 4), abs=0.2)
    assert clips.angles(result, q)[confidence > 0].max() < 0.1


def test_a_forward_filter_leaves_a_forecast_that_has_become_uncertain(backend):
    q, confidence = swing_with_a_gap(80)
    result = filtered(backend, q, 0, confidence=confidence, process=0.002, measurement=0.005)
    ahead = clips.angles(result[31:111], result[30:31])[:, 0]
    frames = np.arange(1, 81)
    # Its variance is then near a third of the process variance times the cube of the frames.
    followed = frames < 0.9 * (3 * (0.2 / 0.002) ** 2) ** (1 / 3)
    assert 20 < followed.sum() < 40
    np.testing.assert_allclose(ahead[followed], FAST[2] * frames[followed], rtol=0.1)
    left = frames > 1.1 * (3 * (0.2 / 0.002) ** 2) ** (1 / 3)
    assert np.ptp(ahead[left]) < tolerances.ALGEBRA


# ---- the automatic process noise


@few
@given(seed=seeds, scale=st.sampled_from([0.5, 3.0]))
def test_what_matters_is_the_ratio_of_the_noises(backend, seed, scale):
    q, _ = sample(seed, 60)
    expected = scale * backend.kalman_process_noise(q, None, np.full(3, 0.01), 60, 0)
    result = backend.kalman_process_noise(q, None, np.full(3, 0.01 * scale), 60, 0)
    # The prior of the velocity is of little weight.
    np.testing.assert_allclose(result, expected, rtol=1e-2)


def test_more_noise_asks_for_a_stiffer_filter(backend):
    rng = np.random.default_rng(12)
    clean = clips.smooth(rng, 400, 3)
    ratios = [
        backend.kalman_process_noise(clips.noisy(rng, clean, s), None, np.full(3, s), 400, WHOLE) / s
        for s in (0.003, 0.03, 0.3)
    ]
    assert (ratios[0] > 2 * ratios[1]).all()
    assert (ratios[1] > 2 * ratios[2]).all()


def test_with_few_samples_the_noises_are_equal(backend):
    q, _ = sample(13)
    confidence = np.zeros(q.shape[:2])
    confidence[:7] = 1
    noise = np.array([0.1, 0.2, 0.3])
    np.testing.assert_allclose(backend.kalman_process_noise(q, confidence, noise, 100, WHOLE), noise)
    np.testing.assert_array_equal(backend.kalman_vectors_ratio(np.ones((7, 2)), 100, WHOLE), [1, 1])


# ---- numbers


def test_lines_stay(backend):
    x = np.linspace([0.0, 5, -3], [7, 5, 8], 50)
    for lookahead in (WHOLE, 0, 3):
        result = backend.kalman_vectors(x, np.full(3, 1e-3), lookahead)
        np.testing.assert_allclose(result, x, rtol=0, atol=1e-8)


def test_numbers_know_no_scale_and_no_origin(backend):
    x = clips.path(np.random.default_rng(14), 60)
    ratio = backend.kalman_vectors_ratio(x, 60, WHOLE)
    np.testing.assert_allclose(
        backend.kalman_vectors_ratio(1e6 * x + 1e3, 60, WHOLE), ratio, rtol=tolerances.RATIO
    )
    result = backend.kalman_vectors(x, ratio, WHOLE)
    moved = backend.kalman_vectors(1e6 * x + 1e3, ratio, WHOLE)
    np.testing.assert_allclose((moved - 1e3) / 1e6, result, rtol=0, atol=tolerances.FLOAT64)
