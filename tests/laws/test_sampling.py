"""The clock of the source: what is recognised, what is not, and what becomes of the frames."""

import clips
import numpy as np
import pytest
import sources

REGULAR, HELD, REPEATED, INTERPOLATED = range(4)

kinds = pytest.mark.parametrize("dtype", [np.float32, np.float64])


def noisy_walk(frames=360, joints=5, noise=0.01, seed=0):
    rng = np.random.default_rng(seed)
    return rng, clips.noisy(rng, clips.walk(rng, frames, joints), noise)


@kinds
def test_a_clip_of_new_frames_is_regular(backend, dtype):
    _, q = noisy_walk()
    kind, times, frozen = backend.sampling(q.astype(dtype), 120.0)
    assert kind == REGULAR
    np.testing.assert_array_equal(times, np.arange(len(q)))
    assert not frozen.any()


@pytest.mark.parametrize("noise", [0.0, 0.003, 0.05])
def test_clean_and_noisy_motion_is_not_taken_for_interpolated(backend, noise):
    for seed in range(4):
        rng, q = noisy_walk(noise=noise, seed=seed)
        assert backend.sampling(q, 120.0)[0] == REGULAR
        assert backend.sampling(clips.smooth(rng, 400, 6), 120.0)[0] == REGULAR


@pytest.mark.parametrize("every", [2, 3, 4])
def test_held_frames_are_found(backend, every):
    rng, q = noisy_walk()
    kind, times, frozen = backend.sampling(sources.held(rng, q, every), 120.0)
    assert kind == HELD
    np.testing.assert_array_equal(times, np.arange(0, len(q), every))
    assert not frozen.any()


def test_a_joint_that_never_moves_does_not_count(backend):
    rng, q = noisy_walk()
    q[:, 1:3] = q[0, 1:3]
    assert backend.sampling(q, 120.0)[0] == REGULAR
    assert backend.sampling(sources.held(rng, q), 120.0)[0] == HELD


def test_freezes_and_single_repeats_are_told_apart(backend):
    _, q = noisy_walk()
    q[50:80] = q[50]
    q[200] = q[199]
    kind, times, frozen = backend.sampling(q, 120.0)
    assert kind == REPEATED
    np.testing.assert_array_equal(np.flatnonzero(frozen), np.arange(50, 80))
    assert 200 not in times
    assert len(times) == len(q) - 30 - 1


@kinds
@pytest.mark.parametrize("noise", [0.0, 0.02])
def test_knots_of_interpolated_streams_are_found(backend, noise, dtype):
    rng, q = noisy_walk(600, 8, noise)
    stream, expected = sources.interpolated_at(rng, q)
    kind, times, _ = backend.sampling(stream.astype(dtype), 100.0)
    assert kind == INTERPOLATED
    near = np.min(np.abs(expected[:, None] - times), axis=1)
    # A knot at which the motion hardly bends cannot be seen.
    assert np.mean(near < 0.05) > 0.9
    inner = times[1:-1]
    measured = backend.knots(stream, inner)
    truth = sources.between(stream, np.arange(600.0), inner)
    assert np.median(clips.angles(measured, truth)) < 0.2 * max(noise, 0.01)


def test_a_spline_goes_through_its_samples_and_about_one_axis_is_the_cubic(backend):
    times = np.array([0.0, 1.0, 2.5, 4.0, 4.5, 7.0])
    angle = np.array([0.0, 0.4, 0.9, 0.3, -0.1, 0.2])
    q = clips.from_vectors(angle[:, None, None] * np.array([0.6, 0.0, 0.8]))
    new = np.linspace(0, 7, 43)
    from scipy.interpolate import CubicSpline

    expected = clips.from_vectors(
        CubicSpline(times, angle, bc_type="natural")(new)[:, None, None] * np.array([0.6, 0.0, 0.8])
    )
    assert clips.angles(backend.spline(q, times, new, 0.0), expected).max() < 1e-12
    assert clips.angles(backend.spline(q, times, times, 0.0), q).max() < 1e-12


def test_splines_do_not_depend_on_where_the_motion_is_seen_from(backend):
    rng, q = noisy_walk(40, 2)
    times, new = np.arange(40.0), np.linspace(0, 39, 79)
    left, right = clips.random_rotations(rng, 2)
    for cutoff in (0.0, 0.1):
        expected = clips.product(clips.product(left, backend.spline(q, times, new, cutoff)), right)
        found = backend.spline(clips.product(clips.product(left, q), right), times, new, cutoff)
        assert clips.angles(found, expected).max() < 1e-9


def test_a_jump_does_not_make_a_spline_swing(backend):
    angle = np.where(np.arange(20) < 10, 0.0, 2.5)
    q = clips.from_vectors(angle[:, None, None] * np.array([0.0, 1.0, 0.0]))
    new = np.linspace(0, 19, 191)
    found = clips.angles(backend.spline(q, np.arange(20.0), new, 0.0), np.broadcast_to(q[:1], (191, 1, 4)))
    assert found[new <= 9].max() < 1e-9
    assert np.abs(found[new >= 10] - 2.5).max() < 1e-9
    assert np.all(np.diff(found[:, 0]) > -1e-9)


def test_jitter_of_video_is_told_from_clean_motion_white_noise_and_claps(backend):
    rng = np.random.default_rng(1)
    clean = clips.walk(rng, 300, 6)
    clap = np.sin(2 * np.pi * 4 * np.arange(300) / 30)[:, None, None] * np.ones((1, 6, 1)) * [0.0, 0.0, 0.6]
    assert backend.tracker_noise(clean, 120.0)[0] == 0
    assert backend.tracker_noise(clean, 30.0)[0] == 0
    assert backend.tracker_noise(clips.from_vectors(clap), 30.0)[0] == 0
    assert backend.tracker_noise(clips.noisy(rng, clean, 0.2), 30.0)[0] == 0
    doubt, cutoff, *_ = backend.tracker_noise(sources.video(rng, clean), 30.0)
    assert doubt == 1
    assert 6.5 <= cutoff <= 7.5


def test_a_low_pass_has_its_gain_and_leaves_parabolas(backend):
    time = np.arange(300) / 30
    for hertz in (2.0, 5.0, 7.0, 10.0):
        swing = clips.from_vectors(np.sin(2 * np.pi * hertz * time)[:, None, None] * [0.05, 0.0, 0.0])
        softness = (2 * np.sin(np.pi * 7 / 30)) ** 6
        found, _ = backend.low_pass(swing, None, None, np.full(1, 1.0), softness)
        ratio = np.std(clips.rotation(found[60:-60]).as_rotvec()[:, 0])
        ratio /= np.std(clips.rotation(swing[60:-60]).as_rotvec()[:, 0])
        r = np.sin(np.pi * hertz / 30) / np.sin(np.pi * 7 / 30)
        assert ratio == pytest.approx(1 / (1 + r**6), abs=0.01)
    parabola = clips.from_vectors((0.05 * (time - 4) ** 2)[:, None, None] * [0.0, 0.6, 0.8])
    found, path = backend.low_pass(parabola, time[:, None] * np.ones(3), None, np.full(1, 1.0), 1e-3)
    assert clips.angles(found, parabola).max() < 1e-8
    np.testing.assert_allclose(path, time[:, None] * np.ones(3), atol=1e-9)
