"""Arguments as people have them: masked arrays, rates from files, confidences with rounding errors, clips of nothing."""

import threading

import clips
import numpy as np
import pytest
import quatfilt as qf


def clip(frames=60):
    return clips.smooth(np.random.default_rng(1), frames, 2)


def test_masked_samples_are_missing():
    q = clip()
    gone = np.zeros(q.shape, bool)
    gone[20:24, 1] = True
    spoilt = np.where(gone, 0.5, q)
    expected = qf.gaussian(np.where(gone, np.nan, q), sigma=2)
    np.testing.assert_array_equal(qf.gaussian(np.ma.MaskedArray(spoilt, gone), sigma=2), expected)


def test_masked_confidences_are_0():
    q, trust = clip(), np.ones((60, 2))
    gone = np.zeros(trust.shape, bool)
    gone[20:24, 1] = True
    expected = qf.gaussian(q, sigma=2, confidence=np.where(gone, 0, trust))
    np.testing.assert_array_equal(
        qf.gaussian(q, sigma=2, confidence=np.ma.MaskedArray(trust, gone)), expected
    )


def test_arrays_without_dimensions_are_numbers():
    q = clip()
    expected = qf.butterworth(q, cutoff=6, fps=120)
    np.testing.assert_array_equal(qf.butterworth(q, cutoff=np.array(6), fps=np.array(120.0)), expected)
    with pytest.raises(TypeError, match="fps: expected a number above 0, got ndarray"):
        qf.butterworth(q, cutoff=6, fps=np.array([120.0]))


def test_confidences_with_rounding_errors():
    q = clip().astype(np.float32)
    above = np.full(60, 1 + 2.4e-7, np.float32)
    above[30] = -1e-9
    expected = qf.gaussian(q, sigma=2, confidence=np.clip(above, 0, 1))
    np.testing.assert_array_equal(qf.gaussian(q, sigma=2, confidence=above), expected)
    with pytest.raises(ValueError, match=r"confidence: expected values from 0 to 1, got 1\.01"):
        qf.gaussian(q, sigma=2, confidence=np.full(60, 1.01))


def test_the_mean_of_nothing_is_missing():
    result = qf.mean(np.zeros((0, 3, 4)))
    assert result.shape == (3, 4)
    assert np.isnan(result).all()
    assert qf.mean(np.zeros((5, 0, 4))).shape == (0, 4)


def test_a_preset_in_hertz_asks_for_the_frame_rate():
    with pytest.raises(ValueError, match="preset 'video' needs the frame rate: pass fps=30"):
        qf.denoise(clip(), preset="video")


def test_backends_of_threads_that_overlap():
    entered, left = threading.Event(), threading.Event()

    def first():
        with qf.use_backend("numpy"):
            entered.set()
            assert left.wait(10)

    before = qf.get_backend()
    other = threading.Thread(target=first)
    with qf.use_backend("numpy"):
        other.start()
        assert entered.wait(10)
    assert qf.get_backend() == "numpy"
    left.set()
    other.join()
    assert qf.get_backend() == before


def test_backends_chosen_one_after_the_other():
    before = qf.get_backend()
    with qf.use_backend("rust"):
        for name in ("numpy", "rust", "numpy", "numpy"):
            qf.use_backend(name)
            assert qf.get_backend() == name
            with qf.use_backend("rust"):
                assert qf.get_backend() == "rust"
            assert qf.get_backend() == name
    assert qf.get_backend() == before
