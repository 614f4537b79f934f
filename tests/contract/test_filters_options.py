"""What the options of filters mean: per joint, in seconds, in any scale."""

import math

import clips
import numpy as np
import pytest
import quatfilt as qf
import tolerances
from contract.filters import FILTERS, FRAMES, clip
from quatfilt.filters.despike import spikes


@pytest.mark.parametrize("boundary", ["nearest", "mirror", "linear"])
@pytest.mark.parametrize("frames", [2, 3, 10])
@pytest.mark.parametrize("window", [{"search_radius": 500}, {"patch_radius": 500}, {"neighbors": 10**9}])
def test_a_window_longer_than_the_clip_works(window, frames, boundary):
    q = clip(frames=frames)
    result = qf.nonlocal_pose_means(q, boundary=boundary, bandwidth=0.03, **window)
    np.testing.assert_allclose(np.linalg.norm(result, axis=-1), 1, atol=tolerances.ALGEBRA)
    assert clips.angles(q, result).max() < 1


@pytest.mark.parametrize("scale", [1, -3, 1e300, 1e-300])
def test_masks_in_any_scale(scale):
    q = clip()
    result = qf.orientation_filter(q, scale * np.array([1.0, 2, 1]))
    assert clips.angles(result, qf.orientation_filter(q, [1, 2, 1])).max() < tolerances.ALGEBRA


def test_one_scale_of_angles_per_joint():
    q = clip()
    result = qf.bilateral(q, sigma_angle=[0.1, 0.2, math.inf])
    for joint, sigma in enumerate([0.1, 0.2, math.inf]):
        np.testing.assert_array_equal(result[:, joint], qf.bilateral(q[:, joint], sigma_angle=sigma))


def test_one_smallest_spike_per_joint():
    q = clip()
    q[40] = clips.product(q[40], clips.from_vectors(np.array([0.5, 0.3, 0])))
    result = qf.despike(q, smallest=[0.1, 0.2, 1.0])
    assert (result != q).any(axis=-1).tolist() == [
        [frame == 40, frame == 40, False] for frame in range(FRAMES)
    ]


@pytest.mark.parametrize(("fps", "spike"), [(None, True), (120, True), (50, True), (30, False)])
def test_at_low_frame_rates_a_quick_limb_is_no_spike(fps, spike):
    """12 degrees there and back within two frames: 380 rad/s² at 30 frames per second, 6000 at 120."""
    q = clip()
    q[40, 1] = clips.product(q[40, 1], clips.from_vectors(np.radians([12.0, 0, 0])))
    options = {} if fps is None else {"fps": fps}
    assert (qf.despike(q, **options) != q).any() == spike
    assert (qf.despike(q, smallest="auto", **options) != q).any() == spike
    assert spikes(q, **options).any() == spike
    assert (qf.despike(q, smallest=0.105, **options) != q).any()


def test_numbers_of_numpy_and_one_bandwidth_per_joint():
    q = clip()
    expected = qf.nonlocal_pose_means(q, search_radius=7, bandwidth=0.05)
    for radius, bandwidth in [
        (np.int8(7), np.float64(0.05)),
        (np.uint64(7), np.array(0.05)),
        (7, [0.05] * 3),
    ]:
        result = qf.nonlocal_pose_means(q, search_radius=radius, bandwidth=bandwidth)
        np.testing.assert_array_equal(result, expected)


def test_the_smoother_without_a_lookahead_is_the_forward_filter():
    q = clip()
    np.testing.assert_array_equal(qf.kalman(q, lookahead=0), qf.kalman(q, smooth=False))
    np.testing.assert_array_equal(qf.kalman(q, lookahead=FRAMES), qf.kalman(q))


@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("kalman", {"process_noise": [0.0, 0.1, 1e300], "measurement_noise": [0.1, 1e-300, 1e300]}),
        ("one_euro", {"min_cutoff": [0.1, math.inf, 1e-3], "beta": [0.0, 1.0, 1e300]}),
        ("one_euro", {"derivative_cutoff": [0.1, math.inf, 1e-300], "beta": 0.1, "min_cutoff": 0.01}),
    ],
)
def test_one_strength_per_joint(name, options):
    q = clip()
    result = FILTERS[name](q, **options)
    assert np.isfinite(result).all()
    for joint in range(3):
        own = {option: np.broadcast_to(value, 3)[joint] for option, value in options.items()}
        np.testing.assert_array_equal(result[:, joint], FILTERS[name](q[:, joint], **own))


@pytest.mark.parametrize("smooth", [True, False])
def test_automatic_noises_are_those_of_each_joint(smooth):
    q = clips.noisy(np.random.default_rng(2), clip(), np.array([0.01, 0.03, 0.1])[:, None])
    result = qf.kalman(q, smooth=smooth)
    for joint in range(3):
        np.testing.assert_array_equal(result[:, joint], qf.kalman(q[:, joint], smooth=smooth))


def test_times_are_seconds_with_a_frame_rate():
    q = clip()
    rate = 120.0
    np.testing.assert_allclose(
        qf.kalman(q, fps=rate, process_noise=0.01 * rate**1.5, measurement_noise=0.03),
        qf.kalman(q, process_noise=0.01, measurement_noise=0.03),
        rtol=0,
        atol=tolerances.FLOAT64,
    )
    np.testing.assert_allclose(
        qf.one_euro(q, fps=rate, min_cutoff=0.02 * rate, beta=0.1, derivative_cutoff=0.05 * rate),
        qf.one_euro(q, min_cutoff=0.02, beta=0.1, derivative_cutoff=0.05),
        rtol=0,
        atol=tolerances.FLOAT64,
    )


def test_confidence_per_frame_and_without_a_number():
    q = clip()
    trust = np.random.default_rng(0).random(FRAMES)
    expected = qf.nonlocal_pose_means(q, confidence=np.repeat(trust[:, None], 3, axis=1))
    np.testing.assert_array_equal(qf.nonlocal_pose_means(q, confidence=trust), expected)
    trust[30:33] = 0
    unknown = np.where(trust == 0, np.nan, trust)
    expected = qf.nonlocal_pose_means(q, confidence=trust)
    np.testing.assert_array_equal(qf.nonlocal_pose_means(q, confidence=unknown), expected)


def test_a_library_is_a_clip_or_a_list_of_clips():
    rng = np.random.default_rng(0)
    q, other = clips.noisy(rng, clips.smooth(rng, 40, 3), 0.1), clips.smooth(rng, 30, 3)
    result = qf.nonlocal_pose_means(q, library=[other, q])
    np.testing.assert_array_equal(
        qf.nonlocal_pose_means(q, library=np.concatenate([other])),
        qf.nonlocal_pose_means(q, library=(other,)),
    )
    np.testing.assert_array_equal(
        result, qf.nonlocal_pose_means(q, library=[other, q], chart="local", neighbors=32)
    )
    last = [np.roll(clip, -1, axis=-1) for clip in (q, other)]
    found = qf.nonlocal_pose_means(last[0], library=[last[1], last[0]], scalar_first=False)
    np.testing.assert_array_equal(np.roll(found, 1, axis=-1), result)
    chain = {"method": "nonlocal_pose_means", "library": [last[1], last[0]], "scalar_first": False}
    np.testing.assert_array_equal(np.roll(qf.denoise(last[0], **chain), 1, axis=-1), result)
    single = qf.nonlocal_pose_means(q[:, 0], library=other[:, 0])
    np.testing.assert_array_equal(single, qf.nonlocal_pose_means(q[:, :1], library=other[:, :1])[:, 0])
    np.testing.assert_array_equal(qf.nonlocal_pose_means(q[:, 0], library=other[:, 0].tolist()), single)
    np.testing.assert_array_equal(
        qf.nonlocal_pose_means(q, library=other.tolist()), qf.nonlocal_pose_means(q, library=other)
    )
    np.testing.assert_array_equal(qf.nonlocal_pose_means(q, library=[other.tolist(), q.tolist()]), result)
    gaps = q.copy()
    gaps[10:15, 1] = np.nan
    gaps[20:, 2] = np.nan
    kept = qf.nonlocal_pose_means(gaps, library=[other], gaps="keep", max_gap=8)
    np.testing.assert_array_equal(np.isnan(kept), np.isnan(gaps))


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"library": ()}, "library: expected a clip or a list of clips, got an empty list"),
        ({"library": [np.ones((4, 2, 4)) / 2]}, "library[0]: expected 3 joints as in the clip, got 2"),
        ({"library": np.ones((4, 3, 4)) / 2, "chart": "identity"}, "chart: expected 'mean' or 'local' with a library, got 'identity'"),
    ],
)  # fmt: skip
def test_what_a_library_does_not_go_with_is_named(options, message):
    q = clips.smooth(np.random.default_rng(2), 30, 3)
    with pytest.raises(ValueError) as caught:
        qf.nonlocal_pose_means(q, **options)
    assert str(caught.value) == message
