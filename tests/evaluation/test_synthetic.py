"""The built-in walk is what it says: a walk, with feet that stay, and impacts."""

import numpy as np
import pytest
import quatfilt as qf
from quatfilt.evaluation._gait import CYCLE, STRIDE
from quatfilt.evaluation._legs import REACH
from quatfilt.evaluation.synthetic import walk

TOES = ("LeftToe", "RightToe")
SEEDS = range(12)


@pytest.fixture(scope="module", name="clip")
def default_clip():
    return walk()


def joint(motion, name):
    return np.asarray(motion.positions())[:, motion.skeleton.index(name)]


def test_shape_and_unit(clip):
    assert clip.rotations.shape == (960, 21, 4)
    assert clip.translation.shape == (960, 3)
    assert clip.fps == 120
    assert clip.rotations.dtype == np.float64
    assert np.linalg.norm(clip.rotations, axis=-1) == pytest.approx(1, abs=1e-12)


def test_signs_are_continuous(clip):
    assert np.sum(clip.rotations[1:] * clip.rotations[:-1], axis=-1).min() > 0.9


def test_the_same_seed_gives_the_same_walk_and_another_another():
    assert np.array_equal(walk(seconds=1, seed=3).rotations, walk(seconds=1, seed=3).rotations)
    assert not np.allclose(walk(seconds=1, seed=3).rotations, walk(seconds=1, seed=4).rotations, atol=1e-3)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_standing_ball_of_the_foot_does_not_move(seed):
    motion = walk(seconds=6, seed=seed)
    contacts = qf.metrics.foot_contacts(motion, feet=TOES)
    assert contacts.any(axis=1).all(), "one foot is always down"
    assert contacts.mean(axis=0) == pytest.approx([0.57, 0.57], abs=0.06)
    # What remains is the moment of the lift, before it is fast enough to count as moving.
    assert qf.metrics.foot_slide(motion, feet=TOES) < 0.1 * motion.translation[-1, 2] / STRIDE


def test_standing_positions_are_exact(clip):
    # From the slap of the sole until the ball lifts, the ball of the foot stays to the last digits.
    path = joint(clip, "LeftToe")
    down = path[:, 1] < 1.5 + 1e-9
    both = down[1:] & down[:-1]
    assert both.sum() > 400
    assert np.abs(np.diff(path, axis=0)[both]).max() < 1e-10


@pytest.mark.parametrize("seed", SEEDS)
def test_feet_stay_above_the_ground_and_knees_bend(seed):
    motion = walk(seconds=6, seed=seed)
    for side in ("Left", "Right"):
        assert joint(motion, side + "Toe")[:, 1].min() > 1.49
        leg = joint(motion, side + "Ankle") - joint(motion, side + "Hip")
        assert np.linalg.norm(leg, axis=1).max() <= REACH + 1e-9
        hip, knee, ankle = (joint(motion, side + name) for name in ("Hip", "Knee", "Ankle"))
        along = (knee - hip)[:, 2] * (hip - ankle)[:, 1] - (ankle - hip)[:, 2] * (hip - knee)[:, 1]
        assert along.min() > 0, "the knee is in front of the line from hip to ankle"


def test_it_goes_forward_at_walking_speed(clip):
    speed = np.diff(clip.translation[[0, -1], 2])[0] / (959 / 120)
    assert speed == pytest.approx(STRIDE / CYCLE, rel=0.05)


def test_strikes_are_sharp_at_the_feet_and_felt_in_the_head(clip):
    turns = np.degrees(qf.geodesic_distance(clip.rotations[1:], clip.rotations[:-1])) * clip.fps
    change = np.abs(np.diff(turns, axis=0))
    ankle = change[:, clip.skeleton.index("LeftAnkle")]
    # The sole stops within a frame: hundreds of degrees per second, against a few from frame to frame elsewhere.
    assert ankle.max() > 200
    assert ankle.max() > 30 * np.median(ankle)
    assert change[:, clip.skeleton.index("Head")].max() > 10


@pytest.mark.parametrize(
    ("seconds", "fps", "frames"), [(0, 120, 0), (0.01, 120, 1), (1, 30, 30), (0.5, 7, 4)]
)
def test_any_length_and_rate(seconds, fps, frames):
    motion = walk(seconds=seconds, fps=fps)
    assert motion.rotations.shape == (frames, 21, 4)
    assert np.isfinite(motion.rotations).all()


def test_bad_arguments():
    with pytest.raises(ValueError, match="seconds: expected a number of at least 0"):
        walk(seconds=-1)
    with pytest.raises(ValueError, match="fps: expected a number above 0"):
        walk(fps=0)
    with pytest.raises(TypeError, match="seed: expected an integer"):
        walk(seed=1.5)
