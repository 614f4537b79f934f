"""The latent variable model of poses: what it refuses, what it returns, and whether its predictions are what they say."""

import sys

import clips
import numpy as np
import pytest
import quatfilt as qf
from quatfilt.reconstruction._latent import LatentProcess

ANGLE = 0.4 * np.sin(np.arange(120) / 9)
AXES = np.array([[0.0, 0.0, 1.0], [0.0, 1.5, 0.0]])
CLEAN = clips.from_vectors(ANGLE[:, None, None] * AXES)
POSES = clips.noisy(np.random.default_rng(0), CLEAN, 0.01)
STEPS = np.stack([10 * ANGLE, np.full(120, 3.0)], axis=1)
OPTIONS = {"dimensions": 1, "subset": 40, "iterations": 40}


@pytest.fixture(scope="module")
def model():
    return qf.PoseGPLVM(POSES, root_steps=STEPS, **OPTIONS)


def test_poses_of_one_parameter_are_found_again(model):
    assert model.poses == 40
    found = np.stack([model.predict_pose(POSES[i : i + 1]).pose for i in range(120)])
    assert clips.angles(found, CLEAN).mean() < 0.5 * clips.angles(POSES, CLEAN).mean()


def test_what_comes_back(model):
    result = model.predict_pose(POSES[3:6].astype(np.float32))
    assert result.pose.dtype == np.float32
    assert result.pose.shape == result.chart.shape == (2, 4)
    assert result.mean.shape == result.deviation.shape == (8,)
    assert result.axes.shape == (8, 1)
    assert (result.deviation >= 0.002).all()
    # The root's numbers in their own units: one follows the angle, one is constant.
    assert abs(result.root_step[0] - STEPS[5, 0]) < 0.2
    assert abs(result.root_step[1] - 3) < 1e-6
    turned = clips.from_vectors(result.mean[:6].reshape(2, 3))
    assert clips.angles(clips.product(result.chart, turned), result.pose).max() < 1e-6


def test_far_from_what_was_learned_nothing_is_known(model):
    process = model._process
    here, away = (process.at(process.points[7] + far)[1] for far in (0.0, 1000.0))
    assert here < 3 * process.noise
    assert away > process.variance


def test_derivatives(model):
    process = model._process
    x = process.points[7] + 0.1
    step = 1e-3
    above, below = (process.at(x + sign * step) for sign in (1, -1))
    _, _, change, variance_change = process.at(x)
    np.testing.assert_allclose((above[0] - below[0]) / (2 * step), change[0], rtol=1e-4, atol=1e-6)
    np.testing.assert_allclose((above[1] - below[1]) / (2 * step), variance_change[0], rtol=0.01)


def test_predictions_are_those_of_gpy():
    import GPy

    rng = np.random.default_rng(0)
    points, outputs = rng.standard_normal((20, 2)), rng.standard_normal((20, 5))
    kernel = GPy.kern.RBF(2, variance=0.7, lengthscale=1.3) + GPy.kern.Bias(2, variance=0.2)
    theirs = GPy.models.GPRegression(points, outputs, kernel, noise_var=0.05)
    ours = LatentProcess.of(points, outputs, variance=0.7, length=1.3, bias=0.2, noise=0.05)
    x = rng.standard_normal(2)
    mean, variance = theirs.predict(x[None])
    here = ours.at(x)
    np.testing.assert_allclose(here[0], mean[0], rtol=1e-6)
    np.testing.assert_allclose(here[1], variance[0, 0], rtol=1e-6)


def test_the_order_of_components(model):
    last = qf.PoseGPLVM(np.roll(POSES, -1, axis=-1), root_steps=STEPS, **OPTIONS, scalar_first=False)
    ours, theirs = model.predict_pose(POSES[:1]), last.predict_pose(np.roll(POSES[:1], -1, axis=-1))
    np.testing.assert_array_equal(np.roll(theirs.pose, 1, axis=-1), ours.pose)


def without(q):
    q = q.copy()
    q[-1, 0] = np.nan
    return q


REFUSED = [
    ({"poses": POSES[0]}, "poses: expected shape (N, joints, 4) with at least two poses, got (2, 4)"),
    ({"poses": POSES[:1]}, "poses: expected shape (N, joints, 4) with at least two poses, got (1, 2, 4)"),
    ({"poses": without(POSES)}, "poses: expected no missing samples, got 1"),
    ({"root_steps": STEPS[1:]}, "root_steps: expected shape (120, n), got (119, 2)"),
    ({"dimensions": 0}, "dimensions: expected an integer of at least 1 and at most 6, got 0"),
    ({"dimensions": 7}, "dimensions: expected an integer of at least 1 and at most 6, got 7"),
    ({"subset": 2001}, "subset: expected an integer of at least 7 and at most 2000, got 2001"),
    ({"iterations": 0}, "iterations: expected an integer of at least 1, got 0"),
]


@pytest.mark.parametrize(("options", "message"), REFUSED)
def test_refused(options, message):
    with pytest.raises(ValueError) as caught:
        qf.PoseGPLVM(**{"poses": POSES, "dimensions": 6, **options})
    assert str(caught.value) == message


@pytest.mark.parametrize(
    ("recent", "message"),
    [
        (POSES[0], "recent: expected shape (m, 2, 4) as the model's poses, got (2, 4)"),
        (POSES[:2, :1], "recent: expected shape (m, 2, 4) as the model's poses, got (2, 1, 4)"),
        (without(POSES[:3]), "recent: expected no missing samples, got 1"),
    ],
)
def test_recent_poses_that_are_refused(model, recent, message):
    with pytest.raises(ValueError) as caught:
        model.predict_pose(recent)
    assert str(caught.value) == message


def test_without_its_package(monkeypatch):
    monkeypatch.setitem(sys.modules, "GPy", None)
    message = r"^latent variable models need GPy: pip install 'quatfilt\[gplvm\]'$"
    with pytest.raises(ImportError, match=message):
        qf.PoseGPLVM(POSES, **OPTIONS)
