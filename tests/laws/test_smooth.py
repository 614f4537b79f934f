"""What must hold for automatic smoothing, whatever the clip."""

import clips
import numpy as np
import pytest
import quatfilt as qf
import tolerances
from drawn import dtypes, seeds
from hypothesis import given
from hypothesis import strategies as st
from plugins.properties import examples
from quatfilt.filters.smooth import with_translation

AXIS = np.array([1.0, 2, 2]) / 3

NOISE = 0.1


def alone(backend, q, confidence=None, *, noise=NOISE):
    """Each joint by itself."""
    return backend.smooth(q, None, confidence, np.full(q.shape[1], noise), 0.0)[0]


def body(backend, q, confidence=None, *, noise=NOISE):
    """All joints together, after each by itself."""
    pilot = alone(backend, q, confidence, noise=noise)
    return backend.smooth_body(q, pilot, confidence, np.full(q.shape[1], noise))


SMOOTHERS = {"alone": alone, "body": body}

every_smoother = pytest.mark.parametrize("name", SMOOTHERS)

few = examples(12)
"""Each is a whole clip; the reference takes its time."""


def sample(seed, frames=60, joints=3, sigma=NOISE):
    rng = np.random.default_rng(seed)
    return clips.noisy(rng, clips.smooth(rng, frames, joints, swing=2), sigma), rng


@every_smoother
@few
@given(seed=seeds, weighted=st.booleans())
def test_constant_rotations_on_either_side_go_through(backend, name, seed, weighted):
    """Of the world, and of the body of each joint."""
    q, rng = sample(seed)
    trust = clips.confidences(rng, *q.shape[:2]) if weighted else None
    a, b = clips.random_rotations(rng, 2, 3)
    result = SMOOTHERS[name](backend, q, trust)
    moved = SMOOTHERS[name](backend, clips.product(a, clips.product(q, b)), trust)
    assert clips.angles(moved, clips.product(a, clips.product(result, b))).max() < tolerances.PRINCIPAL_AXES


@every_smoother
@few
@given(seed=seeds, dtype=dtypes)
def test_signs_do_not_matter(backend, name, seed, dtype):
    q, rng = sample(seed)
    q = q.astype(dtype)
    other = clips.flipped(rng, q).astype(dtype)
    result, flipped = (SMOOTHERS[name](backend, x) for x in (q, other))
    sides = np.sign(np.sum(q[0] * other[0], axis=-1))[:, None]
    np.testing.assert_array_equal(result, flipped * sides)


@every_smoother
@few
@given(seed=seeds, dtype=dtypes, frames=st.integers(0, 40))
def test_output_is_unit_continuous_and_starts_in_the_hemisphere_of_the_input(
    backend, name, seed, dtype, frames
):
    q, rng = sample(seed, frames)
    q = clips.flipped(rng, q).astype(dtype)
    result = SMOOTHERS[name](backend, q)
    assert result.dtype == dtype
    assert result.shape == q.shape
    np.testing.assert_allclose(np.linalg.norm(result, axis=-1), 1, atol=tolerances.algebra(dtype))
    assert (np.sum(result[:1] * q[:1], axis=-1) >= 0).all()
    if frames > 1:
        assert (np.sum(result[1:] * result[:-1], axis=-1) >= 0).all()


@every_smoother
@pytest.mark.parametrize("frames", [2, 3, 30, 600])
def test_constant_clips_stay(backend, name, frames):
    q = np.repeat(clips.random_rotations(np.random.default_rng(1), 1, 4), frames, axis=0)
    result = SMOOTHERS[name](backend, q)
    np.testing.assert_allclose(result, q, rtol=0, atol=tolerances.ALGEBRA)


@every_smoother
@few
@given(seed=seeds)
def test_joints_in_another_order_give_the_same(backend, name, seed):
    q, rng = sample(seed, 120, 4)
    order = rng.permutation(4)
    result, other = (SMOOTHERS[name](backend, np.ascontiguousarray(x)) for x in (q, q[:, order]))
    if name == "alone":
        np.testing.assert_array_equal(other, result[:, order])
    else:
        assert clips.angles(other, result[:, order]).max() < tolerances.PRINCIPAL_AXES


@every_smoother
@pytest.mark.parametrize("frames", [4, 64, 256])
@few
@given(seed=seeds)
def test_a_clip_that_runs_backwards_gives_the_same(backend, name, frames, seed):
    """Where one block holds all of it; of more blocks, the last one begins where it can."""
    q, _ = sample(seed, frames, 1)
    forwards, backwards = (SMOOTHERS[name](backend, np.ascontiguousarray(x)) for x in (q, q[::-1]))
    tolerance = tolerances.principal_axes(np.float64, frames)
    assert clips.angles(forwards, backwards[::-1]).max() < tolerance


@every_smoother
@pytest.mark.parametrize("noise", [1e-4, 1e-2])
@pytest.mark.parametrize("rate", [0.01, 0.1, 0.3])
@pytest.mark.parametrize("frames", [256, 400, 1100])
def test_steady_turns_stay_however_far(backend, name, frames, rate, noise):
    """Where they stand out of the noise: differences of order 2 or 3 are penalised, and there are none."""
    q = clips.from_vectors(rate * np.arange(frames)[:, None, None] * AXIS)
    assert clips.angles(SMOOTHERS[name](backend, q, noise=noise), q).max() < 1e-10


@every_smoother
@pytest.mark.parametrize("frames", [30, 300, 1100])
def test_noise_goes(backend, name, frames):
    rng = np.random.default_rng(2)
    clean = clips.smooth(rng, frames, 3)
    q = clips.noisy(rng, clean, NOISE)
    error, noise = (np.sqrt(np.mean(clips.angles(x, clean) ** 2)) for x in (SMOOTHERS[name](backend, q), q))
    assert error < 0.5 * noise


def test_joints_that_swing_alike_steady_each_other(backend):
    """Of their noise, each has the mean of all twelve, by half."""
    rng = np.random.default_rng(3)
    angle = np.sin(np.arange(400) / 12)[:, None, None]
    clean = clips.from_vectors(np.repeat(angle * AXIS, 12, axis=1))
    q = clips.noisy(rng, clean, NOISE)
    errors = [np.mean(clips.angles(x, clean) ** 2) for x in (alone(backend, q), body(backend, q))]
    assert errors[1] < 0.6 * errors[0]


@every_smoother
@few
@given(seed=seeds)
def test_joints_without_noise_stay(backend, name, seed):
    q, rng = sample(seed)
    q = clips.flipped(rng, q)
    noise = np.array([NOISE, 0, NOISE])
    result, _ = backend.smooth(q, None, None, noise, 0.0)
    if name == "body":
        pilot, result = result, backend.smooth_body(q, result, None, noise)
        np.testing.assert_allclose(result[:, 1], pilot[:, 1], rtol=0, atol=tolerances.ALGEBRA)
    assert clips.angles(result, q)[:, 1].max() < tolerances.ALGEBRA
    assert clips.angles(result, q)[:, [0, 2]].max() > 0.05


@few
@given(seed=seeds)
def test_what_the_body_does_not_trust_does_not_matter(backend, seed):
    q, rng = sample(seed)
    pilot = alone(backend, q)
    trust = np.where(rng.random(q.shape[:2]) < 0.2, 0.0, 1.0)
    trust[0] = 1
    other = np.where(trust[..., None] == 0, clips.random_rotations(rng, *q.shape[:2]), q)
    result, expected = (backend.smooth_body(x, pilot, trust, np.full(3, NOISE)) for x in (q, other))
    np.testing.assert_array_equal(result, expected)


def test_short_clips_of_many_joints_are_left_to_the_pilot(backend):
    """Three frames for each axis, of which a joint has three."""
    q, _ = sample(4, 90, 11)
    pilot = alone(backend, q)
    for joints in (10, 11):
        part, before = (np.ascontiguousarray(x[:, :joints]) for x in (q, pilot))
        result = backend.smooth_body(part, before, None, np.full(joints, NOISE))
        moved = clips.angles(result, before).max()
        assert moved > 1e-3 if joints == 10 else moved < tolerances.ALGEBRA


# ---- the public function: noise is estimated, samples without confidence are filled in


def public(q, translation=None, **options):
    missing = {"confidence": None, "gaps": "fill", "max_gap": None, "fps": 1.0, "scalar_first": True}
    return with_translation(
        q,
        translation,
        **({"strength": 1.0, "joints": "apart", "learned": False, "noise": "white"} | missing | options),
    )


def test_strength_zero_changes_nothing(backend):
    assert backend is not None
    q, rng = sample(5)
    path = clips.path(rng, len(q))
    result, moved = public(q, path, strength=0)
    assert clips.angles(result, q).max() < tolerances.ALGEBRA
    np.testing.assert_array_equal(moved, path)
    partly = qf.smooth(q, strength=[0, 1, 0])
    assert clips.angles(partly, q)[:, [0, 2]].max() < tolerances.ALGEBRA
    np.testing.assert_array_equal(partly[:, 1], qf.smooth(q)[:, 1])


def test_more_strength_smooths_more(backend):
    assert backend is not None
    q, _ = sample(6, 300)
    rough = [
        np.mean(clips.angles(x[1:], x[:-1]) ** 2)
        for x in (q, *(qf.smooth(q, strength=s) for s in (0.3, 1, 3)))
    ]
    assert (np.diff(rough) < 0).all()


def test_the_least_strengths_hardly_change_anything(backend):
    """Nor are the squares of what is measured in so little noise infinite."""
    assert backend is not None
    q, _ = sample(7)
    for strength in (1e-300, 1e-200, 1e-99, 1e-20, 1e-6):
        # The softest smoother takes a part in four thousand away from the fastest sine.
        assert clips.angles(qf.smooth(q, strength=strength), q).max() < 1e-3 * NOISE


@few
@given(seed=seeds, dtype=dtypes)
def test_missing_samples_do_not_spread(backend, seed, dtype):
    assert backend is not None
    q, rng = sample(seed)
    q = q.astype(dtype)
    gaps = q.copy()
    gaps[20:25, 1] = np.where(rng.random((5, 1)) < 0.5, np.nan, 0)
    result, whole = qf.smooth(gaps), qf.smooth(q)
    assert np.isfinite(result).all()
    assert clips.angles(result, whole)[:, [0, 2]].max() < 20 * tolerances.algebra(dtype)
    assert clips.angles(result, whole)[:, 1].max() < 1
    kept = qf.smooth(gaps, gaps="keep")
    np.testing.assert_array_equal(np.isnan(kept).any(axis=-1), (gaps == 0).all(-1) | np.isnan(gaps).any(-1))


def test_sides_of_longer_gaps_have_the_noise_in_common_and_nothing_else(backend):
    assert backend is not None
    q, _ = sample(12, 120)
    gap = q.copy()
    gap[50:54] = np.nan
    result = qf.smooth(gap, max_gap=3)
    assert np.isnan(result[50:54]).all()
    for side in (slice(0, 50), slice(54, None)):
        alone = qf.smooth(q[side], strength=qf.noise_level(gap) / qf.noise_level(q[side]))
        assert clips.angles(result[side], alone).max() < tolerances.PRINCIPAL_AXES


@few
@given(seed=seeds)
def test_what_is_not_trusted_does_not_matter(backend, seed):
    """Whatever it is: neither its rotation nor its place, nor for the estimate of the noise."""
    assert backend is not None
    q, rng = sample(seed)
    trust = np.where(rng.random(q.shape[:2]) < 0.2, 0.0, 1.0)
    trust[:3] = trust[-3:] = 1
    untrusted = trust[..., None] == 0
    path = clips.path(rng, len(q))
    elsewhere = np.where(trust[:, :1] == 0, 100 * rng.standard_normal(path.shape), path)
    wild = np.where(untrusted, clips.random_rotations(rng, *q.shape[:2]), q)
    gone = np.where(untrusted, np.nan, q)
    expected, along = public(q, path, confidence=trust)
    for other, options in ((wild, {"confidence": trust}), (gone, {})):
        result, moved = public(other, elsewhere, **options)
        np.testing.assert_array_equal(result, expected)
        np.testing.assert_array_equal(moved, along)
    assert np.isfinite(along).all()


def test_without_confidence_anywhere_samples_stay(backend):
    assert backend is not None
    q, rng = sample(8)
    path = clips.path(rng, len(q))
    result, moved = public(q, path, confidence=np.zeros(q.shape[:2]))
    assert clips.angles(result, q).max() < tolerances.ALGEBRA
    np.testing.assert_array_equal(moved, path)


def test_full_confidence_is_none(backend):
    assert backend is not None
    q, rng = sample(9)
    path = clips.path(rng, len(q))
    result, moved = public(q, path, confidence=np.ones(q.shape[:2]))
    expected, along = public(q, path)
    assert clips.angles(result, expected).max() < tolerances.PRINCIPAL_AXES
    np.testing.assert_allclose(moved, along, rtol=0, atol=tolerances.PRINCIPAL_AXES)


def test_the_translation_is_smoothed_by_its_own_noise(backend):
    """Wherever it starts, in any unit."""
    assert backend is not None
    q, rng = sample(10, 500)
    clean = np.stack([np.sin(np.arange(500) / 40), np.cos(np.arange(500) / 55), np.arange(500) / 100], axis=1)
    path = clean + rng.normal(0, 0.03, clean.shape)
    _, moved = public(q, path)
    assert np.sqrt(np.mean((moved - clean) ** 2)) < 0.4 * 0.03
    _, elsewhere = public(q, 100 * path - np.array([3.0, 20, 7]))
    np.testing.assert_allclose(elsewhere, 100 * moved - np.array([3.0, 20, 7]), rtol=0, atol=1e-9)


def test_half_trusted_samples_count_half(backend):
    """A run of samples that lie apart pulls the less, the less it is trusted."""
    assert backend is not None
    rng = np.random.default_rng(11)
    clean = np.tile([1.0, 0, 0, 0], (200, 1, 1))
    q = clips.noisy(rng, clean, 0.02)
    q[90:110] = clips.product(q[90:110], clips.from_vectors(0.06 * AXIS))
    pulls = []
    for share in (1.0, 0.3, 0.05):
        trust = np.ones(200)
        trust[90:110] = share
        pulls.append(clips.angles(qf.smooth(q, confidence=trust), clean)[95:105].mean())
    assert pulls[2] < pulls[1] < pulls[0]
