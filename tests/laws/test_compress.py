"""What holds for compression, whatever the motion."""

import clips
import numpy as np
import pytest
import quatfilt as qf
from drawn import dtypes, seeds, spoilt_clips
from hypothesis import given
from hypothesis import strategies as st
from plugins.properties import examples

SMALL = {
    "lengths": st.sampled_from([0, 1, 2, 3, 5, 33, 64, 200]),
    "joints": st.sampled_from([1, 3]),
}


def errors(q, back):
    """Rotation angles where samples are valid; all others must be NaN."""
    valid = np.isfinite(q).all(axis=-1) & (q != 0).any(axis=-1)
    assert np.isnan(back[~valid]).all()
    assert np.isfinite(back[valid]).all()
    return qf.geodesic_distance(q[valid].astype(np.float64), back[valid].astype(np.float64))


def within(q, tolerance, **options):
    small = qf.compress(q, tolerance=tolerance, **options)
    back = small.decompress()
    assert back.shape == q.shape
    assert back.dtype == q.dtype
    found = errors(q, back)
    assert (found <= tolerance).all()
    assert small.max_error == pytest.approx(found.max(initial=0.0), abs=1e-9)
    return small


@examples(25)
@given(
    q=spoilt_clips(**SMALL),
    tolerance=st.sampled_from([1e-12, 1e-6, 1e-3, 0.02, 1.0, 10.0]),
    quantised=st.booleans(),
)
def test_the_tolerance_holds(backend, q, tolerance, quantised):
    assert backend.compress
    within(q, tolerance, quantised=quantised)


@pytest.mark.parametrize("quantised", [True, False])
def test_of_a_tolerance_below_all_roundings_samples_stay_as_they_are(backend, quantised):
    assert backend.compress
    q = clips.random_rotations(np.random.default_rng(0), 20, 2)
    back = qf.compress(q, tolerance=1e-300, quantised=quantised).decompress()
    np.testing.assert_array_equal(np.abs(back), np.abs(q))


@examples(10)
@given(seed=seeds, dtype=dtypes, tolerance=st.sampled_from([1e-5, np.radians(0.1), 0.2]))
def test_it_holds_for_noise_without_a_mean(backend, seed, dtype, tolerance):
    assert backend.compress
    q = clips.random_rotations(np.random.default_rng(seed), 150, 2).astype(dtype)
    within(q, tolerance)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("turns", [0.5, 1.0, 7.3])
def test_joints_that_spin_past_the_cut_cost_no_more(backend, turns, dtype):
    assert backend.compress
    axis = np.array([0.6, 0.0, 0.8])
    still = clips.from_vectors(np.linspace(0, 2, 400)[:, None] * axis).astype(dtype)[:, None]
    spun = clips.from_vectors(np.linspace(0, turns * 2 * np.pi, 400)[:, None] * axis).astype(dtype)[:, None]
    assert within(spun, 1e-3).nbytes < within(still, 1e-3).nbytes + 60


def test_through_the_points_where_an_angle_is_lost(backend):
    assert backend.compress
    t = np.linspace(0, 4 * np.pi, 500)
    x, y, z = np.eye(3)
    q = clips.product(
        clips.product(clips.from_vectors(0.2 * np.sin(t)[:, None] * x), clips.from_vectors(t[:, None] * y)),
        clips.from_vectors(0.3 * np.cos(2 * t)[:, None] * z),
    )
    assert within(q, 0.01).ratio > 20


def test_joints_with_few_degrees_of_freedom_cost_little(backend):
    assert backend.compress
    rng = np.random.default_rng(1)
    t = np.arange(600)[:, None] / 120
    a, b = 0.9 * np.sin(7 * t), 0.5 * np.cos(4 * t + 1) + 0.1 * np.sin(9 * t)
    pose, x, y, z = clips.random_rotations(rng, 1), *np.eye(3)
    still = np.tile(pose, (600, 1))
    hinge = clips.product(pose, clips.from_vectors(a * x))
    saddle = clips.product(hinge, clips.from_vectors(b * y))
    free = clips.product(saddle, clips.from_vectors(0.4 * np.sin(5 * t + 2) * z))
    sizes = [within(one[:, None], np.radians(0.1)).nbytes for one in (still, hinge, saddle, free)]
    assert sizes[0] < 60
    assert sizes[1] < 0.5 * sizes[3]
    assert sizes[2] < 0.75 * sizes[3]


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_signs_change_nothing_but_the_sign(backend, dtype):
    assert backend.compress
    rng = np.random.default_rng(2)
    q = clips.smooth(rng, 200, 3).astype(dtype)
    flipped = clips.flipped(rng, q).astype(dtype)
    flipped[0, 0] *= -np.sign(np.sum(q[0, 0] * flipped[0, 0]))
    a, b = qf.compress(q, tolerance=0.01), qf.compress(flipped, tolerance=0.01)
    assert abs(a.nbytes - b.nbytes) <= 2
    first, second = a.decompress(), b.decompress()
    signs = np.sign(np.sum(first * second, axis=-1, keepdims=True))
    np.testing.assert_array_equal(first, signs * second)
    for given_clip, small in ((q, a), (flipped, b)):
        back = small.decompress()
        assert (np.sum(back[1:] * back[:-1], axis=-1) >= 0).all()
        assert (np.sum(back[0] * given_clip[0], axis=-1) > 0).all()


def test_a_smaller_tolerance_costs_more(backend):
    assert backend.compress
    q = clips.noisy(np.random.default_rng(3), clips.smooth(np.random.default_rng(3), 400, 2), 0.002)
    sizes = [within(q, tolerance).nbytes for tolerance in (0.1, 0.01, 1e-3, 1e-4, 1e-6)]
    assert sizes == sorted(sizes)
    assert sizes[0] < sizes[-1] / 4


def test_tolerances_by_joint(backend):
    assert backend.compress
    q = clips.smooth(np.random.default_rng(4), 300, 3)
    tolerance = np.array([1e-4, 1e-2, 1e-1])
    small = qf.compress(q, tolerance=tolerance)
    found = errors(q, small.decompress()).reshape(300, 3).max(axis=0)
    assert (found <= tolerance).all()
    assert (found > tolerance / 10).all()


def test_floats_come_back_nearly_exact(backend):
    assert backend.compress
    q = clips.smooth(np.random.default_rng(6), 100, 2)
    small = within(q, 0.01, quantised=False)
    assert small.max_error < 1e-12
    assert 1.2 < small.ratio < 2


def test_scalar_last(backend):
    assert backend.compress
    q = clips.smooth(np.random.default_rng(7), 50, 2)
    last = np.roll(q, -1, axis=-1)
    small = qf.compress(last, tolerance=0.01, scalar_first=False)
    assert small == qf.compress(q, tolerance=0.01)
    np.testing.assert_array_equal(
        small.decompress(scalar_first=False), np.roll(small.decompress(), -1, axis=-1)
    )
