"""What must hold for the 1€ filter, whatever the clip."""

import clips
import numpy as np
import pytest
import tolerances
from drawn import dtypes, seeds
from hypothesis import given


def sample(seed, frames=23, joints=3):
    rng = np.random.default_rng(seed)
    return clips.noisy(rng, clips.smooth(rng, frames, joints, swing=2), 0.05), rng


def filtered(backend, q, *, confidence=None, translation=None, cutoff=0.02, beta=0.1, derivative=0.02):
    numbers = (np.full(q.shape[1], float(x)) for x in (cutoff, beta, derivative))
    confidence = None if confidence is None else confidence.astype(q.dtype)
    result, moved = backend.one_euro(q, translation, confidence, *numbers)
    return result if translation is None else (result, moved)


@given(seed=seeds)
def test_constant_rotations_on_either_side_go_through(backend, seed):
    q, rng = sample(seed)
    a, b = clips.random_rotations(rng, 2)
    result = clips.product(a, clips.product(filtered(backend, q), b))
    moved = filtered(backend, clips.product(a, clips.product(q, b)))
    assert clips.angles(moved, result).max() < tolerances.FLOAT64


@given(seed=seeds, dtype=dtypes)
def test_signs_do_not_matter(backend, seed, dtype):
    q, rng = sample(seed)
    q = q.astype(dtype)
    other = clips.flipped(rng, q).astype(dtype)
    result, flipped = (filtered(backend, x) for x in (q, other))
    sides = np.sign(np.sum(q[0] * other[0], axis=-1))[:, None]
    np.testing.assert_allclose(result, flipped * sides, rtol=0, atol=tolerances.algebra(dtype))


@given(seed=seeds, dtype=dtypes)
def test_output_is_unit_continuous_and_starts_in_the_hemisphere_of_the_input(backend, seed, dtype):
    q, rng = sample(seed)
    q = clips.flipped(rng, q).astype(dtype)
    result = filtered(backend, q)
    assert result.dtype == dtype
    np.testing.assert_allclose(np.linalg.norm(result, axis=-1), 1, atol=tolerances.algebra(dtype))
    assert (np.sum(result[1:] * result[:-1], axis=-1) >= 0).all()
    assert (np.sum(result[0] * q[0], axis=-1) >= 0).all()


def test_constant_clips_stay(backend):
    q = np.repeat(clips.random_rotations(np.random.default_rng(1), 1, 4), 30, axis=0)
    np.testing.assert_allclose(filtered(backend, q), q, rtol=0, atol=tolerances.ALGEBRA)


def test_joints_do_not_matter_to_each_other(backend):
    q, _ = sample(2, joints=11)
    for joint in range(11):
        alone = filtered(backend, q[:, joint : joint + 1].copy())
        np.testing.assert_array_equal(alone[:, 0], filtered(backend, q)[:, joint])


def test_the_future_does_not_matter(backend):
    q, _ = sample(3, 40)
    np.testing.assert_array_equal(filtered(backend, q[:20].copy()), filtered(backend, q)[:20])


def test_the_first_sample_comes_back_and_each_result_lies_on_the_way_to_its_sample(backend):
    q, _ = sample(4)
    result = filtered(backend, q)
    assert clips.angles(result[0], q[0]).max() < tolerances.ALGEBRA
    whole = clips.angles(result[:-1], q[1:])
    parts = clips.angles(result[:-1], result[1:]) + clips.angles(result[1:], q[1:])
    np.testing.assert_allclose(parts, whole, rtol=0, atol=tolerances.FLOAT64)


def test_an_infinite_cutoff_changes_nothing(backend):
    q, _ = sample(5)
    assert clips.angles(filtered(backend, q, cutoff=np.inf), q).max() < tolerances.FLOAT64


@pytest.mark.parametrize("derivative", [0.02, np.inf])
def test_faster_motion_is_filtered_less(backend, derivative):
    """Turns at a constant speed: the result lags by the delay of the cutoff."""
    turns = {}
    for speed in (0.01, 0.1):
        q = clips.from_vectors(np.arange(400)[:, None, None] * np.array([0, 0, speed]))
        result = filtered(backend, q, beta=0.5, derivative=derivative)
        lag = clips.angles(result, q)[-1, 0] / speed
        assert lag == pytest.approx(1 / (2 * np.pi * (0.02 + 0.5 * speed)), rel=1e-6)
        turns[speed] = lag
    assert turns[0.1] < 0.5 * turns[0.01]


@pytest.mark.parametrize(("cutoff", "beta"), [(1.0, 0.0), (1.0, 0.5), (5.0, 0.1)])
def test_twice_the_frames_make_little_difference(backend, cutoff, beta):
    """A thirtieth of what the filter changes: it takes samples for constants up to the next."""

    def result(rate):
        t = np.arange(4 * rate + 1)[:, None, None] / rate
        q = clips.from_vectors(np.sin(t * [2.0, 5.0, 3.0]) * 0.5)
        return filtered(backend, q, cutoff=cutoff / rate, beta=beta, derivative=1.0 / rate), q

    (once, q), (twice, _) = result(120), result(240)
    assert clips.angles(once, twice[::2]).max() < 0.03 * clips.angles(once, q).max()


def test_noise_goes_at_rest(backend):
    rng = np.random.default_rng(6)
    still = np.repeat(clips.random_rotations(rng, 1, 3), 500, axis=0)
    q = clips.noisy(rng, still, 0.05)
    error, noise = (np.mean(clips.angles(x, still) ** 2) for x in (filtered(backend, q, beta=0), q))
    share = 1 / (1 + 1 / (2 * np.pi * 0.02))
    assert error / noise == pytest.approx(share / (2 - share), rel=0.3)


# ---- confidence and gaps


def test_confidence_of_one_is_none_given(backend):
    q, _ = sample(7)
    np.testing.assert_array_equal(filtered(backend, q, confidence=np.ones(q.shape[:2])), filtered(backend, q))


@given(seed=seeds)
def test_samples_without_confidence_do_not_matter(backend, seed):
    q, rng = sample(seed)
    confidence = clips.confidences(rng, *q.shape[:2])
    other = np.where(confidence[..., None] > 0, q, clips.random_rotations(rng, *q.shape[:2]))
    result, changed = (filtered(backend, x, confidence=confidence) for x in (q, other))
    sides = np.sign(np.sum(result[0] * changed[0], axis=-1))[:, None]
    np.testing.assert_array_equal(result, changed * sides)


def test_a_gap_holds_the_result_and_its_time_counts(backend):
    """Every third sample at a rate is each sample at a third of it."""
    q, _ = sample(8, 61)
    confidence = np.zeros(q.shape[:2])
    confidence[::3] = 1
    result = filtered(backend, q, confidence=confidence)
    np.testing.assert_array_equal(result[1::3], result[:-1:3])
    np.testing.assert_array_equal(result[2::3], result[:-1:3])
    # The speed per frame is three times as high, and so is a cutoff per frame.
    rare = filtered(backend, q[::3].copy(), cutoff=0.06, beta=0.1, derivative=0.06)
    assert clips.angles(result[::3], rare).max() < tolerances.FLOAT64


def test_before_its_first_sample_a_joint_stands_still(backend):
    q, _ = sample(9, 40)
    confidence = np.ones(q.shape[:2])
    confidence[:10, 1] = 0
    confidence[:, 2] = 0
    result = filtered(backend, q, confidence=confidence)
    np.testing.assert_array_equal(result[:11, 1], np.repeat(result[10:11, 1], 11, axis=0))
    assert clips.angles(result[10:, 1], filtered(backend, q[10:].copy())[:, 1]).max() < tolerances.ALGEBRA
    assert clips.angles(result[:, 2], q[:, 2]).max() < tolerances.ALGEBRA


def test_the_translation_moves_by_the_shares_of_the_root(backend):
    q, rng = sample(10, 60)
    path = clips.path(rng, 60)
    confidence = clips.confidences(rng, 60, 3)
    confidence[:5, 0] = 0
    result, moved = filtered(backend, q, confidence=confidence, translation=path)
    steps, ways = clips.angles(result[:-1, 0], result[1:, 0]), clips.angles(result[:-1, 0], q[1:, 0])
    begin = np.flatnonzero(confidence[:, 0])[0]
    expected = path.copy()
    expected[:begin] = path[begin]
    for frame in range(begin + 1, 60):
        share = steps[frame - 1] / ways[frame - 1]
        expected[frame] = expected[frame - 1] + share * (path[frame] - expected[frame - 1])
    np.testing.assert_allclose(moved, expected, rtol=0, atol=1e-9)
    confidence[:, 0] = 0
    _, moved = filtered(backend, q, confidence=confidence, translation=path)
    np.testing.assert_array_equal(moved, path)
