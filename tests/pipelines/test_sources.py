"""`denoise` on streams whose frames were not all measured."""

import clips
import numpy as np
import pytest
import quatfilt as qf
import sources


def mean_error(a, b):
    return float(np.degrees(clips.angles(a, b)).mean())


@pytest.fixture(scope="module", name="walk")
def noisy_walk():
    rng = np.random.default_rng(0)
    truth = clips.walk(rng, 480, 10)
    return rng, truth, clips.noisy(rng, truth, 0.03)


@pytest.mark.parametrize("make", [sources.held, sources.interpolated])
def test_the_source_is_cleaned_at_its_rate(walk, make):
    rng, truth, noisy = walk
    stream = make(rng, noisy)
    error = mean_error(truth, qf.denoise(stream, fps=120))
    for rival in (stream, qf.butterworth(stream, cutoff=6, fps=120), qf.kalman(stream, fps=120)):
        assert error < 0.85 * mean_error(truth, rival)


def test_frozen_frames_stay_and_the_rest_is_cleaned(walk):
    _, truth, noisy = walk
    stream = noisy.copy()
    stream[:240] = stream[0]
    clean = qf.denoise(stream, fps=120)
    np.testing.assert_array_equal(clean[:240], stream[:240])
    assert mean_error(truth[240:], clean[240:]) < 0.5 * mean_error(truth[240:], stream[240:])


def test_presets_know_sources_too_and_single_filters_do_not(walk):
    rng, truth, noisy = walk
    stream = sources.held(rng, noisy)
    for preset in ("optical", "inertial"):
        assert mean_error(truth, qf.denoise(stream, preset=preset, fps=120)) < 0.7 * mean_error(truth, stream)
    np.testing.assert_array_equal(qf.denoise(stream, method="smooth", fps=120), qf.smooth(stream, fps=120))


def test_without_a_frame_rate_interpolated_streams_are_warned_of_once(walk):
    rng, _, noisy = walk
    stream = sources.interpolated(rng, noisy)
    with pytest.warns(UserWarning, match="pass fps=") as said:
        qf.denoise(stream)
    assert len(said) == 1


def test_translation_missing_samples_and_confidence_go_along(walk):
    rng, truth, noisy = walk
    stream = sources.held(rng, noisy)
    stream[100:104, 2] = np.nan
    path = np.repeat(clips.path(rng, 480)[::4], 4, axis=0)
    path[200:204] = np.nan
    before = stream.copy(), path.copy()
    skeleton = qf.Skeleton([f"j{j}" for j in range(10)], [-1, *range(9)], np.ones((10, 3)))
    motion = qf.Motion(stream, path, fps=120, skeleton=skeleton)
    clean = qf.denoise(motion)
    assert np.isfinite(clean.rotations).all()
    assert np.isfinite(clean.translation).all()
    kept = qf.denoise(motion, gaps="keep")
    assert np.isnan(kept.rotations[101, 2]).all()
    assert np.isnan(kept.translation[201]).all()
    np.testing.assert_array_equal(motion.rotations, before[0])
    np.testing.assert_array_equal(motion.translation, before[1])
    weighed = qf.denoise(stream, fps=120, confidence=np.ones((480, 10)), gaps="fill")
    assert mean_error(truth, weighed) < mean_error(truth, noisy)
    with pytest.raises(ValueError, match="no missing samples"):
        qf.denoise(stream, fps=120, gaps="raise")


def test_jitter_of_video_is_calmed_where_the_rate_is_known():
    rng = np.random.default_rng(2)
    truth = clips.walk(rng, 300, 6)
    shaken = sources.video(rng, truth, level=0.2, rho=0.8)
    assert mean_error(truth, qf.denoise(shaken, fps=30)) < mean_error(truth, shaken)


def test_video_is_decided_along_time():
    """Half of the clip is shaken: it gets calmer, and the far end of the other half stays as the chain alone leaves it."""
    rng = np.random.default_rng(6)
    truth = clips.walk(rng, 2400, 6)[::4]
    shaken = truth.copy()
    shaken[300:] = sources.video(rng, truth[300:], level=0.08, rho=0.8)
    result = qf.denoise(shaken, preset="video", fps=30)
    chain = qf.denoise(shaken, preset="optical", max_gap=2 / 3, fps=30)
    assert mean_error(result[:150], chain[:150]) < 1e-3
    assert mean_error(result[400:], chain[400:]) > 0.1
    assert mean_error(truth[400:], result[400:]) < mean_error(truth[400:], shaken[400:])


@pytest.mark.parametrize("sigma", [0.0, 0.02, 0.05])
def test_video_leaves_quick_claps(sigma):
    time = np.arange(150)[:, None, None] / 30
    clap = clips.from_vectors(np.sin(8 * np.pi * time) * np.array([[0.0, 0.0, 1.0]] * 3))
    noisy = sources.video(np.random.default_rng(7), clap, level=sigma, rho=0.8)
    result = qf.denoise(noisy, preset="video", fps=30)
    assert mean_error(clap, result) <= max(mean_error(clap, noisy), 1e-4)


@pytest.mark.parametrize("gaps", ["fill", "keep"])
def test_video_takes_translation_and_missing_samples_along(gaps):
    rng = np.random.default_rng(8)
    shaken = sources.video(rng, clips.walk(rng, 800, 4)[::4], level=0.1, rho=0.8)
    shaken[50:54, 1] = np.nan
    path = clips.path(rng, 200)
    path[90:93] = np.nan
    skeleton = qf.Skeleton(list("abcd"), [-1, 0, 1, 2], np.ones((4, 3)))
    clean = qf.denoise(qf.Motion(shaken, path, fps=30, skeleton=skeleton), preset="video", gaps=gaps)
    missing = np.isnan(clean.rotations).any(axis=(1, 2)), np.isnan(clean.translation).any(axis=1)
    kept = gaps == "keep"
    np.testing.assert_array_equal(np.flatnonzero(missing[0]), np.arange(50, 54) if kept else [])
    np.testing.assert_array_equal(np.flatnonzero(missing[1]), np.arange(90, 93) if kept else [])


@pytest.mark.parametrize("fps", [30, 60, 120])
def test_clean_motion_and_claps_are_hardly_changed(fps):
    rng = np.random.default_rng(3)
    truth = clips.walk(rng, 480, 5)[:: 120 // fps]
    assert mean_error(truth, qf.denoise(truth, fps=fps)) < 0.05
    time = np.arange(len(truth)) / fps
    clap = clips.from_vectors(np.sin(8 * np.pi * time)[:, None, None] * np.array([[0.0, 0.0, 0.5]] * 3))
    assert mean_error(clap, qf.denoise(clap, fps=fps)) < 0.2


@pytest.mark.parametrize("frames", [0, 1, 2, 5, 30])
def test_constant_and_short_clips_come_back(frames):
    q = np.tile(clips.random_rotations(np.random.default_rng(4), 3), (frames, 1, 1))
    assert mean_error(q, qf.denoise(q, fps=30)) < 1e-5 if frames else len(qf.denoise(q, fps=30)) == 0
