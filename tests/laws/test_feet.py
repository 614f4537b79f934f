"""Feet stay where they stand, whatever the world's frame and unit, and nothing else changes."""

import functools

import numpy as np
import pytest
import quatfilt as qf
import tolerances
from quatfilt.evaluation.synthetic import walk
from quatfilt.motion.feet import with_feet
from quatfilt.motion.legs import find_legs, foot_joints

pytestmark = pytest.mark.usefixtures("backend")

SIGMA = 0.02


@functools.cache
def motions(seconds=3.0, fps=120.0, sigma=SIGMA):
    """A walk, the same with noise, and that after a filter that lets feet slide."""
    truth = walk(seconds=seconds, fps=fps, seed=3)
    noisy = (
        truth.replace(rotations=qf.add_gaussian_noise(truth.rotations, sigma=sigma, rng=1))
        if sigma
        else truth
    )
    return truth, noisy, qf.denoise(noisy, method="butterworth", cutoff=6, feet=None)


def slide(motion, truth):
    return qf.metrics.foot_slide(motion, reference=truth)


def turned(a, b):
    """Largest angle between two motions, in degrees."""
    return float(np.nanmax(qf.metrics.angle_error(a.rotations, b.rotations, per="sample")))


def close(result, expected, unit=1.0):
    np.testing.assert_allclose(
        np.abs(result.rotations), np.abs(expected.rotations), rtol=0, atol=tolerances.FEET
    )
    np.testing.assert_allclose(
        result.translation, expected.translation, rtol=0, atol=unit * tolerances.FEET * 100
    )


@pytest.mark.parametrize("fps", [120.0, 30.0])
@pytest.mark.parametrize("sigma", [0.0, SIGMA])
def test_feet_slide_less_and_joints_hardly_turn(fps, sigma):
    truth, noisy, clean = motions(fps=fps, sigma=sigma)
    kept = with_feet(noisy, clean, "keep")
    assert slide(clean, truth) > 5 * slide(truth, truth)
    assert slide(kept, truth) < 0.6 * slide(clean, truth)
    assert turned(kept, clean) < 3
    assert slide(with_feet(noisy, clean, "lock"), truth) < 0.6 * slide(clean, truth)
    psnr = [float(qf.metrics.psnr(truth.rotations, motion.rotations)) for motion in (clean, kept)]
    assert psnr[1] > psnr[0] - 0.1


def test_only_root_and_legs_change_and_only_near_contacts():
    _, noisy, clean = motions()
    kept = with_feet(noisy, clean, "keep")
    legs = find_legs(clean.skeleton)
    may = {0, *(joint for leg in legs for joint in (leg.hip, leg.knee, leg.ankle))}
    for joint in range(len(clean.skeleton)):
        same = np.array_equal(kept.rotations[:, joint], clean.rotations[:, joint])
        assert same == (joint not in may)
    alone = with_feet(noisy, clean, "keep", translation=False)
    np.testing.assert_array_equal(alone.translation, clean.translation)
    np.testing.assert_array_equal(alone.rotations[:, 0], clean.rotations[:, 0])
    assert not np.array_equal(alone.rotations, clean.rotations)
    contacts = np.zeros((len(clean), 4), bool)
    contacts[100:150, 0] = True
    locked = qf.lock_feet(clean, contacts=contacts)
    changed = np.flatnonzero((locked.rotations != clean.rotations).any(axis=(1, 2)))
    assert (changed.min(), changed.max()) == (89, 160)
    nothing = qf.lock_feet(clean, contacts=np.zeros_like(contacts))
    np.testing.assert_array_equal(nothing.rotations, clean.rotations)


def test_the_frame_and_the_unit_of_the_world_do_not_matter():
    _, noisy, clean = motions()
    kept = with_feet(noisy, clean, "keep")
    about = qf.exp([0.0, np.pi / 4, 0.0])  # a quarter turn: noise is measured along the axes of the world

    def elsewhere(motion):
        rotations = motion.rotations.copy()
        rotations[:, 0] = qf.multiply(np.tile(about, (len(motion), 1)), rotations[:, 0])
        x, y, z = motion.translation.T
        cos, sin = 0.0, 1.0
        moved = np.stack([cos * x + sin * z + 30, y, -sin * x + cos * z - 500], axis=1)
        return motion.replace(rotations=rotations, translation=moved)

    close(with_feet(elsewhere(noisy), elsewhere(clean), "keep"), elsewhere(kept))

    def scaled(motion, unit):
        skeleton = qf.Skeleton(motion.skeleton.names, motion.skeleton.parents, motion.skeleton.offsets * unit)
        return motion.replace(skeleton=skeleton, translation=motion.translation * unit)

    close(with_feet(scaled(noisy, 0.01), scaled(clean, 0.01), "keep"), scaled(kept, 0.01), unit=0.01)

    def z_up(motion):
        rotations = motion.rotations.copy()
        rotations[:, 0] = qf.multiply(np.tile([0.5**0.5, 0.5**0.5, 0, 0], (len(motion), 1)), rotations[:, 0])
        x, y, z = motion.translation.T
        return motion.replace(rotations=rotations, translation=np.stack([x, -z, y], axis=1))

    close(with_feet(z_up(noisy), z_up(clean), "keep"), z_up(kept))


def test_joints_above_the_pelvis_and_joint_translations_do_not_matter():
    _, noisy, clean = motions()
    kept = with_feet(noisy, clean, "keep")

    def below(motion):
        skeleton = motion.skeleton
        parents = np.concatenate([[-1], skeleton.parents + 1])
        offsets = np.concatenate([[[0.0, 0, 0]], skeleton.offsets])
        rest = np.tile([1.0, 0, 0, 0], (len(motion), 1, 1))
        moved = np.broadcast_to(offsets, (len(motion), *offsets.shape)).copy()
        moved[:, 1] = motion.translation
        return qf.Motion(
            np.concatenate([rest, motion.rotations], axis=1),
            fps=motion.fps,
            skeleton=qf.Skeleton(["world", *skeleton.names], parents, offsets),
            joint_translations=moved,
        )

    result = with_feet(below(noisy), below(clean), "keep")
    np.testing.assert_allclose(
        np.abs(result.rotations[:, 1:]), np.abs(kept.rotations), rtol=0, atol=tolerances.FEET
    )
    np.testing.assert_allclose(
        result.translation, kept.translation - clean.translation, rtol=0, atol=100 * tolerances.FEET
    )


def test_missing_samples_do_not_spread():
    truth, noisy, clean = motions()
    ankle = find_legs(clean.skeleton)[0].ankle
    rotations = clean.rotations.copy()
    rotations[100:110, ankle] = np.nan
    rotations[200:203, 0] = np.nan
    rotations[300, 5] = np.nan
    holes = clean.replace(rotations=rotations)
    gone = np.isnan(rotations)
    before = noisy.rotations.copy()
    before[50:90, ankle - 1] = np.nan
    kept = with_feet(noisy.replace(rotations=before), holes, "keep")
    np.testing.assert_array_equal(np.isnan(kept.rotations), gone)
    assert np.isfinite(kept.translation).all()
    assert slide(kept, truth) < 0.5 * slide(holes, truth)
    nowhere = clean.replace(rotations=np.full_like(rotations, np.nan))
    np.testing.assert_array_equal(with_feet(noisy, nowhere, "keep").rotations, nowhere.rotations)


@pytest.mark.parametrize("frames", [0, 1, 2, 3, 12])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_short_clips_and_dtypes(frames, dtype):
    _, noisy, _ = motions()
    short = noisy.replace(
        rotations=noisy.rotations[:frames].astype(dtype), translation=noisy.translation[:frames]
    )
    for how in ("keep", "lock"):
        result = qf.denoise(short, feet=how)
        assert result.rotations.shape == short.rotations.shape
        assert result.rotations.dtype == dtype
        assert np.isfinite(result.rotations).all()


def test_a_body_at_rest_stays_as_it_is():
    truth = walk(seconds=1)
    rest = truth.replace(
        rotations=np.repeat(truth.rotations[:1], 60, axis=0),
        translation=np.repeat(truth.translation[:1], 60, axis=0),
    )
    for result in (with_feet(rest, rest, "keep"), qf.lock_feet(rest)):
        np.testing.assert_allclose(result.rotations, rest.rotations, rtol=0, atol=tolerances.FEET)


def test_denoise_keeps_feet_unless_told_otherwise():
    _, noisy, _ = motions()
    same = {"method": "butterworth", "cutoff": 6}
    clean = qf.denoise(noisy, **same, feet=None)
    for how in ("keep", "lock"):
        expected = with_feet(noisy, clean, how).rotations
        np.testing.assert_array_equal(qf.denoise(noisy, **same, feet=how).rotations, expected)
    default = qf.denoise(noisy, **same).rotations
    np.testing.assert_array_equal(default, with_feet(noisy, clean, "keep").rotations)


def test_what_has_no_legs_is_left_alone_or_refused():
    truth, noisy, _ = motions()
    names = [f"joint {joint}" for joint in range(len(truth.skeleton))]
    skeleton = qf.Skeleton(names, truth.skeleton.parents, truth.skeleton.offsets)
    other = noisy.replace(skeleton=skeleton)
    same = {"method": "gaussian", "sigma": 0.02}
    np.testing.assert_array_equal(
        qf.denoise(other, **same).rotations, qf.denoise(other, **same, feet=None).rotations
    )
    with pytest.raises(ValueError, match="feet: expected a skeleton with legs for 'lock'"):
        qf.denoise(other, **same, feet="lock")
    with pytest.raises(ValueError, match="feet: no legs were recognised"):
        qf.lock_feet(other)
    by_topology = qf.lock_feet(other, feet="topology")
    np.testing.assert_array_equal(by_topology.rotations, qf.lock_feet(noisy).rotations)
    ends = [names[joint] for joint in foot_joints(truth.skeleton)]
    sides = {"left": ends[:2], "right": ends[2:]}
    assert np.array_equal(qf.lock_feet(other, feet=sides).rotations, by_topology.rotations)
    with pytest.raises(ValueError, match="feet: expected one of 'keep', 'lock', got 'hold'"):
        qf.denoise(noisy, **same, feet="hold")
    with pytest.raises(TypeError, match="feet='lock' needs a Motion, which has a skeleton, got ndarray"):
        qf.denoise(noisy.rotations, **same, feet="lock")
    with pytest.raises(TypeError, match="motion: expected a Motion, got ndarray"):
        qf.lock_feet(noisy.rotations)
    with pytest.raises(ValueError, match=r"contacts: expected shape \(360, 4\), .*, got \(360, 3\)"):
        qf.lock_feet(noisy, contacts=np.zeros((360, 3), bool))
    with pytest.raises(ValueError, match="contacts: expected True and False"):
        qf.lock_feet(noisy, contacts=np.full((360, 4), 0.5))
