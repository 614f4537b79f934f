"""Filters on vectors about a reference path against SciPy's filters for numbers, and against Lee and Shin's."""

import functools
import itertools
import warnings
from fractions import Fraction

import clips
import numpy as np
import pytest
import pywt
import quatfilt as qf
import tolerances
from quatfilt.filters import wavelet
from scipy import signal
from scipy.ndimage import gaussian_filter1d
from scipy.spatial.transform import Rotation

AXIS = np.array([2.0, -1, 2]) / 3

SIGMA = 3.0


def smooth_keys(fcurve):
    """Blender's smooth_fcurve, line by line."""
    total = len(fcurve)
    keys = list(fcurve)
    if total >= 3:
        for i in range(total):
            if i in {0, total - 1}:
                continue
            p1 = fcurve[i - 1]
            p2 = fcurve[i - 2] if i - 2 > 0 else p1
            c1 = fcurve[i]
            n1 = fcurve[i + 1]
            n2 = fcurve[i + 2] if i + 2 < total else n1
            y1 = (3 * p2 + 5 * p1 + 2 * c1 + n1 + n2) / 12
            y3 = (p2 + p1 + 2 * c1 + 5 * n1 + 3 * n2) / 12
            keys[i] = (y1 + y3) / 2
    return keys


def blender(columns, iterations):
    for _ in range(iterations):
        columns = np.stack([smooth_keys(column) for column in columns.T], axis=1)
    return columns


def solved(matrix, columns):
    """Solve a system of fractions by Gauss and Jordan, exactly."""
    rows = [[*row, *column] for row, column in zip(matrix, columns, strict=True)]
    for i in range(len(rows)):
        pivot = next(k for k in range(i, len(rows)) if rows[k][i])
        rows[i], rows[pivot] = rows[pivot], rows[i]
        rows[i] = [x / rows[i][i] for x in rows[i]]
        for k, row in enumerate(rows):
            if k != i:
                rows[k] = [x - row[i] * y for x, y in zip(row, rows[i], strict=True)]
    return [row[len(rows) :] for row in rows]


@functools.cache
def polynomial_fit(window, degree, order):
    """What turns a window of numbers into a derivative of the polynomial of least squares at each of its places.

    The normal equations are solved in fractions: SciPy's least squares lose digits, how many depends on the processor.
    """
    places = [Fraction(place) for place in range(-(window // 2), window // 2 + 1)]
    powers = range(degree + 1)
    terms = [[place**k for k in powers] for place in places]
    normal = [[sum(row[i] * row[k] for row in terms) for k in powers] for i in powers]
    fit = solved(normal, [[row[k] for row in terms] for k in powers])
    for _ in range(order):
        fit = [[k * x for x in fit[k]] for k in range(1, len(fit))]
    values = [
        [sum(place**k * row[i] for k, row in enumerate(fit)) for i in range(window)] for place in places
    ]
    return np.array(values, np.float64)


def savitzky_golay(x, window, degree, order=0, fps=1.0):
    """SciPy's ``savgol_filter`` with ``mode="interp"``, with coefficients that are right to the last digit."""
    fit = polynomial_fit(window, degree, order)
    radius = window // 2
    middle = np.stack([fit[radius] @ x[t : t + window] for t in range(len(x) - window + 1)])
    return fps**order * np.concatenate([fit[:radius] @ x[:window], middle, fit[radius + 1 :] @ x[-window:]])


FILTERS = {
    "butterworth": (
        lambda q: qf.butterworth(q, cutoff=6, fps=120),
        lambda x: signal.sosfiltfilt(signal.butter(4, 6, fs=120, output="sos"), x, axis=0),
    ),
    "butterworth of odd order": (
        lambda q: qf.butterworth(q, cutoff=0.05, order=3),
        lambda x: signal.sosfiltfilt(signal.butter(3, 0.05, fs=1, output="sos"), x, axis=0),
    ),
    "gaussian": (
        lambda q: qf.gaussian(q, sigma=SIGMA),
        lambda x: gaussian_filter1d(x, SIGMA, axis=0, mode="mirror"),
    ),
    "gaussian, nearest": (
        lambda q: qf.gaussian(q, sigma=SIGMA / 120, fps=120, boundary="nearest"),
        lambda x: gaussian_filter1d(x, SIGMA, axis=0, mode="nearest"),
    ),
    "savgol": (
        lambda q: qf.savgol(q, window_length=11),
        lambda x: savitzky_golay(x, 11, 3),
    ),
    "savgol of degree 4": (
        lambda q: qf.savgol(q, window_length=21, polyorder=4),
        lambda x: savitzky_golay(x, 21, 4),
    ),
    "weighted_moving_mean": (qf.weighted_moving_mean, lambda x: blender(x, 1)),
    "weighted_moving_mean, 4 times": (
        lambda q: qf.weighted_moving_mean(q, iterations=4),
        lambda x: blender(x, 4),
    ),
}
"""A filter of rotations, and the same for columns of numbers."""

every_filter = pytest.mark.parametrize("name", FILTERS)


def one_axis(frames, seed=0):
    """Angles that turn far, with noise."""
    rng = np.random.default_rng(seed)
    return 0.05 * np.arange(frames) + np.sin(np.arange(frames) / 15) + rng.normal(0, 0.15, frames)


@pytest.mark.parametrize("order", [0, 1, 2])
@pytest.mark.parametrize(("window", "degree"), [(5, 2), (21, 4), (31, 5)])
def test_polynomials_are_fitted_as_by_scipy(window, degree, order):
    """Its coefficients are off by roundings times the condition of powers up to the fifth of 15: some 1e7."""
    x = one_axis(60)
    expected = signal.savgol_filter(x, window, degree, deriv=order)
    np.testing.assert_allclose(savitzky_golay(x, window, degree, order), expected, rtol=0, atol=1e-8)


@every_filter
@pytest.mark.parametrize("frames", [30, 31, 200, 1000])
def test_angles_about_one_axis_are_filtered_as_numbers(backend, name, frames):
    assert backend is not None
    angle = one_axis(frames)
    ours, numbers = FILTERS[name]
    expected = clips.from_vectors(numbers(angle[:, None]) * AXIS)
    # Angles of fifty radians.
    assert (
        clips.angles(ours(clips.from_vectors(angle[:, None] * AXIS)), expected).max()
        < 10 * tolerances.FLOAT64
    )


@every_filter
def test_small_rotation_vectors_are_filtered_alike(backend, name):
    """What differs are products of three angles: half the angles leave a quarter of the relative difference."""
    assert backend is not None
    rng = np.random.default_rng(1)
    wave = np.sin(np.arange(200)[:, None] / np.array([9.0, 13, 17])) + rng.normal(0, 0.3, (200, 3))
    ours, numbers = FILTERS[name]
    errors = []
    for scale in (0.2, 0.1, 0.05):
        vectors = scale * wave
        expected = Rotation.from_rotvec(numbers(vectors))
        result = clips.rotation(ours(clips.from_vectors(vectors)))
        errors.append((expected.inv() * result).magnitude().max() / scale)
    assert errors[0] < 0.002
    for before, after in itertools.pairwise(errors):
        assert before / 4.4 < after < before / 3.6


def test_lee_and_shin_filter_alike_where_the_noise_is_small(backend):
    """About a smooth path or about the noisy one: what differs are commutators."""
    assert backend is not None
    rng = np.random.default_rng(2)
    clean = clips.smooth(rng, 300, 2)
    lags = np.arange(-12, 13)
    mask = np.exp(-(lags**2) / (2 * SIGMA**2))
    noise = rng.standard_normal((300, 2, 3))
    errors = []
    for scale in (0.04, 0.02, 0.01):
        q = clips.product(clean, clips.from_vectors(scale * noise))
        result, expected = qf.gaussian(q, sigma=SIGMA), qf.orientation_filter(q, mask)
        errors.append(clips.angles(result, expected).max())
    assert errors[0] < 0.02
    assert errors[1] < errors[0] / 1.5
    assert errors[2] < errors[1] / 1.5


def test_gaps_weigh_nothing(backend):
    """What was filled in has confidence 0: with SciPy, a normalised convolution."""
    assert backend is not None
    angle = one_axis(200)
    there = np.ones(200)
    there[[50, 51, 52, 90]] = 0
    q = clips.from_vectors(angle[:, None] * AXIS)
    q[there == 0] = np.nan
    mean, weight = (gaussian_filter1d(x, SIGMA, mode="mirror") for x in (there * angle, there))
    expected = clips.from_vectors((mean / weight)[:, None] * AXIS)
    assert clips.angles(qf.gaussian(q, sigma=SIGMA), expected).max() < 1e-11


def test_half_of_a_sine_at_the_cutoff_is_left(backend):
    assert backend is not None
    fps, cutoff = 100, 5
    sine = np.sin(2 * np.pi * cutoff * np.arange(1000) / fps)
    q = clips.from_vectors(sine[:, None] * AXIS)
    for order in (2, 4, 5):
        left = qf.butterworth(q, cutoff=cutoff, fps=fps, order=order)
        expected = clips.from_vectors((sine / 2)[:, None] * AXIS)
        assert clips.angles(left, expected)[300:-300].max() < 1e-3


@pytest.mark.parametrize("frames", [2, 3, 8, 15, 16])
def test_shorter_clips_than_scipy_takes(backend, frames):
    """Its padding of 15 frames is then one frame less than there are."""
    assert backend is not None
    angle = one_axis(frames)
    sections = signal.butter(4, 6, fs=120, output="sos")
    smooth = signal.sosfiltfilt(sections, angle, padlen=min(15, frames - 1))
    result = qf.butterworth(clips.from_vectors(angle[:, None] * AXIS), cutoff=6, fps=120)
    assert clips.angles(result, clips.from_vectors(smooth[:, None] * AXIS)).max() < tolerances.FLOAT64


def wandering(fps):
    """Six seconds of three joints that swing and turn, sampled `fps` times a second."""
    times = np.arange(6 * fps + 1) / fps
    vectors = np.sin(
        2 * np.pi * times[:, None, None] * np.array([[0.5, 0.8, 0.3], [1.1, 0.4, 0.7], [0.2, 0.9, 1.3]])
    )
    spin = clips.from_vectors(3 * times[:, None, None] * AXIS)
    return clips.product(spin, clips.from_vectors(vectors))


@pytest.mark.parametrize(
    "filtered",
    [
        lambda q, fps: qf.gaussian(q, sigma=0.05, fps=fps),
        lambda q, fps: qf.butterworth(q, cutoff=3, fps=fps),
    ],
    ids=["gaussian", "butterworth"],
)
def test_twice_the_frame_rate_gives_the_same(backend, filtered):
    """Within 1 % of what the filter does, a second from the ends: SciPy's padding counts frames."""
    assert backend is not None
    slow, fast = (filtered(wandering(fps), fps) for fps in (120, 240))
    done = clips.angles(slow, wandering(120))[120:-120]
    assert clips.angles(slow, fast[::2])[120:-120].max() < 0.01 * done.max()


# ---- derivatives


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize(("window", "degree"), [(5, 2), (11, 3), (31, 5)])
def test_derivatives_about_one_axis_are_those_of_numbers(backend, window, degree, order):
    assert backend is not None
    angle = one_axis(300)
    result = qf.savgol(
        clips.from_vectors(angle[:, None] * AXIS),
        window_length=window,
        polyorder=degree,
        deriv=order,
        fps=120,
    )
    expected = savitzky_golay(angle, window, degree, order, fps=120)
    size = np.abs(expected).max()
    np.testing.assert_allclose(result, expected[:, None] * AXIS, rtol=0, atol=tolerances.FLOAT64 * size)


def test_a_steady_turn_has_its_velocity_everywhere(backend):
    assert backend is not None
    rate = np.array([7.0, -2, 4])
    tilt = clips.random_rotations(np.random.default_rng(3), 1)
    q = clips.product(tilt, clips.from_vectors(np.arange(500)[:, None] / 120 * rate))
    velocity = qf.savgol(q, window_length=11, deriv=1, fps=120)
    np.testing.assert_allclose(velocity, np.tile(rate, (500, 1)), rtol=0, atol=1e-9)
    acceleration = qf.savgol(q, window_length=11, deriv=2, fps=120)
    np.testing.assert_allclose(acceleration, 0, rtol=0, atol=1e-6)


SPIN, ROUND, TILT = 9.0, 6.0, 0.7
"""A top: rad/s about its own axis, rad/s with which that goes round the vertical, and the angle between the two."""


def precession(fps):
    """Four seconds of a top, with its angular velocity and acceleration in its own frame."""
    times = np.arange(4 * fps)[:, None] / fps
    upright, leaning = np.array([0.0, 0, 1]), clips.from_vectors(np.array([TILT, 0, 0]))
    q = clips.product(
        clips.from_vectors(ROUND * times * upright),
        clips.product(leaning, clips.from_vectors(SPIN * times * upright)),
    )
    sine, cosine = np.sin(SPIN * times), np.cos(SPIN * times)
    around = ROUND * np.sin(TILT)
    velocity = np.hstack([around * sine, around * cosine, 0 * times + SPIN + ROUND * np.cos(TILT)])
    acceleration = around * SPIN * np.hstack([cosine, -sine, 0 * times])
    return q, velocity, acceleration


def test_the_velocity_of_a_top(backend):
    """At twice the frame rate a sixteenth of what the velocity lacks is left, and a quarter of what the acceleration does."""
    assert backend is not None
    errors = []
    for fps in (120, 240):
        q, velocity, acceleration = precession(fps)
        result = qf.savgol(q, window_length=9, polyorder=4, deriv=1, fps=fps)
        error = np.linalg.norm(result - velocity, axis=1)
        assert error.max() < 6 * error[10:-10].max()
        changes = qf.savgol(q, window_length=9, polyorder=4, deriv=2, fps=fps)
        errors.append((error[10:-10].max(), np.abs(changes - acceleration)[10:-10].max()))
    (slow, slow_change), (fast, fast_change) = errors
    assert slow < 4e-6
    assert slow_change < 0.012
    assert fast < slow / 14
    assert fast_change < slow_change / 3.8


def test_the_velocity_of_a_noisy_top(backend):
    """Where the vectors of the samples are large, they still are seen from the path."""
    assert backend is not None
    q, velocity, _ = precession(120)
    noisy = clips.noisy(np.random.default_rng(4), q, 0.05)
    result = qf.savgol(noisy, window_length=31, polyorder=3, deriv=1, fps=120)
    alone = signal.savgol_filter(
        np.random.default_rng(5).normal(0, 0.05, (10_000, 3)), 31, 3, deriv=1, delta=1 / 120, axis=0
    )
    error = (result - velocity)[40:-40]
    exact = (qf.savgol(q, window_length=31, polyorder=3, deriv=1, fps=120) - velocity)[40:-40]
    assert np.sqrt(np.mean((error - exact) ** 2)) < 1.3 * alone.std()


# ---- wavelets


def shrunk(angle, rule, sigma):
    """Soft thresholds as printed, level by level, with PyWavelets' own multilevel transform."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Level value of .* is too high")
        coarse, *details = pywt.wavedec(angle, "sym8", level=pywt.dwt_max_level(2 * len(angle), 16))
    for i, detail in enumerate(details):
        if rule == "universal":
            limit = sigma * np.sqrt(2 * np.log(len(angle)))
        elif rule == "bayes":
            excess = np.mean(detail**2) - sigma**2
            limit = sigma**2 / np.sqrt(excess) if excess > 0 else np.abs(detail).max()
        else:
            limit = rule
        details[i] = pywt.threshold(detail, limit, mode="soft")
    return pywt.waverec([coarse, *details], "sym8")[: len(angle)]


@pytest.mark.parametrize("rule", ["auto", "bayes", "universal", 0.2])
@pytest.mark.parametrize("frames", [13, 15, 200, 301])
def test_wavelet_shrinkage_about_one_axis_is_that_of_numbers(backend, frames, rule):
    assert backend is not None
    angle = one_axis(frames)
    q = clips.from_vectors(angle[:, None] * AXIS)
    expected = shrunk(angle, "bayes" if rule == "auto" else rule, qf.noise_level(q))
    result = qf.wavelet(q, threshold=rule)
    assert clips.angles(result, clips.from_vectors(expected[:, None] * AXIS)).max() < 1e-9


def test_the_translation_is_shrunk_by_its_own_noise(backend):
    assert backend is not None
    rng = np.random.default_rng(6)
    clean = np.stack([np.sin(np.arange(600) / 40), np.cos(np.arange(600) / 55), np.arange(600) / 100], axis=1)
    path = clean + rng.normal(0, 0.05, clean.shape)
    still = np.tile([1.0, 0, 0, 0], (600, 1, 1))
    missing = {"confidence": None, "gaps": "fill", "max_gap": None, "fps": 1.0, "scalar_first": True}
    _, moved = wavelet.with_translation(still, path, wavelet="sym8", threshold="auto", **missing)
    assert np.sqrt(np.mean((moved - clean) ** 2)) < 0.4 * 0.05
