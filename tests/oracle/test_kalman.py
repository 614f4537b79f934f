"""The Kalman filter of turns about one axis against the linear filter of their angle, in plain matrices."""

import clips
import numpy as np
import pytest
import tolerances
from scipy.linalg import block_diag

FRAMES = 120
F = np.array([[1.0, 1], [0, 1]])
H = np.array([[1.0, 0]])
AXIS = np.array([1.0, 2, 2]) / 3


def process_covariance(noise):
    return noise**2 * np.array([[1 / 3, 1 / 2], [1 / 2, 1]])


def forward(z, variance, noise, velocity_variance):
    """States with covariances, what was expected of the next, and the innovations; infinite variance: no sample."""
    q = process_covariance(noise)
    x, p = np.array([z[0], 0]), np.diag([variance[0], velocity_variance])
    known, expected, innovations = [(x, p)], [], []
    for sample, r in zip(z[1:], variance[1:], strict=True):
        x, p = F @ x, F @ p @ F.T + q
        expected.append((x, p))
        innovations.append(sample - H @ x)
        if np.isfinite(r):
            gain = p @ H.T / (H @ p @ H.T + r)
            x = x + gain @ innovations[-1]
            p = (np.eye(2) - gain @ H) @ p @ (np.eye(2) - gain @ H).T + gain @ gain.T * r
        known.append((x, p))
    return known, expected, np.array(innovations)


def linear(z, variance, noise, velocity_variance, lookahead):
    """The filter, and the smoother of Rauch, Tung and Striebel from `lookahead` frames later."""
    begin = np.flatnonzero(np.isfinite(variance))[0]
    known, expected, _ = forward(z[begin:], variance[begin:], noise, velocity_variance)
    result = np.empty(len(z))
    for t in range(len(known)):
        last = min(t + lookahead, len(known) - 1)
        smooth = known[last][0]
        for s in range(last - 1, t - 1, -1):
            x, p = known[s]
            ahead, p_ahead = expected[s]
            smooth = x + p @ F.T @ np.linalg.solve(p_ahead, smooth - ahead)
        result[begin + t] = smooth[0]
    result[:begin] = result[begin]
    return result


def turning(seed=1):
    rng = np.random.default_rng(seed)
    t = np.arange(FRAMES) / 30
    return 3 * t + np.sin(3 * t) + rng.normal(0, 0.1, FRAMES), rng


def about_axis(angle):
    return clips.from_vectors(angle[:, None, None] * AXIS)


@pytest.mark.parametrize("lookahead", [0, 1, 10, FRAMES])
@pytest.mark.parametrize(
    ("noise", "trusted"),
    [(0.0, False), (1e-4, False), (0.01, False), (1.0, False), (0.0, True), (0.01, True)],
)
def test_angles_about_one_axis(backend, noise, trusted, lookahead):
    """However far they turn, as long as no forecast is left."""
    angle, rng = turning()
    confidence = clips.confidences(rng, FRAMES, 1) if trusted else np.ones((FRAMES, 1))
    confidence[:4] = 0 if trusted else 1
    with np.errstate(divide="ignore"):
        variance = 0.1**2 / confidence[:, 0]
    expected = linear(angle, variance, noise, np.pi**2, lookahead)
    result = backend.kalman(
        about_axis(angle),
        confidence,
        np.array([noise]),
        np.array([0.1]),
        lookahead if lookahead < FRAMES else -1,
    )
    assert clips.angles(result, about_axis(expected)).max() < tolerances.FLOAT64


def test_a_gap_whose_forecast_is_left(backend):
    """The smoother does not need the forecast: a gap of a whole turn of forecast, in which the angle came to rest."""
    angle, _ = turning()
    angle[70:] = angle[40]
    variance = np.full(FRAMES, 1e-4)
    variance[41:70] = np.inf
    expected = linear(angle, variance, 0.01, np.pi**2, FRAMES)
    confidence = np.isfinite(variance)[:, None].astype(float)
    result = backend.kalman(about_axis(angle), confidence, np.array([0.01]), np.array([0.01]), -1)
    assert clips.angles(result, about_axis(expected)).max() < tolerances.FLOAT64


def test_without_process_noise_the_smoother_is_a_line(backend):
    """Through the angles, by least squares; the prior of the velocity has a weight of some 1e-7."""
    angle, _ = turning()
    frames = np.arange(FRAMES)
    line = np.polyval(np.polyfit(frames, angle, 1), frames)
    # Residuals of more than half a turn would be seen the other way round.
    assert np.abs(angle - line).max() < np.pi
    result = backend.kalman(about_axis(angle), None, np.zeros(1), np.array([0.1]), -1)
    assert clips.angles(result, about_axis(line)).max() < 1e-5


def smoothing_matrix(ratio, frames, velocity_variance):
    """The matrix by which the smoother multiplies all samples: normal equations of the whole clip at once."""
    weight = np.linalg.inv(process_covariance(np.sqrt(ratio)))
    steps = np.zeros((2 * (frames - 1), 2 * frames))
    for t in range(frames - 1):
        steps[2 * t : 2 * t + 2, 2 * t : 2 * t + 4] = np.hstack([-F, np.eye(2)])
    precision = steps.T @ block_diag(*[weight] * (frames - 1)) @ steps
    precision[1, 1] += 1 / velocity_variance
    precision[::2, ::2] += np.eye(frames)
    return np.linalg.inv(precision)[::2, ::2]


def cross_validation(angle, ratio, velocity_variance):
    hat = smoothing_matrix(ratio, len(angle), velocity_variance)
    return np.sum((angle - hat @ angle) ** 2) / (1 - np.trace(hat) / len(angle)) ** 2


def test_the_smoother_is_the_solution_of_the_normal_equations(backend):
    angle, _ = turning()
    expected = smoothing_matrix(0.01, FRAMES, (np.pi / 0.1) ** 2) @ angle
    result = backend.kalman(about_axis(angle), None, np.array([0.01]), np.array([0.1]), -1)
    assert clips.angles(result, about_axis(expected)).max() < 1e-10


@pytest.mark.parametrize("seed", range(4))
def test_the_automatic_noise_is_the_minimum_of_the_cross_validation(backend, seed):
    angle, _ = turning(seed)
    ratios = 10 ** np.linspace(-5, 0, 51)
    velocity_variance = (np.pi / 0.1) ** 2
    scores = [cross_validation(angle, ratio, velocity_variance) for ratio in ratios]
    noise = backend.kalman_process_noise(about_axis(angle), None, np.array([0.1]), FRAMES, -1)
    found = cross_validation(angle, (noise[0] / 0.1) ** 2, velocity_variance)
    assert found < 1.005 * min(scores)
    numbers = backend.kalman_vectors_ratio(angle[:, None], FRAMES, -1)
    assert numbers[0] == pytest.approx((noise[0] / 0.1) ** 2, rel=0.02)


@pytest.mark.parametrize("seed", range(4))
def test_the_automatic_noise_of_the_forward_filter_makes_the_best_forecasts(backend, seed):
    angle, _ = turning(seed)

    def forecast_error(ratio):
        _, _, innovations = forward(angle, np.full(FRAMES, 0.01), 0.1 * np.sqrt(ratio), np.pi**2)
        # The first of them knows nothing of the velocity.
        return np.sum(innovations[1:] ** 2)

    noise = backend.kalman_process_noise(about_axis(angle), None, np.array([0.1]), FRAMES, 0)
    best = min(forecast_error(ratio) for ratio in 10 ** np.linspace(-6, 1, 141))
    assert forecast_error((noise[0] / 0.1) ** 2) < 1.005 * best


@pytest.mark.parametrize("lookahead", [0, 3, FRAMES])
@pytest.mark.parametrize("ratio", [1e-6, 0.01, 100.0])
def test_numbers(backend, ratio, lookahead):
    angle, _ = turning()
    expected = linear(angle, np.ones(FRAMES), np.sqrt(ratio), 1e10, lookahead)
    result = backend.kalman_vectors(
        angle[:, None], np.array([ratio]), lookahead if lookahead < FRAMES else -1
    )
    # Plain matrices lose digits while nothing is known of the velocity.
    np.testing.assert_allclose(result[:, 0], expected, rtol=0, atol=1e-5)
    np.testing.assert_allclose(result[5:, 0], expected[5:], rtol=0, atol=1e-6)
