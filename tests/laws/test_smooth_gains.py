"""What must hold for corrections with gains, whatever the clip and the network."""

import hashlib

import clips
import networks
import numpy as np
import pytest
import quatfilt as qf
import tolerances
from drawn import dtypes, seeds
from hypothesis import given, settings
from hypothesis import strategies as st
from quatfilt import _core
from quatfilt.filters._gains import FILE, weights
from quatfilt.filters._measured import learned_share
from quatfilt.noise._measure import measure

FEW = settings(max_examples=8)
"""The reference takes its time."""

SHORTEST = 128
"""Frames with which there is a correction."""

CELL = 4


def sample(seed, frames=160, joints=5, sigma=0.05):
    """A noisy walk that turns, two estimates, and the clean one."""
    rng = np.random.default_rng(seed)
    clean = clips.turning(rng, frames, joints, turns=1)
    return [clips.noisy(rng, clean, s) for s in (sigma, sigma / 3, sigma / 4)], rng, clean


def smooth(backend, estimates, confidence=None, *, noise=0.05, share=1.0, layers=None):
    level = np.broadcast_to(np.asarray(noise, np.float64), estimates[0].shape[1]).copy()
    return backend.smooth_gains(*estimates, confidence, level, share, *(layers or networks.drawn(0)))


@FEW
@given(seed=seeds, weighted=st.booleans())
def test_constant_rotations_on_the_left_go_through(backend, seed, weighted):
    estimates, rng, _ = sample(seed)
    trust = clips.confidences(rng, *estimates[0].shape[:2]) if weighted else None
    (a,) = clips.random_rotations(rng, 1)
    result = smooth(backend, estimates, trust)
    moved = smooth(backend, [clips.product(a, x) for x in estimates], trust)
    assert clips.angles(moved, clips.product(a, result)).max() < tolerances.gains(np.float64)


@FEW
@given(seed=seeds)
def test_constant_rotations_on_the_right_go_through(backend, seed):
    estimates, rng, _ = sample(seed)
    (b,) = clips.random_rotations(rng, 1)
    result = smooth(backend, estimates)
    moved = smooth(backend, [clips.product(x, b) for x in estimates])
    assert clips.angles(moved, clips.product(result, b)).max() < tolerances.gains(np.float64)


@FEW
@given(seed=seeds, dtype=dtypes)
def test_signs_do_not_matter(backend, seed, dtype):
    estimates, rng, _ = sample(seed)
    estimates = [x.astype(dtype) for x in estimates]
    others = [clips.flipped(rng, x).astype(dtype) for x in estimates]
    result, flipped = smooth(backend, estimates), smooth(backend, others)
    sides = np.sign(np.sum(estimates[0][0] * others[0][0], axis=-1))[:, None]
    np.testing.assert_allclose(result, flipped * sides, rtol=0, atol=tolerances.gains(dtype))


@FEW
@given(seed=seeds, dtype=dtypes)
def test_output_is_unit_continuous_and_starts_in_the_hemisphere_of_the_input(backend, seed, dtype):
    estimates, rng, _ = sample(seed)
    estimates = [clips.flipped(rng, x).astype(dtype) for x in estimates]
    result = smooth(backend, estimates, noise=[0.05, 0, 0.05, 0.05, 0.05])
    assert result.dtype == dtype
    np.testing.assert_allclose(np.linalg.norm(result, axis=-1), 1, atol=tolerances.algebra(dtype))
    assert (np.sum(result[1:] * result[:-1], axis=-1) >= 0).all()
    assert (np.sum(result[0] * estimates[0][0], axis=-1) >= 0).all()


@FEW
@given(seed=seeds)
def test_joints_without_noise_stay_and_have_no_say(backend, seed):
    estimates, _, _ = sample(seed)
    noise = np.array([0.05, 0, 0.05, 1e-7, 0.05])
    noisy = noise > 1e-6
    result = smooth(backend, estimates, noise=noise)
    assert clips.angles(result, estimates[2])[:, ~noisy].max() < tolerances.ALGEBRA
    alone = smooth(backend, [np.ascontiguousarray(x[:, noisy]) for x in estimates])
    assert clips.angles(result[:, noisy], alone).max() < tolerances.gains(np.float64)


@FEW
@given(seed=seeds)
def test_the_order_of_joints_does_not_matter(backend, seed):
    estimates, rng, _ = sample(seed)
    order = rng.permutation(5)
    result = smooth(backend, estimates)
    other = smooth(backend, [np.ascontiguousarray(x[:, order]) for x in estimates])
    assert clips.angles(result[:, order], other).max() < tolerances.gains(np.float64)


@FEW
@given(seed=seeds)
def test_samples_without_confidence_do_not_matter(backend, seed):
    estimates, rng, _ = sample(seed)
    trust = np.where(rng.random(estimates[0].shape[:2]) < 0.1, 0.0, 1.0)
    other = np.where(trust[..., None] == 0, clips.random_rotations(rng, *trust.shape), estimates[0])
    result, expected = (smooth(backend, [q, *estimates[1:]], trust) for q in (estimates[0], other))
    assert clips.angles(result, expected).max() < tolerances.FLOAT64


@pytest.mark.parametrize("frames", [0, 1, SHORTEST - 1, SHORTEST])
@pytest.mark.parametrize("joints", [0, 1, 3])
def test_short_clips_keep_their_pilot(backend, frames, joints):
    estimates, _, _ = sample(3, frames, max(joints, 1))
    estimates = [np.ascontiguousarray(x[:, :joints]) for x in estimates]
    result = smooth(backend, estimates)
    moved = clips.angles(result, estimates[2]).max(initial=0) if result.size else 0
    assert (moved > tolerances.FLOAT64) == (frames == SHORTEST and joints > 0)


@pytest.mark.parametrize("share", [0.0, 0.5])
def test_the_share_is_a_factor_of_the_correction(backend, share):
    estimates, _, _ = sample(4)
    whole, part = smooth(backend, estimates), smooth(backend, estimates, share=share)
    step = qf.multiply(qf.conjugate(estimates[2]), whole)
    step *= np.where(step[..., :1] < 0, -1, 1)
    expected = qf.multiply(estimates[2], qf.exp(share * qf.log(step)))
    assert clips.angles(part, expected).max() < tolerances.gains(np.float64)


def test_without_gains_the_pilot_stays(backend):
    estimates, _, _ = sample(5)
    result = smooth(backend, estimates, layers=networks.constant(np.zeros(networks.BASES)))
    assert clips.angles(result, estimates[2]).max() < tolerances.FLOAT64


def test_all_scales_of_the_samples_together_are_the_samples(backend):
    """Gains that undo the norms add up the scales to the displacement to the samples."""
    estimates, _, _ = sample(6)
    impulse = np.zeros(512)
    impulse[256] = 1
    norms = []
    for k in range(6):
        wide = (
            sum(
                w * np.roll(impulse, shift * 2**k)
                for w, shift in zip((1, 4, 6, 4, 1), range(-2, 3), strict=True)
            )
            / 16
        )
        norms.append(np.linalg.norm(impulse - wide))
        impulse = wide
    gains = np.zeros(networks.BASES)
    gains[:7] = [*norms, np.linalg.norm(impulse)]
    result = smooth(backend, estimates, layers=networks.constant(gains))
    assert clips.angles(result, estimates[0]).max() < tolerances.gains(np.float64)


def test_frames_beyond_the_reach_do_not_matter_but_for_axes(backend):
    """With one joint that turns about one axis, and steps that later frames only scale, the axes stay."""
    estimates, rng, _ = sample(7, 1200, 1)
    other = [x.copy() for x in estimates]
    other[0][900:] = clips.random_rotations(rng, 300, 1)
    difference = clips.angles(smooth(backend, estimates), smooth(backend, other))
    # 126 frames of the basis, 62 cells of the powers, and a cell of the gains.
    assert difference[: 900 - 126 - (62 + 2) * CELL].max() < tolerances.FLOAT64
    assert difference[860:900].max() > tolerances.gains(np.float64)


def test_real_clips_are_estimated_better_than_by_low_rank(backend, data_dir):
    """People that the network was not trained on, weak noise: at least a tenth of a decibel each, and a quarter in the mean."""
    gains = []
    for name in ("07_01", "86_09"):
        clean = qf.read_motion(next((data_dir / "cmu").rglob(f"{name}.amc"))).rotations
        clean = np.ascontiguousarray(clean[:300])
        q = qf.add_gaussian_noise(clean, sigma=0.016, rng=1)
        noise = qf.noise_level(q)
        smoothed, _ = _core.smooth(q, None, None, noise, 0.0)
        patches = _core.smooth_patches(q, _core.smooth_body(q, smoothed, None, noise), None, noise, 1)
        pilot = _core.smooth_rank(q, patches, None, noise)
        result = backend.smooth_gains(q, patches, pilot, None, noise, 1.0, *weights())
        gains.append(qf.metrics.psnr(clean, result) - qf.metrics.psnr(clean, pilot))
    assert min(gains) > 0.1
    assert np.mean(gains) > 0.25


def test_the_weights_are_those_of_the_checksum():
    expected, name = FILE.with_suffix(".npz.sha256").read_text().split()
    assert name == FILE.name
    assert hashlib.sha256(FILE.read_bytes()).hexdigest() == expected


def test_measured_noise_says_how_much_of_the_correction_counts():
    """All of it for white noise, a third for coloured noise, nothing for motion without noise."""
    rng = np.random.default_rng(9)
    clean = clips.walk(rng, 600, 6)
    white = rng.standard_normal((600, 6, 3))
    coloured = white.copy()
    for t in range(1, len(white)):
        coloured[t] = 0.8 * coloured[t - 1] + 0.6 * white[t]
    with_step, without, all_of_it = {}, {}, {}
    for name, noise in {"clean": 0 * white, "white": white, "coloured": coloured}.items():
        q = qf.multiply(clean, qf.exp(0.03 * noise))
        options = {"joints": "together", "noise": "measured"}
        with_step[name], without[name] = (qf.smooth(q, learned=x, **options) for x in (True, False))
        all_of_it[name] = learned_share(measure(q))
    np.testing.assert_array_equal(with_step["clean"], without["clean"])
    assert clips.angles(with_step["white"], without["white"]).max() > 1e-6
    assert all_of_it == {"clean": 0, "white": 1, "coloured": 1 / 3}


def test_the_step_can_be_left_out():
    estimates, _, _ = sample(8)
    with_step, without = (qf.smooth(estimates[0], joints="together", learned=x) for x in (True, False))
    assert clips.angles(with_step, without).max() > 1e-6
    np.testing.assert_array_equal(qf.smooth(estimates[0]), qf.smooth(estimates[0], learned=True))
