"""Rotations as vectors about a reference path, and filters on them: the core against the reference."""

import clips
import drawn
import numpy as np
import pytest
import quatfilt as qf
import tolerances
from drawn import same_samples, seeds
from hypothesis import given
from hypothesis import strategies as st
from layouts import LAYOUTS
from quatfilt import _core, _reference
from scipy import signal

DTYPES = [np.float32, np.float64]
BOUNDARIES = ["nearest", "mirror", "linear"]


def noisy(rng, frames, joints, sigma=0.1):
    """A clip with random signs to filter."""
    return clips.flipped(rng, clips.noisy(rng, clips.smooth(rng, frames, joints, swing=2), sigma))


def designed(cutoff, order):
    """Sections, their steady states, and the padding."""
    sections = [signal.butter(order, one, fs=1, output="sos") for one in cutoff]
    states = [signal.sosfilt_zi(one) for one in sections]
    shape = (len(cutoff), (order + 1) // 2)
    return np.reshape(sections, (*shape, 6)), np.reshape(states, (*shape, 2)), 3 * (order + 1)


def polynomials(window, degree, order):
    """Coefficients of the polynomials that are fitted to a window, and the values of a derivative."""
    place = np.linspace(-1, 1, window) if window > 1 else np.zeros(1)
    degree = min(degree, window - 1)
    terms = [np.polynomial.Polynomial.basis(k) for k in range(degree + 1)]
    values = np.stack([(term.deriv(order) if order else term)(place) for term in terms], axis=1)
    fit = np.linalg.pinv(np.stack([term(place) for term in terms], axis=1))
    return fit, np.ascontiguousarray(values)


FILTERS = {
    "butterworth": lambda spread, cutoff, order: designed(cutoff / spread, order),
    "gaussian": lambda spread, sigma, boundary: (sigma * spread, boundary),
    "savgol": lambda _spread, window, degree: polynomials(window, degree, 0),
    "weighted_moving_mean": lambda _spread, iterations: (iterations,),
}
"""From a factor for each joint and options to the arguments that follow the reference path's."""

OPTIONS = {
    "butterworth": st.tuples(st.sampled_from([0.02, 0.1, 0.45]), st.integers(1, 6)),
    "gaussian": st.tuples(st.sampled_from([0.1, 1.0, 2.3, 20.0]), st.sampled_from(BOUNDARIES)),
    "savgol": st.tuples(st.sampled_from([1, 3, 7]), st.integers(0, 4)),
    "weighted_moving_mean": st.tuples(st.integers(1, 5)),
}

SETTINGS = {
    "butterworth": (0.1, 4),
    "gaussian": (3.0, "mirror"),
    "savgol": (11, 3),
    "weighted_moving_mean": (2,),
}


def agree(name, q, options, *, reference_sigma=2.0, translation=None, confidence=None):
    joints = q.shape[1]
    spread = np.linspace(1, 2, joints)
    chosen = FILTERS[name](spread, *options)
    translation, confidence = (
        None if x is None else np.require(x, q.dtype, "C") for x in (translation, confidence)
    )
    arguments = (q, translation, confidence, reference_sigma * spread, *chosen)
    arrays = [x for x in arguments if isinstance(x, np.ndarray)]
    before = [x.tobytes() for x in arrays]
    (result, moved), (expected, path) = (
        getattr(backend, name)(*arguments) for backend in (_core, _reference)
    )
    assert [x.tobytes() for x in arrays] == before, "an input was written"
    assert result.dtype == expected.dtype == q.dtype
    assert result.shape == expected.shape == q.shape
    tolerance = tolerances.filtered(q.dtype)
    same_samples(result, expected, tolerance)
    if translation is None:
        assert moved is None
        assert path is None
    else:
        assert moved.dtype == path.dtype == q.dtype
        np.testing.assert_allclose(
            moved, path, rtol=0, atol=tolerance * max(1, np.abs(translation).max(initial=0))
        )


@pytest.mark.parametrize("name", FILTERS)
@given(
    data=st.data(),
    seed=seeds,
    frames=st.one_of(st.integers(0, 9), st.integers(10, 150)),
    joints=st.sampled_from([0, 1, 3, 4, 5, 9]),
    dtype=drawn.dtypes,
    reference_sigma=st.sampled_from([0.1, 1.0, 3.3, 12.0]),
    trusting=st.sampled_from([None, "some", "none"]),
    along=st.booleans(),
)
def test_any_options(name, data, seed, frames, joints, dtype, reference_sigma, trusting, along):
    rng = np.random.default_rng(seed)
    options = data.draw(OPTIONS[name])
    if name == "savgol":  # its window is not longer than the clip
        frames = max(frames, options[0])
    q = noisy(rng, frames, max(joints, 1))[:, :joints]
    trust = clips.confidences(rng, frames, joints) if trusting else None
    agree(
        name,
        np.ascontiguousarray(q, dtype),
        options,
        reference_sigma=reference_sigma,
        translation=clips.path(rng, frames) if along else None,
        confidence=0 * trust if trusting == "none" else trust,
    )


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("name", FILTERS)
@pytest.mark.parametrize("trusting", [False, True])
@pytest.mark.parametrize("frames", [11, 33, 97])
def test_spins(name, dtype, trusting, frames):
    """Joints that turn by up to nearly half a turn per frame, for the whole clip, or for a while."""
    rng = np.random.default_rng(frames)
    angles = np.arange(frames)[:, None] * [2.0, 2.9, 1.1, 0.0]
    angles[:, 3] = np.cumsum(2.5 * (np.arange(frames) // 9 % 3 == 1))
    axes = rng.standard_normal((4, 3))
    axes /= np.linalg.norm(axes, axis=1, keepdims=True)
    q = clips.noisy(rng, clips.from_vectors(angles[..., None] * axes), 0.02)
    q = clips.product(clips.random_rotations(rng, 4), q).astype(dtype)
    trust = clips.confidences(rng, frames, 4) if trusting else None
    agree(name, q, SETTINGS[name], confidence=trust)


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("name", FILTERS)
def test_around_the_ends_of_chunks(name, dtype):
    for frames in (31, 32, 33, 63, 64, 65, 2047, 2049):
        rng = np.random.default_rng(frames)
        agree(name, noisy(rng, frames, 5).astype(dtype), SETTINGS[name], translation=clips.path(rng, frames))


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("weighted", [False, True])
@pytest.mark.parametrize("frames", [0, 1, 2, 70, 2050])
def test_development(frames, weighted, dtype):
    rng = np.random.default_rng(frames)
    q = noisy(rng, frames, 5).astype(dtype)
    trust = clips.confidences(rng, frames, 5).astype(dtype) if weighted else None
    sigma = np.linspace(1, 6, 5)
    results, expected = (backend.develop(q, trust, sigma) for backend in (_core, _reference))
    for result, wanted in zip(results, expected, strict=True):
        assert result.dtype == wanted.dtype == np.float64
        np.testing.assert_allclose(result, wanted, rtol=0, atol=tolerances.FLOAT64)
    rotations, wanted = (backend.undevelop(q, *expected) for backend in (_core, _reference))
    same_samples(rotations, wanted, tolerances.filtered(dtype))


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("weighted", [False, True])
@pytest.mark.parametrize(("frames", "window"), [(1, 1), (5, 5), (6, 5), (70, 11), (2051, 21)])
@pytest.mark.parametrize("order", [1, 2])
def test_derivatives(order, frames, window, weighted, dtype):
    rng = np.random.default_rng(frames)
    q = noisy(rng, frames, 5).astype(dtype)
    trust = clips.confidences(rng, frames, 5).astype(dtype) if weighted else None
    fit, values = polynomials(window, 3, 0)
    arguments = (q, trust, np.linspace(1, 3, 5), fit, values, polynomials(window, 3, order)[1])
    result, expected = (backend.savgol_derivative(*arguments) for backend in (_core, _reference))
    assert result.dtype == expected.dtype == dtype
    size = max(1, np.abs(expected).max())
    np.testing.assert_allclose(result, expected, rtol=0, atol=10 * size * tolerances.filtered(dtype))


@pytest.mark.parametrize("dtype", DTYPES)
def test_turns_right_round_within_the_mask(dtype):
    """Where the average has no direction the samples are their own reference."""
    frames = np.arange(200)[:, None, None]
    q = clips.from_vectors(frames * np.array([[0.0, 0, 2.5], [1.0, 1, 0], [0, 3.0, 0]]))
    q = clips.noisy(np.random.default_rng(0), q, 0.02).astype(dtype)
    for reference_sigma in (1.0, 12.0):
        agree("gaussian", q, (4.0, "mirror"), reference_sigma=reference_sigma)


def angular_velocity(q, **options):
    """The angular velocity of a clip that is long enough for it."""
    return qf.savgol(q, window_length=3, polyorder=1, deriv=1, **options) if len(q) >= 3 else q


CALLS = {
    "butterworth": lambda q, **options: qf.butterworth(q, cutoff=0.1, **options),
    "gaussian": lambda q, **options: qf.gaussian(q, sigma=2, **options),
    "savgol": lambda q, **options: qf.savgol(
        q, window_length=5 if len(q) >= 5 else 1, polyorder=0, **options
    ),
    "angular velocity": angular_velocity,
    "wavelet": qf.wavelet,
    "weighted_moving_mean": qf.weighted_moving_mean,
}


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("name", CALLS)
def test_layouts(name, layout, dtype):
    plain = noisy(np.random.default_rng(4), 80, 3).astype(dtype)
    result = CALLS[name](LAYOUTS[layout](plain))
    assert result.dtype == dtype
    np.testing.assert_array_equal(result, CALLS[name](plain))


@pytest.mark.parametrize("name", CALLS)
@given(
    q=drawn.spoilt_clips(lengths=st.integers(0, 60), joints=st.sampled_from([1, 3, 5])),
    gaps=st.sampled_from(["fill", "keep"]),
    max_gap=st.sampled_from([None, 0, 1, 3, 1000]),
)
def test_missing_samples(name, q, gaps, max_gap):
    result = CALLS[name](q, gaps=gaps, max_gap=max_gap)
    with qf.use_backend("numpy"):
        expected = CALLS[name](q, gaps=gaps, max_gap=max_gap)
    same_samples(result, expected, tolerances.filtered(result.dtype))
