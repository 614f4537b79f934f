"""What must hold for exact repeats."""

import clips
import numpy as np
import pytest


def motion(frames=60, joints=3):
    rng = np.random.default_rng(0)
    return clips.noisy(rng, clips.smooth(rng, frames, joints), 0.01), rng


def test_noise_does_not_repeat(backend):
    q, _ = motion()
    assert not backend.find_repeats(q).any()


@pytest.mark.parametrize("every", [2, 3, 4])
def test_a_held_stream_repeats_between_its_new_frames(backend, every):
    q, rng = motion()
    held = clips.flipped(rng, q[np.arange(60) // every * every])
    expected = np.tile((np.arange(60) % every != 0)[:, None], (1, 3))
    np.testing.assert_array_equal(backend.find_repeats(held), expected)


def test_joints_are_told_apart(backend):
    q, _ = motion()
    q[20:40, 1] = q[19, 1]
    found = backend.find_repeats(q)
    assert found[20:40, 1].all()
    assert found.sum() == 20


def test_a_gap_is_no_repeat_and_is_looked_across(backend):
    q, _ = motion()
    q[20:24, 1] = [[np.nan] * 4, [0.0] * 4, [np.inf, 0, 0, 0], [0.0] * 4]
    assert not backend.find_repeats(q).any()
    q[24, 1] = -q[19, 1]
    assert np.argwhere(backend.find_repeats(q)).tolist() == [[24, 1]]


@pytest.mark.parametrize("frames", [0, 1])
def test_short_clips_repeat_nothing(backend, frames):
    assert backend.find_repeats(np.ones((frames, 2, 4)) / 2).shape == (frames, 2)
    assert not backend.find_repeats(np.ones((frames, 2, 4)) / 2).any()
    assert not backend.find_repeats(np.full((5, 2, 4), np.nan)).any()
