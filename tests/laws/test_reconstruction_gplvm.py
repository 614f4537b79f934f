"""Motion from a few trajectories with a latent variable model that is learned once."""

import functools
import sys

import clips
import numpy as np
import pytest
import quatfilt as qf
import walkers


@functools.cache
def learned():
    database = walkers.walks(seeds=(1,), seconds=1.5)
    return qf.MotionReconstructor(
        database, control_points=walkers.JOINTS, neighbors=8, model="gplvm", control_scale=20.0
    )


def test_a_walk_like_those_it_was_learned_from():
    walk = walkers.walker(20)
    result = learned().reconstruct(walkers.seen(walk), fps=walkers.FPS)
    assert qf.metrics.angle_error(walk.rotations, result.rotations) < 12
    assert np.abs(walkers.seen(result) - walkers.seen(walk)).max() < 5
    assert learned().energies_.shape == (20, 2)


def test_control_points_count():
    walk = walkers.walker(6)
    points = walkers.seen(walk)
    higher = points + np.where(np.arange(4)[:, None] == 0, [0.0, 15.0, 0.0], 0)
    there, other = (learned().reconstruct(seen, fps=walkers.FPS) for seen in (points, higher))
    lifted = walkers.seen(other)[1:, 0, 1] - walkers.seen(there)[1:, 0, 1]
    assert lifted.mean() > 5


def test_turning_and_moving_the_points_turns_and_moves_the_motion():
    points = walkers.seen(walkers.walker(6))
    result = learned().reconstruct(points, fps=walkers.FPS)
    away = np.array([100.0, 0.0, -40.0])
    there = learned().reconstruct(walkers.turned(points, 2.0, away), fps=walkers.FPS)
    places = walkers.turned(result.positions(), 2.0, away)
    # The search for a latent point ends where its objective hardly falls any more.
    np.testing.assert_allclose(there.positions(), places, rtol=0, atol=0.02)


def test_a_stream_is_the_whole():
    points = walkers.seen(walkers.walker(30)).copy()
    points[5, 1] = np.nan
    points[8:26] = np.nan
    whole = learned().reconstruct(points, fps=walkers.FPS)
    stream = learned().stream()
    poses = [stream.push(frame) for frame in points]
    assert clips.angles(whole.rotations, np.array([pose.rotations for pose in poses])).max() <= 1e-9
    np.testing.assert_allclose([pose.translation for pose in poses], whole.translation, rtol=0, atol=1e-9)


def test_it_goes_on_from_what_came_before():
    walk = walkers.walker(12)
    before = walkers.part(walk, slice(0, 6))
    result = learned().reconstruct(walkers.seen(walk)[6:], fps=walkers.FPS, initial=before)
    assert qf.metrics.angle_error(walk.rotations[6:7], result.rotations[:1]) < 10


def test_without_its_package(monkeypatch):
    monkeypatch.setitem(sys.modules, "GPy", None)
    message = r"^latent variable models need GPy: pip install 'quatfilt\[gplvm\]'$"
    with pytest.raises(ImportError, match=message):
        qf.MotionReconstructor(walkers.database(), control_points=walkers.JOINTS, model="gplvm")
