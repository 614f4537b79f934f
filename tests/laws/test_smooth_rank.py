"""What must hold for estimates of low rank, whatever the clip."""

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
"""The reference takes its time."""

SHORTEST, FEWEST_JOINTS = 128, 4
"""Frames and joints with which there is an estimate."""


def sample(seed, frames=150, joints=6, sigma=0.05):
    """A noisy walk that turns, and the clean one."""
    rng = np.random.default_rng(seed)
    clean = clips.turning(rng, frames, joints, turns=1)
    return clips.noisy(rng, clean, sigma), rng, clean


def pilot_of(backend, q):
    return backend.gaussian(q, None, None, *(2 * [np.full(q.shape[1], 3.0)]), "mirror")[0]


def smooth(backend, q, pilot=None, confidence=None, *, noise=0.05):
    level = np.broadcast_to(np.asarray(noise, np.float64), q.shape[1]).copy()
    return backend.smooth_rank(q, pilot_of(backend, q) if pilot is None else pilot, confidence, level)


@FEW
@given(seed=seeds, weighted=st.booleans())
def test_constant_rotations_on_either_side_go_through(backend, seed, weighted):
    q, rng, _ = sample(seed)
    trust = clips.confidences(rng, *q.shape[:2]) if weighted else None
    pilot = pilot_of(backend, q)
    a, b = clips.random_rotations(rng, 2)
    moved_q, moved_pilot = (clips.product(a, clips.product(x, b)) for x in (q, pilot))
    result = smooth(backend, q, pilot, trust)
    moved = smooth(backend, moved_q, moved_pilot, trust)
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
    result = smooth(backend, q, noise=[0.05, 0, 0.05, 0.05, 0.05, 0.05])
    assert result.dtype == dtype
    np.testing.assert_allclose(np.linalg.norm(result, axis=-1), 1, atol=tolerances.algebra(dtype))
    assert (np.sum(result[1:] * result[:-1], axis=-1) >= 0).all()
    assert (np.sum(result[0] * q[0], axis=-1) >= 0).all()


@pytest.mark.parametrize("noise", [0.05, 2e-6])
def test_constant_clips_stay(backend, noise):
    q = np.repeat(clips.random_rotations(np.random.default_rng(1), 1, 4), 150, axis=0)
    np.testing.assert_allclose(smooth(backend, q, q, noise=noise), q, rtol=0, atol=tolerances.ALGEBRA)


@FEW
@given(seed=seeds)
def test_joints_without_noise_stay_and_have_no_say(backend, seed):
    q, _, _ = sample(seed)
    pilot = pilot_of(backend, q)
    noise = np.array([0.05, 0, 0.05, 1e-7, 0.05, 0.05])
    noisy = noise > 1e-6
    result = smooth(backend, q, pilot, noise=noise)
    assert clips.angles(result, pilot)[:, ~noisy].max() < tolerances.ALGEBRA
    alone = smooth(backend, np.ascontiguousarray(q[:, noisy]))
    assert clips.angles(result[:, noisy], alone).max() < tolerances.FLOAT64


@FEW
@given(seed=seeds)
def test_the_order_of_joints_does_not_matter(backend, seed):
    q, rng, _ = sample(seed)
    order = rng.permutation(q.shape[1])
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


@pytest.mark.parametrize("frames", [0, 1, 2, SHORTEST - 1, SHORTEST])
@pytest.mark.parametrize("joints", [0, 1, FEWEST_JOINTS - 1, FEWEST_JOINTS])
def test_small_clips_keep_their_pilot(backend, frames, joints):
    q, _, clean = sample(3, frames, max(joints, 1))
    q, clean = (np.ascontiguousarray(x[:, :joints]) for x in (q, clean))
    result = smooth(backend, q, clean)
    moved = clips.angles(result, clean).max(initial=0) if result.size else 0
    assert (moved > tolerances.FLOAT64) == (frames == SHORTEST and joints == FEWEST_JOINTS)


def test_what_lies_more_than_a_window_away_does_not_matter(backend):
    q, rng, _ = sample(4, 1300)
    pilot = pilot_of(backend, q)
    other, other_pilot = q.copy(), pilot.copy()
    other[900:], other_pilot[900:] = clips.random_rotations(rng, 2, 400, 6)
    difference = clips.angles(smooth(backend, q, pilot), smooth(backend, other, other_pilot))
    # The window that begins at 512 is the first one that holds frame 900.
    assert difference[:512].max() < tolerances.FLOAT64
    assert difference[520:900].max() > tolerances.FLOAT64


@pytest.mark.parametrize("sigma", [0.05, 0.2])
def test_joints_that_move_together_are_estimated_better(backend, sigma):
    """On a walk of twenty joints, the error of the pilot falls by a tenth at least."""
    rng = np.random.default_rng(5)
    clean = clips.walk(rng, 720, 20)
    q = clips.noisy(rng, clean, sigma)
    pilot = pilot_of(backend, q)
    result = smooth(backend, q, pilot, noise=sigma)
    before, after = (np.sqrt(np.mean(clips.angles(clean, x) ** 2)) for x in (pilot, result))
    assert after < 0.9 * before


def test_real_clips_are_estimated_better_than_by_patches(backend, data_dir):
    """At strong noise, a quarter of a decibel more than the pilot that `smooth` hands over."""
    gains = []
    for name in ("02_01", "16_15"):
        clean = qf.read_motion(next((data_dir / "cmu").rglob(f"{name}.amc"))).rotations
        clean = np.ascontiguousarray(clean[:320])
        q = qf.add_gaussian_noise(clean, sigma=0.24, rng=1)
        noise = qf.noise_level(q)
        pilot, _ = backend.smooth(q, None, None, noise, 0.0)
        pilot = backend.smooth_patches(q, pilot, None, noise, 1)
        result = backend.smooth_rank(q, pilot, None, noise)
        gains.append(qf.metrics.psnr(clean, result) - qf.metrics.psnr(clean, pilot))
    assert min(gains) > 0.1
    assert np.mean(gains) > 0.25


def test_noise_far_below_all_motion_changes_nothing(backend):
    """Squares of whitened vectors then leave no digits for the noise."""
    q, _, _ = sample(6, sigma=0)
    result = smooth(backend, q, q, noise=2e-6)
    assert clips.angles(result, q).max() < 1e-5
