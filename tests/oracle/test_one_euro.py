"""The 1€ filter of turns about one axis against the filter of numbers, with time stamps, on their angle."""

import clips
import numpy as np
import pytest
import tolerances

FPS = 60.0


class LowPass:
    """Exponential smoothing."""

    def __init__(self):
        self.last = None

    def __call__(self, x, alpha):
        self.last = x if self.last is None else alpha * x + (1 - alpha) * self.last
        return self.last


class OneEuro:
    """The paper's filter, with the speed from sample to sample."""

    def __init__(self, min_cutoff, beta, derivative_cutoff):
        self.min_cutoff, self.beta, self.derivative_cutoff = min_cutoff, beta, derivative_cutoff
        self.position, self.speed = LowPass(), LowPass()
        self.sample = self.time = None

    @staticmethod
    def alpha(cutoff, period):
        tau = 1 / (2 * np.pi * cutoff)
        return 1 / (1 + tau / period)

    def __call__(self, x, time):
        if self.time is None:
            dx, period = 0.0, 1 / FPS
        else:
            period = time - self.time
            dx = (x - self.sample) / period
        speed = self.speed(dx, self.alpha(self.derivative_cutoff, period))
        cutoff = self.min_cutoff + self.beta * abs(speed)
        self.sample, self.time = x, time
        return self.position(x, self.alpha(cutoff, period))


@pytest.mark.parametrize("gaps", [False, True])
@pytest.mark.parametrize(
    ("min_cutoff", "beta", "derivative_cutoff"),
    [(1.0, 0.0, 1.0), (1.0, 0.007, 1.0), (0.5, 1.0, 2.0), (4.0, 0.3, 0.1)],
)
def test_angles_about_one_axis(backend, min_cutoff, beta, derivative_cutoff, gaps):
    """However far they turn, as long as the result lags by less than half a turn."""
    rng = np.random.default_rng(1)
    time = np.arange(400) / FPS
    angle = 2 * time + np.sin(3 * time) + rng.normal(0, 0.1, 400)
    measured = rng.random(400) < 0.6 if gaps else np.ones(400, bool)
    measured[0] = True
    scalar = OneEuro(min_cutoff, beta, derivative_cutoff)
    expected = np.empty(400)
    for i in range(400):
        expected[i] = scalar(angle[i], time[i]) if measured[i] else expected[i - 1]
    axis = np.array([1.0, 2, 2]) / 3
    q = clips.from_vectors(angle[:, None, None] * axis)
    confidence = measured[:, None].astype(float) if gaps else None
    numbers = (np.array([x]) for x in (min_cutoff / FPS, beta, derivative_cutoff / FPS))
    result, _ = backend.one_euro(q, None, confidence, *numbers)
    assert clips.angles(result, clips.from_vectors(expected[:, None, None] * axis)).max() < tolerances.FLOAT64
