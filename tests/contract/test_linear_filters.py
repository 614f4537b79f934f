"""What is peculiar to the filters for numbers: derivatives, short sides of gaps, the translation, the wavelets' package."""

import sys

import clips
import numpy as np
import pytest
import quatfilt as qf
from quatfilt.filters import butterworth, gaussian, savgol, wavelet, weighted_moving_mean
from scipy import signal
from scipy.ndimage import gaussian_filter1d

MISSING = {"confidence": None, "gaps": "fill", "max_gap": None, "scalar_first": True}


def clip(frames=90, joints=3, seed=0):
    rng = np.random.default_rng(seed)
    return qf.continuous(clips.noisy(rng, clips.smooth(rng, frames, joints), 0.03))


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("order", [1, 2])
def test_derivatives_have_three_components(order, dtype):
    q = clip().astype(dtype)
    before = q.tobytes()
    result = qf.savgol(q, window_length=9, deriv=order)
    assert result.shape == (90, 3, 3)
    assert result.dtype == dtype
    assert q.tobytes() == before
    alone = qf.savgol(q[:, 1], window_length=9, deriv=order)
    np.testing.assert_array_equal(alone, result[:, 1])
    last = qf.savgol(np.roll(q, -1, axis=-1), window_length=9, deriv=order, scalar_first=False)
    np.testing.assert_array_equal(last, result)
    np.testing.assert_array_equal(qf.savgol(q[:0], window_length=9, deriv=order), np.zeros((0, 3, 3), dtype))


def test_derivatives_beside_gaps():
    q = clip()
    q[40:44, 1] = np.nan
    velocity = {"window_length": 5, "deriv": 1, "fps": 30}
    filled = qf.savgol(q, **velocity)
    assert np.isfinite(filled).all()
    gone = np.zeros((90, 3), bool)
    gone[40:44, 1] = True
    kept = qf.savgol(q, gaps="keep", **velocity)
    np.testing.assert_array_equal(np.isnan(kept).any(axis=-1), gone)
    np.testing.assert_array_equal(kept[~gone], filled[~gone])
    apart = qf.savgol(q, max_gap=0.1, **velocity)
    np.testing.assert_array_equal(np.isnan(apart).any(axis=-1), gone)
    alone = qf.savgol(q[44:], **velocity)
    np.testing.assert_allclose(apart[44:, 1], alone[:, 1], rtol=0, atol=1e-12)
    whole = qf.savgol(clip(), **velocity)
    np.testing.assert_allclose(apart[:, [0, 2]], whole[:, [0, 2]], rtol=0, atol=1e-12)


def test_sides_that_are_shorter_than_the_window():
    """Of five frames a window of five is left, of two one of one, which has no velocity."""
    q = clip(20, 1)
    q[5:8] = q[10:13] = np.nan
    smooth = qf.savgol(q, window_length=7, max_gap=0)
    gone = np.isnan(q).any(axis=-1)
    np.testing.assert_array_equal(np.isnan(smooth).any(axis=-1), gone)
    expected = qf.savgol(q[:5], window_length=5)
    np.testing.assert_allclose(smooth[:5], expected, rtol=0, atol=1e-14)
    np.testing.assert_allclose(smooth[8:10], q[8:10], rtol=0, atol=1e-14)
    velocity = qf.savgol(q, window_length=7, max_gap=0, deriv=1)
    gone[8:10] = True
    np.testing.assert_array_equal(np.isnan(velocity).any(axis=-1), gone)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (
            {"window_length": 5, "polyorder": 0},
            "polyorder: expected an integer of at least 1 and at most 4, got 0",
        ),
        (
            {"window_length": 7, "frames": 6},
            "window_length: expected at most as many as the clip's 6 frames, got 7",
        ),
        (
            {"window_length": 5, "frames": 1},
            "window_length: expected at most as many as the clip's 1 frames, got 5",
        ),
    ],
)
def test_windows_without_a_velocity(options, message):
    frames = options.pop("frames", 90)
    with pytest.raises(ValueError, match="expected") as caught:
        qf.savgol(clip(frames), deriv=1, **options)
    assert str(caught.value) == message


def test_a_motion_is_not_differentiated():
    with pytest.raises(ValueError, match=r"^deriv: .*at most 0, got 1$"):
        savgol.with_translation(clip(), None, window_length=5, polyorder=3, deriv=1, fps=1.0, **MISSING)


def test_the_number_below_which_cutoffs_lie_is_half_the_frame_rate():
    q = clip()
    qf.butterworth(q, cutoff=59.9, fps=120)
    with pytest.raises(ValueError, match="Nyquist") as caught:
        qf.butterworth(q, cutoff=[6, 60, 6], fps=120)
    assert str(caught.value) == (
        "cutoff[1]: expected a number of at least 0.00012 and below the Nyquist frequency fps / 2 = 60, got 60"
    )


PER_JOINT = {
    "gaussian": (qf.gaussian, "sigma", [0.5, 2.0, 20.0]),
    "butterworth": (qf.butterworth, "cutoff", [0.02, 0.1, 0.4]),
    "wavelet": (qf.wavelet, "threshold", [0.0, 0.05, 0.5]),
}


@pytest.mark.parametrize("name", PER_JOINT)
def test_a_strength_for_each_joint(name):
    call, option, values = PER_JOINT[name]
    q = clip()
    result = call(q, **{option: values})
    for joint, value in enumerate(values):
        np.testing.assert_array_equal(result[:, joint], call(q[:, joint], **{option: value}))


def test_sigma_and_cutoff_are_seconds_and_hertz():
    q = clip()
    np.testing.assert_array_equal(qf.gaussian(q, sigma=0.05, fps=120), qf.gaussian(q, sigma=6))
    np.testing.assert_array_equal(qf.butterworth(q, cutoff=6, fps=120), qf.butterworth(q, cutoff=0.05))


WITH_TRANSLATION = {
    "butterworth": (
        lambda q, x: butterworth.with_translation(q, x, cutoff=[0.1, 0.2, 0.3], fps=1.0, order=4, **MISSING),
        lambda x: signal.sosfiltfilt(signal.butter(4, 0.1, fs=1, output="sos"), x, axis=0),
    ),
    "gaussian": (
        lambda q, x: gaussian.with_translation(q, x, sigma=[2, 3, 4], fps=1.0, boundary="mirror", **MISSING),
        lambda x: gaussian_filter1d(x, 2, axis=0, mode="mirror"),
    ),
    "savgol": (
        lambda q, x: savgol.with_translation(q, x, window_length=9, polyorder=3, deriv=0, fps=1.0, **MISSING),
        lambda x: signal.savgol_filter(x, 9, 3, axis=0),
    ),
    "weighted_moving_mean": (
        lambda q, x: weighted_moving_mean.with_translation(q, x, iterations=1, fps=1.0, **MISSING),
        lambda x: np.stack([np.convolve(c, np.array([2, 3, 2, 3, 2]) / 12, "same") for c in x.T], axis=1),
    ),
}


@pytest.mark.parametrize("name", WITH_TRANSLATION)
def test_the_translation_is_filtered_as_the_first_joint(name):
    ours, numbers = WITH_TRANSLATION[name]
    q, path = clip(), clips.path(np.random.default_rng(1), 90)
    before = path.tobytes()
    rotations, moved = ours(q, path)
    np.testing.assert_array_equal(rotations, ours(q, None)[0])
    np.testing.assert_allclose(moved[3:-3], numbers(path)[3:-3], rtol=0, atol=1e-11)
    assert path.tobytes() == before
    # Where the root is gone for long, the translation is left alone.
    q[30:60, 0] = np.nan
    options = {**MISSING, "max_gap": 5}
    _, moved = gaussian.with_translation(q, path, sigma=2, fps=1.0, boundary="mirror", **options)
    np.testing.assert_array_equal(moved[30:60], path[30:60])
    assert np.abs(moved[:30] - path[:30]).max() > 0


def test_wavelets_without_their_package(monkeypatch):
    monkeypatch.setitem(sys.modules, "pywt", None)
    with pytest.raises(ImportError, match=r"^wavelets need PyWavelets: pip install 'quatfilt\[wavelet\]'$"):
        qf.wavelet(clip())


@pytest.mark.parametrize("name", ["sym99", "Sym8", "", None, 8, "gaus1"])
def test_wavelets_that_do_not_exist(name):
    with pytest.raises(ValueError, match="expected") as caught:
        qf.wavelet(clip(), wavelet=name)
    assert str(caught.value) == (
        f"wavelet: expected a discrete wavelet of PyWavelets such as 'sym8', got {name!r}"
    )


def test_a_threshold_of_zero_changes_nothing():
    q = clip()
    np.testing.assert_allclose(qf.wavelet(q, threshold=0), q, rtol=0, atol=1e-13)
    assert wavelet.wavelet is qf.wavelet
