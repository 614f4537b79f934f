"""What must hold for the filters on vectors about a reference path, whatever the clip."""

import clips
import numpy as np
import pytest
import tolerances
from drawn import dtypes, seeds
from hypothesis import given
from hypothesis import strategies as st
from plugins.properties import examples
from quatfilt.filters.wavelet import with_translation as wavelet_with_translation
from scipy import signal

AXIS = np.array([1.0, 2, 2]) / 3


def gaussian(backend, q, translation=None, confidence=None, *, sigma=2.0, boundary="mirror"):
    scale = np.full(q.shape[1], sigma)
    return backend.gaussian(q, translation, confidence, scale, scale, boundary)


def butterworth(backend, q, translation=None, confidence=None, *, cutoff=0.15, order=3):
    sections = signal.butter(order, cutoff, fs=1, output="sos")
    states = signal.sosfilt_zi(sections)
    sections, states = (np.tile(x, (q.shape[1], 1, 1)) for x in (sections, states))
    scale = np.full(q.shape[1], 1.0)
    return backend.butterworth(q, translation, confidence, scale, sections, states, 3 * (order + 1))


def savgol(backend, q, translation=None, confidence=None, *, window=9):
    terms = np.vander(np.linspace(-1, 1, window), 4)
    scale = np.full(q.shape[1], 1.5)
    return backend.savgol(q, translation, confidence, scale, np.linalg.pinv(terms), terms)


def wavelet(_backend, q, translation=None, confidence=None, *, threshold="auto"):
    """Without a kernel of its own; the fixture chose who develops."""
    missing = {"gaps": "raise", "max_gap": None, "fps": 1.0, "scalar_first": True}
    return wavelet_with_translation(
        q, translation, wavelet="sym4", threshold=threshold, confidence=confidence, **missing
    )


def weighted_moving_mean(backend, q, translation=None, confidence=None, *, iterations=3):
    scale = np.full(q.shape[1], np.sqrt(2.0 * iterations))
    return backend.weighted_moving_mean(q, translation, confidence, scale, iterations)


FILTERS = {
    "butterworth": butterworth,
    "gaussian": gaussian,
    "savgol": savgol,
    "wavelet": wavelet,
    "weighted_moving_mean": weighted_moving_mean,
}

SYMMETRIC = ["gaussian", "savgol"]
"""Those that do not know which way time runs, at the ends either."""

REACH = {"butterworth": 90, "gaussian": 16, "savgol": 10, "weighted_moving_mean": 16}
"""Frames beyond which a filter and its reference path see nothing that would show. A wavelet's details stand at every second
frame, every fourth, and so on: it sees when a clip begins."""

every_filter = pytest.mark.parametrize("name", FILTERS)

few = examples(12)
"""Each is a whole clip; the reference takes its time."""


def sample(seed, frames=60, joints=3, sigma=0.1):
    rng = np.random.default_rng(seed)
    return clips.noisy(rng, clips.smooth(rng, frames, joints, swing=2), sigma), rng


@every_filter
@few
@given(seed=seeds, weighted=st.booleans())
def test_constant_rotations_on_either_side_go_through(backend, name, seed, weighted):
    q, rng = sample(seed)
    trust = clips.confidences(rng, *q.shape[:2]) if weighted else None
    a, b = clips.random_rotations(rng, 2)
    result, _ = FILTERS[name](backend, q, None, trust)
    moved, _ = FILTERS[name](backend, clips.product(a, clips.product(q, b)), None, trust)
    assert clips.angles(moved, clips.product(a, clips.product(result, b))).max() < tolerances.FLOAT64


@pytest.mark.parametrize("name", REACH)
@few
@given(seed=seeds, weighted=st.booleans())
def test_inverse_rotations_give_the_inverse(backend, name, seed, weighted):
    """It does not matter whether the body is seen from the world or the world from the body. The principal axes of a wavelet's
    are those of the body."""
    q, rng = sample(seed)
    trust = clips.confidences(rng, *q.shape[:2]) if weighted else None
    result, inverse = (FILTERS[name](backend, x, None, trust)[0] for x in (q, q * [1, -1, -1, -1]))
    assert clips.angles(inverse * [1, -1, -1, -1], result).max() < tolerances.FLOAT64


@every_filter
@few
@given(seed=seeds, dtype=dtypes)
def test_signs_do_not_matter(backend, name, seed, dtype):
    q, rng = sample(seed)
    q = q.astype(dtype)
    other = clips.flipped(rng, q).astype(dtype)
    result, flipped = (FILTERS[name](backend, x)[0] for x in (q, other))
    sides = np.sign(np.sum(q[0] * other[0], axis=-1))[:, None]
    np.testing.assert_allclose(result, flipped * sides, rtol=0, atol=tolerances.algebra(dtype))


@every_filter
@few
@given(seed=seeds, dtype=dtypes)
def test_output_is_unit_continuous_and_starts_in_the_hemisphere_of_the_input(backend, name, seed, dtype):
    q, rng = sample(seed)
    q = clips.flipped(rng, q).astype(dtype)
    result, _ = FILTERS[name](backend, q)
    assert result.dtype == dtype
    np.testing.assert_allclose(np.linalg.norm(result, axis=-1), 1, atol=tolerances.algebra(dtype))
    assert (np.sum(result[1:] * result[:-1], axis=-1) >= 0).all()
    assert (np.sum(result[0] * q[0], axis=-1) >= 0).all()


@every_filter
def test_constant_clips_stay(backend, name):
    q = np.repeat(clips.random_rotations(np.random.default_rng(1), 1, 4), 30, axis=0)
    np.testing.assert_allclose(FILTERS[name](backend, q)[0], q, rtol=0, atol=tolerances.ALGEBRA)


@pytest.mark.parametrize("name", REACH)
@few
@given(seed=seeds, shift=st.integers(1, 9))
def test_time_does_not_matter_far_from_the_ends(backend, name, seed, shift):
    q, _ = sample(seed, 250)
    whole, part = (FILTERS[name](backend, np.ascontiguousarray(x))[0] for x in (q, q[shift:]))
    reach = REACH[name]
    difference = clips.angles(whole[shift + reach : -reach], part[reach:-reach])
    assert difference.max() < tolerances.FLOAT64


@pytest.mark.parametrize("name", SYMMETRIC)
@few
@given(seed=seeds)
def test_a_clip_that_runs_backwards_gives_the_same(backend, name, seed):
    q, _ = sample(seed)
    forwards, backwards = (FILTERS[name](backend, np.ascontiguousarray(x))[0] for x in (q, q[::-1]))
    assert clips.angles(forwards, backwards[::-1]).max() < tolerances.FLOAT64


@pytest.mark.parametrize("name", REACH)
def test_however_far_a_joint_turns(backend, name):
    """A steady turn about one axis is a straight line, which symmetric masks keep."""
    frames = np.arange(400)[:, None, None]
    q = clips.from_vectors(0.3 * frames * AXIS)
    result, _ = FILTERS[name](backend, q)
    reach = REACH[name]
    assert clips.angles(result, q)[reach:-reach].max() < tolerances.FLOAT64


@every_filter
@few
@given(seed=seeds)
def test_what_is_not_trusted_does_not_matter(backend, name, seed):
    q, rng = sample(seed)
    trust = np.where(rng.random(q.shape[:2]) < 0.1, 0.0, 1.0)
    other = np.where(trust[..., None] == 0, clips.random_rotations(rng, *q.shape[:2]), q)
    path = clips.path(rng, len(q))
    elsewhere = np.where(trust[:, :1] == 0, 100.0, path)
    # The first frame says on which hemisphere the result begins.
    trust[0], other[0], elsewhere[0] = 1, q[0], path[0]
    result, moved = FILTERS[name](backend, q, path, trust)
    expected, along = FILTERS[name](backend, other, elsewhere, trust)
    assert clips.angles(result, expected).max() < tolerances.FLOAT64
    np.testing.assert_allclose(moved, along, rtol=0, atol=tolerances.FLOAT64)


@every_filter
def test_full_confidence_is_none(backend, name):
    q, rng = sample(2)
    path = clips.path(rng, len(q))
    result, moved = FILTERS[name](backend, q, path, np.ones(q.shape[:2]))
    expected, along = FILTERS[name](backend, q, path)
    assert clips.angles(result, expected).max() < tolerances.FLOAT64
    np.testing.assert_allclose(moved, along, rtol=0, atol=tolerances.FLOAT64)


def test_without_confidence_anywhere_samples_stay(backend):
    q, rng = sample(3)
    path = clips.path(rng, len(q))
    result, moved = gaussian(backend, q, path, np.zeros(q.shape[:2]))
    assert clips.angles(result, q).max() < tolerances.FLOAT64
    np.testing.assert_array_equal(moved, path)


@every_filter
def test_noise_goes_and_does_not_add_up(backend, name):
    """Noise of a quarter of a radian on a clip that hardly moves: its commutators would lead Lee and Shin's filter astray."""
    rng = np.random.default_rng(4)
    clean = clips.smooth(rng, 1500, 2, swing=0.02)
    q = clips.noisy(rng, clean, 0.25)
    result, _ = FILTERS[name](backend, q)
    assert np.sqrt(np.mean(clips.angles(result, clean) ** 2)) < 0.55 * np.sqrt(
        np.mean(clips.angles(q, clean) ** 2)
    )


def test_one_wild_sample_does_not_turn_the_signs_of_the_rest(backend):
    """Half a turn away, its sign is chance; the running mean is not led astray by it."""
    rng = np.random.default_rng(5)
    q = clips.noisy(rng, np.tile([1.0, 0, 0, 0], (100, 1, 1)), 0.05)
    q[50, 0] = clips.from_vectors(np.pi * AXIS)
    for sample_again in (q, clips.flipped(rng, q)):
        reference, _, _ = backend.develop(sample_again, None, np.array([2.0]))
        assert clips.angles(reference, np.tile([1.0, 0, 0, 0], (100, 1, 1))).max() < 1.2
        assert clips.angles(reference[60:], reference[60:61] + 0 * reference[60:]).max() < 0.2


def spin(speed, axis, *, frames=120, noise=0.0):
    """A joint that turns steadily by `speed` radians per frame, one at rest beside it, and both without noise."""
    rng = np.random.default_rng(7)
    angles = speed * np.arange(frames)[:, None] * [1, 0]
    clean = clips.product(clips.random_rotations(rng, 2), clips.from_vectors(angles[..., None] * axis))
    return clips.noisy(rng, clean, noise), clean


@pytest.mark.parametrize("name", REACH)
@pytest.mark.parametrize("speed", [2.0, 2.5, 2.9])
@pytest.mark.parametrize("axis", [np.array([0.0, 0, 1]), AXIS])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_however_fast_a_joint_turns(backend, name, speed, axis, dtype):
    """Nearly half a turn per frame is a straight line as well; a polynomial keeps it to the ends."""
    q = spin(speed, axis, frames=220)[0].astype(dtype)
    result, _ = FILTERS[name](backend, q)
    reach = 0 if name == "savgol" else REACH[name]
    difference = clips.angles(result, q)[reach : len(q) - reach]
    assert difference.max() < (tolerances.FLOAT64 if dtype == np.float64 else tolerances.algebra(dtype))


@pytest.mark.parametrize("name", REACH)
@pytest.mark.parametrize("speed", [2.0, 2.5, 2.9])
def test_a_fast_turn_with_noise_stays_near(backend, name, speed):
    """Noise of a hundredth of a radian tilts the axis from frame to frame, and the faster the turn, the more of it is left."""
    q, clean = spin(speed, AXIS, frames=220, noise=0.01)
    result, _ = FILTERS[name](backend, q)
    difference = clips.angles(result, clean)[REACH[name] : -REACH[name]]
    assert difference[:, 0].max() < 0.1
    assert difference[:, 1].max() < 0.03


@pytest.mark.parametrize("name", REACH)
@given(seed=seeds, weighted=st.booleans())
def test_the_inverse_of_a_spin_gives_the_inverse(backend, name, seed, weighted):
    rng = np.random.default_rng(seed)
    q = clips.noisy(rng, spin(2.6, AXIS, frames=40)[1], 0.05)
    trust = clips.confidences(rng, *q.shape[:2]) if weighted else None
    result, inverse = (FILTERS[name](backend, x, None, trust)[0] for x in (q, q * [1, -1, -1, -1]))
    assert clips.angles(inverse * [1, -1, -1, -1], result).max() < tolerances.FLOAT64


@pytest.mark.parametrize("name", REACH)
def test_a_joint_that_spins_leaves_the_others_alone(backend, name):
    q, _ = spin(2.5, AXIS, noise=0.1)
    still = np.repeat(q[:, 1:], 2, axis=1)
    both, alone = (FILTERS[name](backend, x)[0] for x in (q, still))
    np.testing.assert_array_equal(both[:, 1], alone[:, 1])


def test_development_about_one_axis_unrolls_the_angle(backend):
    angle = np.cumsum(np.random.default_rng(6).normal(0.5, 0.3, 300))
    q = clips.from_vectors(angle[:, None, None] * AXIS)
    _, _, vectors = backend.develop(q, None, np.array([1.0]))
    unrolled = vectors[:, 0] @ AXIS
    np.testing.assert_allclose(unrolled - unrolled[0], angle - angle[0], rtol=0, atol=1e-10)
    np.testing.assert_allclose(vectors[:, 0], unrolled[:, None] * AXIS, rtol=0, atol=tolerances.FLOAT64)


@few
@given(seed=seeds, dtype=dtypes)
def test_development_and_back(backend, seed, dtype):
    q, rng = sample(seed)
    q = clips.flipped(rng, q).astype(dtype)
    reference, development, vectors = backend.develop(q, None, np.full(3, 2.0))
    back = backend.undevelop(q, reference, development, vectors)
    assert clips.angles(back, q).max() < 2 * tolerances.algebra(dtype)
    path = backend.undevelop(q, reference, development, development)
    assert clips.angles(path, reference).max() < 2 * tolerances.algebra(dtype)
