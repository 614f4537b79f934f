"""What must hold for Lee and Shin's filters and for the bilateral one, whatever the clip."""

import clips
import numpy as np
import pytest
import tolerances
from drawn import dtypes, seeds
from hypothesis import given
from hypothesis import strategies as st

BINOMIAL = np.array([1.0, 4, 6, 4, 1])
REACH = 2
TWICE = 2

FILTERS = (
    {
        "binomial": lambda backend, q: backend.orientation_filter(q, None, BINOMIAL, TWICE, "mirror")[0],
        "savitzky_golay": lambda backend, q: backend.orientation_filter(
            q, None, np.array([-3.0, 12, 17, 12, -3]), TWICE, "linear"
        )[0],
        "one_sided": lambda backend, q: backend.orientation_filter(
            q, None, np.array([1.0, 2, 3, 0, 0]), TWICE, "nearest"
        )[0],
    }
    | {
        kernel: lambda backend, q, kernel=kernel: backend.bilateral(
            q, None, REACH, 1.0, np.full(q.shape[1], 0.2), kernel, TWICE, "mirror", -1
        )[0]
        for kernel in ("gaussian", "printed", "classic")
    }
    | {
        "looking_back": lambda backend, q: backend.bilateral(
            q, None, REACH, 1.0, np.full(q.shape[1], 0.2), "gaussian", TWICE, "nearest", 0
        )[0]
    }
)
"""Each reaches `TWICE · REACH` frames."""

every_filter = pytest.mark.parametrize("name", FILTERS)


def sample(seed, frames=23, joints=3):
    rng = np.random.default_rng(seed)
    return clips.noisy(rng, clips.smooth(rng, frames, joints, swing=2), 0.05), rng


@every_filter
@given(seed=seeds)
def test_constant_rotations_on_either_side_go_through(backend, name, seed):
    q, rng = sample(seed)
    a, b = clips.random_rotations(rng, 2)
    result = FILTERS[name](backend, q)
    moved = FILTERS[name](backend, clips.product(a, clips.product(q, b)))
    assert clips.angles(moved, clips.product(a, clips.product(result, b))).max() < tolerances.FLOAT64


@every_filter
@given(seed=seeds, shift=st.integers(1, 9))
def test_time_does_not_matter_far_from_the_ends(backend, name, seed, shift):
    q, _ = sample(seed, 40)
    whole, part = (FILTERS[name](backend, np.ascontiguousarray(x)) for x in (q, q[shift:]))
    inside = shift + TWICE * REACH
    difference = clips.angles(whole[inside : -TWICE * REACH], part[TWICE * REACH : -TWICE * REACH])
    assert difference.max() < tolerances.FLOAT64


@every_filter
@given(seed=seeds, dtype=dtypes)
def test_signs_do_not_matter(backend, name, seed, dtype):
    q, rng = sample(seed)
    q = q.astype(dtype)
    other = clips.flipped(rng, q).astype(dtype)
    result, flipped = (FILTERS[name](backend, x) for x in (q, other))
    sides = np.sign(np.sum(q[0] * other[0], axis=-1))[:, None]
    np.testing.assert_allclose(result, flipped * sides, rtol=0, atol=tolerances.algebra(dtype))


@every_filter
@given(seed=seeds, dtype=dtypes)
def test_output_is_unit_continuous_and_starts_in_the_hemisphere_of_the_input(backend, name, seed, dtype):
    q, rng = sample(seed)
    q = clips.flipped(rng, q).astype(dtype)
    result = FILTERS[name](backend, q)
    assert result.dtype == dtype
    np.testing.assert_allclose(np.linalg.norm(result, axis=-1), 1, atol=tolerances.algebra(dtype))
    assert (np.sum(result[1:] * result[:-1], axis=-1) >= 0).all()
    assert (np.sum(result[0] * q[0], axis=-1) >= 0).all()


@every_filter
def test_constant_clips_stay(backend, name):
    q = np.repeat(clips.random_rotations(np.random.default_rng(1), 1, 4), 30, axis=0)
    np.testing.assert_allclose(FILTERS[name](backend, q), q, rtol=0, atol=tolerances.ALGEBRA)


@pytest.mark.parametrize("mask", [[1.0], [3.0], [0, 0, -2, 0, 0]])
def test_masks_of_one_weight_change_nothing(backend, mask):
    q, _ = sample(2)
    result, _ = backend.orientation_filter(q, None, np.array(mask, float), 3, "mirror")
    assert clips.angles(result, q).max() < tolerances.ALGEBRA


def test_a_mask_of_one_neighbour_shifts_time(backend):
    """The increment to the neighbour, and to nothing else, is taken whole."""
    q, _ = sample(3)
    result, _ = backend.orientation_filter(q, None, np.array([0.0, 0, 1]), 1, "mirror")
    assert clips.angles(result[:-1], q[1:]).max() < tolerances.FLOAT64
    result, _ = backend.orientation_filter(q, None, np.array([1.0, 0, 0]), 1, "mirror")
    assert clips.angles(result[1:], q[:-1]).max() < tolerances.FLOAT64


@pytest.mark.parametrize("mask", [[1, 4, 6, 4, 1], [-3, 12, 17, 12, -3], [1, 2, 3, 0, 0]])
def test_angles_about_one_axis_are_averaged(backend, mask):
    """However far they turn."""
    rng = np.random.default_rng(4)
    angle = np.arange(200) * 0.3 + np.sin(np.arange(200) / 9) + rng.normal(0, 0.1, 200)
    axis = np.array([1.0, 2, 2]) / 3
    weights = np.array(mask, float)
    turned = clips.from_vectors(angle[:, None, None] * axis)
    result, _ = backend.orientation_filter(turned, None, weights, 1, "mirror")
    padded = np.pad(angle, 2, mode="reflect")
    means = np.convolve(padded, weights[::-1] / weights.sum(), mode="valid")
    expected = clips.from_vectors(means[:, None, None] * axis)
    assert clips.angles(result, expected).max() < tolerances.FLOAT64


@pytest.mark.parametrize("kernel", ["gaussian", "classic"])
def test_without_a_scale_of_angles_the_bilateral_filter_has_one_mask(backend, kernel):
    q, _ = sample(5)
    lags = np.abs(np.arange(-3, 4))
    mask = np.exp(-(lags if kernel == "gaussian" else lags**2) / (2 * 1.5**2))
    result, _ = backend.bilateral(q, None, 3, 1.5, np.full(3, np.inf), kernel, 2, "linear", -1)
    expected, _ = backend.orientation_filter(q, None, mask, 2, "linear")
    assert clips.angles(result, expected).max() < tolerances.FLOAT64


def test_a_step_stays_while_the_noise_goes(backend):
    rng = np.random.default_rng(6)
    angle = np.where(np.arange(120) < 60, 0.0, 2.0) + rng.normal(0, 0.03, 120)
    q = clips.from_vectors(angle[:, None, None] * np.array([0, 0, 1.0]))
    step = clips.from_vectors(np.where(np.arange(120) < 60, 0.0, 2.0)[:, None, None] * np.array([0, 0, 1.0]))
    result, _ = backend.bilateral(q, None, 4, 1.0, np.array([0.2]), "gaussian", 5, "mirror", -1)
    error = clips.angles(result, step)
    assert np.sqrt(np.mean(error**2)) < 0.5 * np.sqrt(np.mean(clips.angles(q, step) ** 2))
    mask = np.exp(-np.abs(np.arange(-4, 5)) / 2)
    blurred, _ = backend.orientation_filter(q, None, mask, 5, "mirror")
    assert clips.angles(blurred, step)[58:62].min() > 5 * error[58:62].max()


@given(seed=seeds, lookahead=st.integers(0, 3), iterations=st.integers(1, 3))
def test_frames_beyond_the_lookahead_do_not_matter(backend, seed, lookahead, iterations):
    """Each pass looks so far ahead."""
    q, rng = sample(seed)
    other = q.copy()
    seen = 15
    other[seen:] = clips.random_rotations(rng, *other[seen:].shape[:-1])

    def filtered(q):
        scale = np.full(3, 0.2)
        return backend.bilateral(q, None, 3, 1.0, scale, "gaussian", iterations, "nearest", lookahead)[0]

    settled = seen - iterations * lookahead
    difference = clips.angles(filtered(other), filtered(q))
    assert difference[:settled].max() < tolerances.FLOAT64
    assert difference[settled:].max() > 1e-3


def test_a_lookahead_of_the_radius_is_no_limit(backend):
    q, _ = sample(9)
    results = [
        backend.bilateral(q, None, 3, 1.0, np.full(3, 0.2), "gaussian", 2, "mirror", lookahead)[0]
        for lookahead in (-1, 3, 100)
    ]
    np.testing.assert_array_equal(results[1], results[0])
    np.testing.assert_array_equal(results[2], results[0])


def paper_noise():
    """A slow motion and the paper's noise: 0.18 rad per component, 0.09 on S³."""
    rng = np.random.default_rng(7)
    t = np.arange(1200)[:, None, None] / 120
    clean = clips.from_vectors(
        np.array([0.8, 0.5, 0.6])
        * np.sin(2 * np.pi * np.array([0.4, 0.3, 0.2]) * t + np.array([0.0, 1.0, 2.0]))
    )
    return clean, clips.noisy(rng, clean, 0.18)


def test_five_passes_of_the_squared_kernel_filter_and_of_the_printed_one_do_not(backend):
    """The paper's σ_t = 1 and σ_g = 0.1: its figure 3 shows what the squared distance does."""
    clean, q = paper_noise()

    def error(x):
        return np.mean((clips.angles(x, clean) / 2) ** 2)

    def filtered(kernel):
        return error(backend.bilateral(q, None, 4, 1.0, np.array([0.2]), kernel, 5, "mirror", -1)[0])

    assert error(q) == pytest.approx(0.0243, rel=0.05)
    assert filtered("gaussian") < error(q) / 4
    assert filtered("printed") > 0.97 * error(q)


def test_a_binomial_mask_removes_noise(backend):
    """With the signs of the printed equation (3) it adds some."""
    clean, q = paper_noise()
    result, _ = backend.orientation_filter(q, None, BINOMIAL, 1, "mirror")
    error, noise = (np.mean(clips.angles(x, clean) ** 2) for x in (result, q))
    assert error < 0.4 * noise


@pytest.mark.parametrize(("boundary", "mode"), [("mirror", "reflect"), ("nearest", "edge")])
def test_the_mask_is_that_of_the_translation_too(backend, boundary, mode):
    q, rng = sample(9, 40)
    path = clips.path(rng, 40)
    mask = np.array([1.0, 2, 3, 0, 0])
    _, moved = backend.orientation_filter(q, path, mask, 1, boundary)
    padded = np.pad(path, ((2, 2), (0, 0)), mode=mode)
    expected = [np.convolve(column, mask[::-1] / mask.sum(), "valid") for column in padded.T]
    np.testing.assert_allclose(moved, np.transpose(expected), rtol=0, atol=tolerances.FLOAT64)


def test_a_held_velocity_keeps_a_straight_path(backend):
    q, _ = sample(10, 40)
    path = np.linspace([0.0, 0, 0], [9, -3, 1], 40)
    _, moved = backend.orientation_filter(q, path, BINOMIAL, 3, "linear")
    np.testing.assert_allclose(moved, path, rtol=0, atol=tolerances.FLOAT64)


def test_the_translation_has_the_weights_of_the_root(backend):
    """A root that stands still weighs by time alone; one that jumps does not look across."""
    rng = np.random.default_rng(8)
    path = clips.path(rng, 40)
    q = np.repeat(clips.random_rotations(rng, 1, 2), 40, axis=0)
    _, moved = backend.bilateral(q, path, 2, 1.0, np.full(2, 0.2), "gaussian", 1, "mirror", -1)
    mask = np.exp(-np.abs(np.arange(-2, 3)) / 2)
    padded = np.pad(path, ((2, 2), (0, 0)), mode="reflect")
    expected = np.stack([np.convolve(column, mask / mask.sum(), "valid") for column in padded.T], axis=1)
    np.testing.assert_allclose(moved, expected, rtol=0, atol=tolerances.FLOAT64)
    q[20:, 0] = clips.product(q[20:, 0], clips.from_vectors(np.array([0, 3.0, 0])))
    _, moved = backend.bilateral(q, path, 2, 1.0, np.full(2, 0.1), "gaussian", 1, "mirror", -1)
    _, first = backend.bilateral(
        np.ascontiguousarray(q[:20]), path[:20], 2, 1.0, np.full(2, 0.1), "gaussian", 1, "mirror", -1
    )
    # Frame 19 has no later neighbour with a weight: what it is made of are the frames up to 19.
    share = mask[:3] / mask[:3].sum()
    np.testing.assert_allclose(moved[19], share @ path[17:20], rtol=0, atol=tolerances.FLOAT64)
    np.testing.assert_allclose(moved[:18], first[:18], rtol=0, atol=tolerances.FLOAT64)
