"""What holds for segmentation."""

import clips
import numpy as np
import pytest
import quatfilt as qf
from drawn import spoil

PARTS = (400, 500, 450)


def behaviours(rng, joints=6):
    """Three gaits one after the other: other axes, other poses."""
    return np.concatenate([clips.walk(rng, frames, joints) for frames in PARTS])


def test_finds_where_behaviours_change(backend):
    assert backend.segment
    q = behaviours(np.random.default_rng(0))
    cuts = qf.segment(q, fps=120)
    assert len(cuts) == 2
    assert (np.abs(cuts - np.cumsum(PARTS)[:2]) < 30).all()


@pytest.mark.parametrize("components", [1, 2])
def test_signs_and_constant_rotations_change_nothing(backend, components):
    assert backend.segment
    rng = np.random.default_rng(1)
    q = clips.noisy(rng, behaviours(rng), 0.01)
    cuts = qf.segment(q, fps=120, n_components=components)
    assert len(cuts)
    left, right = clips.random_rotations(rng, 6), clips.random_rotations(rng, 6)
    turned = clips.product(clips.product(left, q), right)
    np.testing.assert_array_equal(qf.segment(clips.flipped(rng, q), fps=120, n_components=components), cuts)
    np.testing.assert_array_equal(qf.segment(turned, fps=120, n_components=components), cuts)


def test_joints_may_change_places(backend):
    assert backend.segment
    q = behaviours(np.random.default_rng(2))
    np.testing.assert_array_equal(qf.segment(q[:, ::-1], fps=120), qf.segment(q, fps=120))


def test_missing_samples_are_left_out(backend):
    assert backend.segment
    rng = np.random.default_rng(3)
    q = behaviours(rng)
    cuts = qf.segment(spoil(rng, q.copy(), 0.05), fps=120)
    assert len(cuts) == 2
    assert (np.abs(cuts - np.cumsum(PARTS)[:2]) < 30).all()
    assert len(qf.segment(np.full_like(q, np.nan), fps=120)) == 0


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_one_behaviour_is_not_cut(backend, dtype):
    assert backend.segment
    rng = np.random.default_rng(4)
    assert len(qf.segment(clips.walk(rng, 1500, 4).astype(dtype), fps=120)) == 0
    still = np.tile(clips.random_rotations(rng, 4), (1500, 1, 1)).astype(dtype)
    assert len(qf.segment(still, fps=120)) == 0
    assert len(qf.segment(clips.noisy(rng, still, 1e-4).astype(dtype), fps=120)) == 0


def test_seconds_are_seconds(backend):
    assert backend.segment
    q = behaviours(np.random.default_rng(5))
    cuts = qf.segment(q, window=2.0, min_length=1.0, fps=120)
    np.testing.assert_array_equal(qf.segment(q, window=240, min_length=120), cuts)
    np.testing.assert_array_equal(qf.segment(q), cuts)
    coarse = qf.segment(q[::2], fps=60)
    assert len(coarse) == len(cuts)
    assert (np.abs(coarse * 2 - cuts) <= 12).all()


def test_a_frame_rate_moves_no_clear_cut(backend):
    """Behaviours that differ are cut apart at the same time, whatever the frame rate; growth is that of fewer frames."""
    phase = 2 * np.pi * np.arange(1440)[:, None, None] / 144
    s, c = np.sin(phase), np.cos(2 * phase)
    q = np.concatenate(
        [
            qf.exp(s * [[0.4, 0.0, 0.0], [0.1, 0.2, 0.0]] + c * [[0.0, 0.1, 0.0], [0.0, 0.0, 0.1]]),
            qf.exp(s * [[0.0, 0.3, 0.05], [0.2, 0.0, 0.1]] + c * [[0.1, 0.0, 0.2], [0.0, 0.3, 0.0]]),
        ]
    )
    times = [
        backend.segment(q[::step].copy(), 1, 240 // step, 120 // step, 60 // step, 3.0) for step in (1, 2, 4)
    ]
    assert len(times[0][0]) > 0
    for (cuts, growth, _), step in zip(times, (1, 2, 4), strict=True):
        np.testing.assert_allclose(cuts * step, times[0][0], atol=8)
        ours, theirs = step * growth[300 // step : 1200 // step], times[0][1][300:1200:step]
        np.testing.assert_allclose(ours.mean(), theirs.mean(), rtol=0.02)


def test_segments_are_as_long_as_they_must(backend):
    assert backend.segment
    q = clips.smooth(np.random.default_rng(6), 1500, 4)
    cuts = qf.segment(q, window=20, min_length=100, threshold=0.0)
    assert len(cuts) > 3
    assert (np.diff([0, *cuts, len(q)]) >= 100).all()


@pytest.mark.parametrize("frames", [0, 1, 2, 100])
def test_short_clips_have_no_cuts(backend, frames):
    assert backend.segment
    cuts = qf.segment(clips.smooth(np.random.default_rng(7), frames, 2), fps=120)
    assert cuts.dtype == np.intp
    assert cuts.shape == (0,)
