"""Measures of positions and feet: values worked out by hand."""

import numpy as np
import pytest
import quatfilt as qf
from quatfilt.evaluation.synthetic import walk
from quatfilt.motion import metrics

FPS = 100.0


def slider(path, *, names=("root", "LeftFoot"), unit=1.0):
    """A root that follows a path, ``(frames, 3)``, with a foot half a metre under it."""
    offsets = np.zeros((len(names), 3))
    offsets[1:, 1] = -50 / unit
    parents = [-1] + [0] * (len(names) - 1)
    skeleton = qf.Skeleton(names, parents, offsets, centimetres_per_unit=unit)
    rotations = np.tile([1.0, 0.0, 0.0, 0.0], (len(path), len(names), 1))
    return qf.Motion(rotations, np.asarray(path, float) / unit, fps=FPS, skeleton=skeleton)


def stop_and_go(speed):
    """Ten frames of standing, ten of sliding at `speed` cm/s along x, ten of flying off."""
    path = np.zeros((30, 3))
    path[10:20, 0] = np.arange(1, 11) * speed / FPS
    path[20:, 0] = path[19, 0]
    path[20:, 1] = np.arange(1, 11) * 10
    return path


@pytest.mark.parametrize("unit", [1.0, 5.644, 100.0])
def test_position_error_is_in_centimetres(unit):
    path = np.zeros((4, 3))
    moved = path + np.array([3.0, 4.0, 0.0])
    truth, estimate = slider(path, unit=unit), slider(moved, unit=unit)
    assert metrics.position_error(truth, estimate) == pytest.approx(5)
    assert metrics.position_error(truth, estimate, per="joint") == pytest.approx([5, 5])
    assert metrics.position_error(truth, estimate, per="sample").shape == (4, 2)


def test_position_error_of_a_turned_root():
    truth = slider(np.zeros((3, 3)))
    rotations = truth.rotations.copy()
    rotations[:, 0] = [0.0, 1.0, 0.0, 0.0]
    assert metrics.position_error(truth, truth.replace(rotations=rotations), per="joint") == pytest.approx(
        [0, 100]
    )


def test_positions_below_a_missing_sample_are_left_out():
    truth = slider(np.zeros((3, 3)))
    rotations = truth.rotations.copy()
    rotations[1, 0] = np.nan
    estimate = slider([[1.0, 0, 0]] * 3).replace(rotations=rotations)
    assert metrics.position_error(truth, estimate) == pytest.approx(1)
    assert np.isnan(metrics.position_error(truth, estimate, per="sample")[1, 1])


def test_motions_that_do_not_match_are_refused():
    truth = slider(np.zeros((3, 3)))
    with pytest.raises(ValueError, match="motion: expected the reference's 3 frames, got 2"):
        metrics.position_error(truth, slider(np.zeros((2, 3))))
    with pytest.raises(
        ValueError, match="motion: expected the reference's 2 joints, got 'foot' where 'LeftFoot' is"
    ):
        metrics.position_error(truth, slider(np.zeros((3, 3)), names=("root", "foot")))
    with pytest.raises(ValueError, match="motion: expected the reference's 2 joints, got 3"):
        metrics.position_error(truth, slider(np.zeros((3, 3)), names=("root", "LeftFoot", "c")))


def test_a_foot_that_creeps_slides_and_one_that_hurries_does_not_touch():
    creeping = slider(stop_and_go(10))
    # The last step of the slide and the take-off are faster than 15 cm/s in the central difference.
    contacts = metrics.foot_contacts(creeping)[:, 0]
    assert contacts.tolist() == [True] * 19 + [False] * 11
    assert metrics.foot_slide(creeping) == pytest.approx(0.1 * 9)
    hurrying = slider(stop_and_go(40))
    assert metrics.foot_contacts(hurrying)[:, 0].sum() == 9
    assert metrics.foot_slide(hurrying) == 0


def test_a_reference_says_when_feet_touch():
    # Twice as far away from each frame to the next: too fast to count as standing on its own.
    path = np.zeros((30, 3))
    path[::2, 2] = 0.5
    shaking = slider(path)
    assert metrics.foot_slide(shaking, reference=slider(np.zeros((30, 3)))) == pytest.approx(0.5 * 29)


def test_slide_is_horizontal_whatever_axis_is_up():
    creeping = stop_and_go(10)
    motion = slider(creeping)
    turned = motion.replace(
        translation=motion.translation[:, [2, 0, 1]],
        skeleton=qf.Skeleton(motion.skeleton.names, [-1, 0], motion.skeleton.offsets[:, [2, 0, 1]]),
    )
    upside_down = motion.replace(
        translation=motion.translation * [1, -1, 1],
        skeleton=qf.Skeleton(motion.skeleton.names, [-1, 0], motion.skeleton.offsets * [1, -1, 1]),
    )
    for other in (turned, upside_down):
        assert metrics.foot_slide(other) == pytest.approx(metrics.foot_slide(motion))
    assert metrics.foot_slide(turned, up="z") == pytest.approx(metrics.foot_slide(motion, up="y"))


def test_three_frames_are_a_contact_and_two_are_none():
    path = np.zeros((20, 3))
    path[:, 1] = 20
    for frames in (2, 3):
        # The neighbours of a step are fast in the central difference, so the foot stands two frames longer.
        at_rest = path.copy()
        at_rest[5 : 5 + frames + 2, 1] = 0
        assert metrics.foot_contacts(slider(at_rest))[:, 0].sum() == (3 if frames == 3 else 0)


def test_feet_are_found_by_name_or_named():
    motion = slider(np.zeros((5, 3)), names=("hips", "ltoes", "R_Ankle", "hand"))
    assert metrics.foot_contacts(motion).shape == (5, 2)
    assert metrics.foot_slide(motion, feet=["hand"], per="joint").shape == (1,)
    with pytest.raises(ValueError, match="feet: expected names of the skeleton's joints, got 'left foot'"):
        metrics.foot_slide(motion, feet=["left foot"])
    with pytest.raises(ValueError, match="feet: expected names of foot joints"):
        metrics.foot_slide(slider(np.zeros((5, 3)), names=("a", "b")))


def test_noise_makes_feet_slide():
    truth = walk(seconds=3)
    noisy = truth.replace(rotations=qf.add_gaussian_noise(truth.rotations, sigma=0.03, rng=0))
    assert metrics.foot_slide(noisy, reference=truth) > 20 * metrics.foot_slide(truth)


def test_empty_motions():
    nothing = walk(seconds=0)
    assert metrics.foot_slide(nothing) == 0
    assert np.isnan(metrics.position_error(nothing, nothing))
