"""What must hold for estimates from groups of similar patches, whatever the clip."""

import clips
import numpy as np
import pytest
import quatfilt as qf
import tolerances
from drawn import dtypes, seeds
from hypothesis import given
from hypothesis import strategies as st
from plugins.properties import examples

FEW = examples(10)
"""A clip has to be long for patches to be alike."""

SHORTEST = 103
"""Frames of the shortest clip with 80 patches of 24 frames."""

RADIUS, LENGTH = 256, 24
"""Frames: how far patches are looked for, and how long they are."""


def sample(seed, frames=130, joints=4, sigma=0.05):
    """A noisy walk that turns, and the clean one."""
    rng = np.random.default_rng(seed)
    clean = clips.turning(rng, frames, joints, turns=1)
    return clips.noisy(rng, clean, sigma), rng, clean


def pilot_of(backend, q):
    return backend.gaussian(q, None, None, *(2 * [np.full(q.shape[1], 3.0)]), "mirror")[0]


def smooth(backend, q, pilot=None, confidence=None, *, noise=0.05, rounds=1):
    level = np.broadcast_to(np.asarray(noise, np.float64), q.shape[1]).copy()
    pilot = pilot_of(backend, q) if pilot is None else pilot
    return backend.smooth_patches(q, pilot, confidence, level, rounds)


@FEW
@given(seed=seeds, weighted=st.booleans(), rounds=st.integers(1, 2))
def test_constant_rotations_on_either_side_go_through(backend, seed, weighted, rounds):
    q, rng, _ = sample(seed)
    trust = clips.confidences(rng, *q.shape[:2]) if weighted else None
    pilot = pilot_of(backend, q)
    a, b = clips.random_rotations(rng, 2)
    moved_q, moved_pilot = (clips.product(a, clips.product(x, b)) for x in (q, pilot))
    result = smooth(backend, q, pilot, trust, rounds=rounds)
    moved = smooth(backend, moved_q, moved_pilot, trust, rounds=rounds)
    assert clips.angles(moved, clips.product(a, clips.product(result, b))).max() < tolerances.FLOAT64


@FEW
@given(seed=seeds, dtype=dtypes)
def test_signs_do_not_matter(backend, seed, dtype):
    q, rng, _ = sample(seed)
    pilot = pilot_of(backend, q).astype(dtype)
    q = q.astype(dtype)
    other, other_pilot = (clips.flipped(rng, x).astype(dtype) for x in (q, pilot))
    result, flipped = smooth(backend, q, pilot), smooth(backend, other, other_pilot)
    sides = np.sign(np.sum(q[0] * other[0], axis=-1))[:, None]
    np.testing.assert_allclose(result, flipped * sides, rtol=0, atol=tolerances.algebra(dtype))


@FEW
@given(seed=seeds, dtype=dtypes)
def test_output_is_unit_continuous_and_starts_in_the_hemisphere_of_the_input(backend, seed, dtype):
    q, rng, _ = sample(seed)
    q = clips.flipped(rng, q).astype(dtype)
    result = smooth(backend, q, noise=[0.05, 0, 0.05, 0.05])
    assert result.dtype == dtype
    np.testing.assert_allclose(np.linalg.norm(result, axis=-1), 1, atol=tolerances.algebra(dtype))
    assert (np.sum(result[1:] * result[:-1], axis=-1) >= 0).all()
    assert (np.sum(result[0] * q[0], axis=-1) >= 0).all()


@pytest.mark.parametrize("noise", [0.05, 2e-6])
def test_constant_clips_stay(backend, noise):
    q = np.repeat(clips.random_rotations(np.random.default_rng(1), 1, 4), 130, axis=0)
    np.testing.assert_allclose(smooth(backend, q, q, noise=noise), q, rtol=0, atol=tolerances.ALGEBRA)


@FEW
@given(seed=seeds, rounds=st.integers(0, 2))
def test_joints_without_noise_stay_and_have_no_say(backend, seed, rounds):
    q, _, _ = sample(seed, joints=5)
    pilot = pilot_of(backend, q)
    noise = np.array([0.05, 0, 0.05, 1e-7, 0.05])
    noisy = noise > 1e-6
    result = smooth(backend, q, pilot, noise=noise, rounds=rounds)
    assert clips.angles(result, pilot)[:, ~noisy].max() < tolerances.ALGEBRA
    alone = smooth(backend, np.ascontiguousarray(q[:, noisy]), noise=0.05, rounds=rounds)
    assert clips.angles(result[:, noisy], alone).max() < tolerances.FLOAT64


@FEW
@given(seed=seeds)
def test_the_order_of_joints_does_not_matter(backend, seed):
    q, rng, _ = sample(seed, joints=5)
    order = rng.permutation(5)
    result, other = smooth(backend, q), smooth(backend, np.ascontiguousarray(q[:, order]))
    assert clips.angles(result[:, order], other).max() < tolerances.FLOAT64


@FEW
@given(seed=seeds)
def test_full_confidence_is_none(backend, seed):
    q, _, _ = sample(seed)
    result, expected = smooth(backend, q, None, np.ones(q.shape[:2])), smooth(backend, q)
    assert clips.angles(result, expected).max() < tolerances.FLOAT64


@FEW
@given(seed=seeds)
def test_what_is_not_trusted_does_not_matter(backend, seed):
    q, rng, _ = sample(seed)
    pilot = pilot_of(backend, q)
    trust = np.where(rng.random(q.shape[:2]) < 0.1, 0.0, 1.0)
    other = np.where(trust[..., None] == 0, clips.random_rotations(rng, *q.shape[:2]), q)
    result, expected = (smooth(backend, x, pilot, trust) for x in (q, other))
    assert clips.angles(result, expected).max() < tolerances.FLOAT64


@FEW
@given(seed=seeds)
def test_two_rounds_are_one_after_the_other(backend, seed):
    q, _, _ = sample(seed)
    once = smooth(backend, q)
    twice = smooth(backend, q, once)
    assert clips.angles(smooth(backend, q, rounds=2), twice).max() < tolerances.FLOAT64


@pytest.mark.parametrize("frames", [0, 1, 2, SHORTEST - 1, SHORTEST])
@pytest.mark.parametrize("joints", [0, 1, 3])
def test_clips_with_too_few_patches_keep_their_pilot(backend, frames, joints):
    q, _, clean = sample(3, frames, max(joints, 1))
    q, clean = (np.ascontiguousarray(x[:, :joints]) for x in (q, clean))
    result = smooth(backend, q, clean)
    moved = clips.angles(result, clean).max(initial=0) if result.size else 0
    assert (moved > tolerances.FLOAT64) == (frames == SHORTEST and joints > 0)


@pytest.mark.parametrize("seed", [1, 2])
def test_what_lies_far_away_in_time_does_not_matter(backend, seed):
    """With one joint: companions are chosen over the whole clip. The frames lie in different tasks of the core."""
    q, rng, _ = sample(seed, 900, 1)
    pilot = pilot_of(backend, q)
    other, other_pilot = q.copy(), pilot.copy()
    other[700:], other_pilot[700:] = clips.random_rotations(rng, 2, 200, 1)
    result, changed = smooth(backend, q, pilot), smooth(backend, other, other_pilot)
    difference = clips.angles(result, changed)
    assert difference[: 700 - RADIUS - 2 * LENGTH].max() < tolerances.FLOAT64
    assert difference[700 - LENGTH : 700].max() > tolerances.FLOAT64


@pytest.mark.parametrize("sigma", [0.01, 0.05, 0.2])
def test_what_repeats_is_estimated_better(backend, sigma):
    """On a walk of six cycles, the error of the pilot falls by a tenth at least."""
    rng = np.random.default_rng(5)
    clean = clips.walk(rng, 720, 5)
    q = clips.noisy(rng, clean, sigma)
    pilot = pilot_of(backend, q)
    result = smooth(backend, q, pilot, noise=sigma)
    before, after = (np.sqrt(np.mean(clips.angles(clean, x) ** 2)) for x in (pilot, result))
    assert after < 0.9 * before


def test_real_clips_are_estimated_better_than_by_smoothing(backend, data_dir):
    """About half a decibel more than a pilot that was smoothed joint by joint."""
    gains = []
    for name in ("02_01", "16_15"):
        clean = qf.read_motion(next((data_dir / "cmu").rglob(f"{name}.amc"))).rotations
        clean = np.ascontiguousarray(clean[:320])
        q = qf.add_gaussian_noise(clean, sigma=0.08, rng=1)
        noise = qf.noise_level(q)
        pilot, _ = backend.smooth(q, None, None, noise, 0.0)
        result = backend.smooth_patches(q, pilot, None, noise, 1)
        gains.append(qf.metrics.psnr(clean, result) - qf.metrics.psnr(clean, pilot))
    assert min(gains) > 0.2
    assert np.mean(gains) > 0.4


def test_noise_far_below_all_motion_changes_nothing(backend):
    """Squares of whitened vectors then leave no digits for the noise."""
    q, _, _ = sample(6, sigma=0)
    result = smooth(backend, q, q, noise=2e-6)
    assert clips.angles(result, q).max() < 1e-5
