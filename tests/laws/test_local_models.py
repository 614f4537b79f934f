"""What local models must do, whoever computes."""

import clips
import numpy as np
import pytest
import tolerances
from drawn import seeds
from hypothesis import given
from hypothesis import strategies as st
from local_models import MODELS, REGRESSIONS, examples, pose, predict, vectors

models = st.sampled_from(MODELS)
targets = st.sampled_from(["pose", "change"])
counts = st.sampled_from([1, 2, 3, 8, 30])

LEAST = 0.002
UNKNOWN = 0.2


def same(a, b):
    """Compare predictions in different charts, or of moved frames: the poses, the root's numbers and all deviations."""
    joints = len(a[0])
    np.testing.assert_allclose(a[1][3 * joints :], b[1][3 * joints :], atol=tolerances.LOCAL_MODELS)
    np.testing.assert_allclose(a[2], b[2], atol=tolerances.LOCAL_MODELS)
    np.testing.assert_allclose(a[3] @ a[3].T, b[3] @ b[3].T, atol=tolerances.LOCAL_MODELS)


@given(seed=seeds, model=models, target=targets, count=counts)
def test_a_motion_of_each_joints_frame_moves_the_prediction(backend, seed, model, target, count):
    rng = np.random.default_rng(seed)
    segments, steps, recent = examples(rng, count, 2, 3)
    left = clips.random_rotations(rng, 3)
    here = predict(backend, segments, steps, recent, model, target=target)
    moved = (clips.product(left, segments), steps, clips.product(left, recent))
    there = predict(backend, *moved, model, target=target)
    assert clips.angles(pose(there), clips.product(left, pose(here))).max() < tolerances.LOCAL_MODELS
    same(here, there)


@given(seed=seeds, model=models, target=targets, count=counts)
def test_neither_signs_nor_the_order_of_examples_matter(backend, seed, model, target, count):
    rng = np.random.default_rng(seed)
    segments, steps, recent = examples(rng, count, 2, 3)
    order = rng.permutation(count)
    here = predict(backend, segments, steps, recent, model, target=target)
    flipped = (clips.flipped(rng, segments)[order], steps[order], clips.flipped(rng, recent))
    there = predict(backend, *flipped, model, target=target)
    assert clips.angles(pose(there), pose(here)).max() < tolerances.LOCAL_MODELS
    same(here, there)


@given(seed=seeds, model=models, target=targets, count=counts)
def test_deviations_are_never_zero(backend, seed, model, target, count):
    rng = np.random.default_rng(seed)
    segments, steps, recent = examples(rng, count, 3, 2)
    alike = np.broadcast_to(segments[:1], segments.shape).copy()
    for given_segments in (segments, alike):
        prediction = predict(backend, given_segments, 0 * steps, recent, model, target=target)
        assert all(np.isfinite(part).all() for part in prediction)
        assert (prediction[2] >= LEAST).all()
        assert np.ptp(prediction[2][6:]) == 0


@pytest.mark.parametrize("model", MODELS)
def test_one_example_says_nothing_about_deviations(backend, model):
    segments, steps, recent = examples(np.random.default_rng(0), 1, 3, 2)
    prediction = predict(backend, segments, steps, recent, model)
    assert clips.angles(pose(prediction), segments[0, -1]).max() < tolerances.LOCAL_MODELS
    np.testing.assert_allclose(prediction[1][6:], steps[0], rtol=tolerances.ALGEBRA)
    assert (prediction[2] == UNKNOWN).all()
    assert prediction[3].shape == (10, 0)


@pytest.mark.parametrize("model", MODELS)
def test_nor_does_one_that_has_all_of_the_weight(backend, model):
    segments, steps, recent = examples(np.random.default_rng(1), 20, 3, 2)
    recent[:] = segments[4, :-1]
    prediction = predict(backend, segments, steps, recent, model, bandwidth=1e-5)
    assert clips.angles(pose(prediction), segments[4, -1]).max() < tolerances.LOCAL_MODELS
    assert (prediction[2] == UNKNOWN).all()


@pytest.mark.parametrize("model", MODELS)
def test_of_equal_examples_the_next_pose_is_theirs(backend, model):
    segments, steps, recent = examples(np.random.default_rng(2), 12, 3, 2)
    alike = np.broadcast_to(segments[:1], segments.shape).copy()
    prediction = predict(backend, alike, steps, recent, model)
    assert clips.angles(pose(prediction), segments[0, -1]).max() < tolerances.LOCAL_MODELS
    np.testing.assert_array_equal(prediction[2][:6], LEAST)


def turns(rng, count, *, axis=(0.0, 0.6, 0.8)):
    """Examples of one joint that turns evenly about one axis, each at its own speed from its own angle: and one more."""
    angle = rng.uniform(-0.5, 0.5, count)[:, None] + rng.uniform(0.01, 0.1, count)[:, None] * np.arange(4)
    q = clips.from_vectors(angle[:, :, None, None] * np.array(axis))
    return q[1:], np.zeros((count - 1, 0)), q[0, :-1], q[0, -1]


@pytest.mark.parametrize("target", ["pose", "change"])
@pytest.mark.parametrize("model", ["local_regression", "local_pcr"])
def test_what_is_linear_is_predicted(backend, model, target):
    segments, steps, recent, truth = turns(np.random.default_rng(3), 30)
    prediction = predict(backend, segments, steps, recent, model, target=target, ridge=1e-9, share=1.0)
    # The ridge shrinks what varies least, the speeds, by some ten thousandths.
    assert clips.angles(pose(prediction), truth).max() < 1e-5
    np.testing.assert_array_equal(prediction[2], LEAST)


@pytest.mark.parametrize("model", MODELS)
def test_changes_begin_at_the_last_pose(backend, model):
    rng = np.random.default_rng(4)
    q = clips.random_rotations(rng, 3)
    segments = clips.noisy(rng, np.broadcast_to(q, (20, 1, 3, 4)), 0.05)
    still = np.concatenate([segments, segments], axis=1)
    recent = clips.noisy(rng, q[None], 0.05)
    prediction = predict(backend, still, np.zeros((20, 0)), recent, model, target="change")
    assert clips.angles(pose(prediction), recent[0]).max() < tolerances.LOCAL_MODELS


@pytest.mark.parametrize("model", REGRESSIONS)
def test_far_from_all_examples_little_is_known(backend, model):
    rng = np.random.default_rng(5)
    segments, steps, recent = examples(rng, 30, 2, 3, swing=0.2)
    far = clips.noisy(rng, recent, 0.4)
    near = predict(backend, segments, steps, segments[7, :-1], model)
    away = predict(backend, segments, steps, far, model)
    assert (away[2] > 1.2 * near[2]).mean() > 0.9


@given(seed=seeds, share=st.sampled_from([0.3, 0.9, 1.0]))
def test_axes_and_deviations_make_up_the_variance(backend, seed, share):
    rng = np.random.default_rng(seed)
    segments, steps, recent = examples(rng, 10, 2, 3)
    _, mean, deviation, axes = predict(backend, segments, steps, recent, "local_pca", share=share)
    _, plain, whole, none = predict(backend, segments, steps, recent, "mean_pose")
    np.testing.assert_allclose(mean, plain, atol=tolerances.LOCAL_MODELS)
    assert none.shape == (13, 0)
    variance = deviation**2 + np.sum(axes**2, axis=1)
    np.testing.assert_allclose(variance, whole**2, atol=2 * LEAST**2)
    orthogonal = axes.T @ axes
    np.testing.assert_allclose(orthogonal, np.diag(np.diag(orthogonal)), atol=tolerances.LOCAL_MODELS)


@given(seed=seeds, model=models)
def test_the_roots_numbers_have_their_own_unit(backend, seed, model):
    rng = np.random.default_rng(seed)
    segments, steps, recent = examples(rng, 12, 2, 3)
    if model == "local_pca":
        steps = steps * 1e-3
    one = predict(backend, segments, steps, recent, model)
    ten = predict(backend, segments, 10 * steps, recent, model)
    np.testing.assert_allclose(ten[1][9:], 10 * one[1][9:], atol=1e3 * tolerances.LOCAL_MODELS)
    if model != "local_pca":
        np.testing.assert_allclose(ten[2][9:], 10 * one[2][9:], atol=1e3 * tolerances.LOCAL_MODELS)


@pytest.mark.parametrize("model", MODELS)
def test_float32(backend, model):
    segments, steps, recent = examples(np.random.default_rng(6), 20, 3, 4)
    wide = predict(backend, segments, steps, recent, model)
    narrow = predict(backend, *(x.astype(np.float32) for x in (segments, steps, recent)), model)
    assert all(part.dtype == np.float64 for part in narrow)
    # A rounding of float32 is 6e-8, and grows by the ridge of a hundredth.
    np.testing.assert_allclose(narrow[1], wide[1], atol=1e-4)


@given(seed=seeds)
def test_what_signals_alone_tell_is_predicted_from_them(backend, seed):
    rng = np.random.default_rng(seed)
    signals = rng.standard_normal((12, 2))
    # The poses before are all the same: turns about one axis follow the signals, and signals of 0 mean a turn of 0.4.
    turns = np.zeros((12, 1, 3))
    turns[:, 0, 1] = 0.4 + signals @ [0.1, -0.2]
    still = np.tile([1.0, 0.0, 0.0, 0.0], (12, 2, 1, 1))
    segments = np.concatenate([still, clips.from_vectors(turns)[:, None]], axis=1)
    steps = signals @ [[1.0], [3.0]] - 2.0
    for model in ("local_regression", "local_pcr"):
        found = predict(
            backend, segments, steps, segments[0, :-1].copy(), model, signals=signals, ridge=1e-9, share=1.0
        )
        np.testing.assert_allclose(vectors(np.eye(4)[:1], pose(found)), [0.0, 0.4, 0.0], atol=1e-6)
        np.testing.assert_allclose(found[1][-1], -2.0, atol=1e-6)


@given(seed=seeds, model=models, target=targets, count=counts)
def test_signals_that_are_none_change_nothing(backend, seed, model, target, count):
    rng = np.random.default_rng(seed)
    segments, steps, recent = examples(rng, count, 2, 3)
    without = predict(backend, segments, steps, recent, model, target=target)
    zeros = predict(backend, segments, steps, recent, model, target=target, signals=np.zeros((count, 3)))
    for a, b in zip(without[:3], zeros[:3], strict=True):
        np.testing.assert_allclose(a, b, atol=tolerances.LOCAL_MODELS)
