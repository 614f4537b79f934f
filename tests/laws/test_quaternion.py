"""The laws of unit quaternions."""

import clips
import numpy as np
import tolerances
from hypothesis import given
from hypothesis import strategies as st

seeds = st.integers(0, 2**32 - 1)
COUNT = 64


def samples(seed, many=1):
    rng = np.random.default_rng(seed)
    return [clips.flipped(rng, clips.random_rotations(rng, COUNT)) for _ in range(many)]


def close(a, b):
    np.testing.assert_allclose(a, b, rtol=0, atol=tolerances.ALGEBRA)


@given(seed=seeds)
def test_exp_inverts_log(backend, seed):
    (q,) = samples(seed)
    close(backend.exp(backend.log(q)), q)


@given(seed=seeds)
def test_log_inverts_exp_up_to_half_a_turn(backend, seed):
    v = np.random.default_rng(seed).standard_normal((COUNT, 3))
    v *= np.minimum(1, 3.0 / np.linalg.norm(v, axis=1))[:, None]
    np.testing.assert_allclose(backend.log(backend.exp(v)), v, rtol=0, atol=8 * tolerances.ALGEBRA)


@given(seed=seeds)
def test_products_are_associative_and_conjugates_are_inverses(backend, seed):
    a, b, c = samples(seed, 3)
    close(backend.multiply(a, backend.multiply(b, c)), backend.multiply(backend.multiply(a, b), c))
    close(backend.multiply(a, backend.conjugate(a)), np.tile([1.0, 0, 0, 0], (COUNT, 1)))
    close(
        backend.conjugate(backend.multiply(a, b)),
        backend.multiply(backend.conjugate(b), backend.conjugate(a)),
    )


@given(seed=seeds)
def test_the_distance_is_a_metric_that_motions_keep(backend, seed):
    a, b, c = samples(seed, 3)
    distance = backend.geodesic_distance
    close(distance(a, b), distance(b, a))
    close(distance(a, -b), distance(a, b))
    close(distance(backend.multiply(c, a), backend.multiply(c, b)), distance(a, b))
    close(distance(backend.multiply(a, c), backend.multiply(b, c)), distance(a, b))
    close(distance(a, -a), np.zeros(COUNT))
    assert (distance(a, b) <= distance(a, c) + distance(c, b) + tolerances.ALGEBRA).all()
    assert (distance(a, b) <= np.pi).all()


@given(seed=seeds, missing=st.sampled_from([0, 0.2, 0.9]), dtype=st.sampled_from([np.float32, np.float64]))
def test_continuous(backend, seed, missing, dtype):
    rng = np.random.default_rng(seed)
    q = clips.flipped(rng, clips.smooth(rng, 40, 3, swing=3)).astype(dtype)
    gone = rng.random((40, 3)) < missing
    q[gone] = np.where(rng.random((40, 3, 1)) < 0.5, np.nan, 0)[gone]
    result = backend.continuous(q)
    assert result.dtype == dtype
    np.testing.assert_array_equal(result[gone], q[gone])
    np.testing.assert_array_equal(np.abs(result), np.abs(q))
    np.testing.assert_array_equal(backend.continuous(result), result)
    for joint in range(3):
        path, before = result[~gone[:, joint], joint], q[~gone[:, joint], joint]
        assert (np.sum(path[1:] * path[:-1], axis=-1) >= 0).all()
        np.testing.assert_array_equal(path[:1], before[:1])


def test_continuous_keeps_its_sign_over_exact_half_turns(backend):
    one, i, j = np.eye(4)[:3]
    path = np.array([one, -one, i, j, -j, one])[:, None]
    np.testing.assert_array_equal(backend.continuous(path)[:, 0], [one, one, -i, -j, -j, one])


def test_scan(backend):
    q = np.zeros((4, 3, 4))
    q[..., 0] = 1
    assert backend.scan(q) == (0, 0.0, 0)
    q[1, 2] = [0, 0, 0, 1.5]
    q[2, 0] = [0, 0.5, 0, 0]
    assert backend.scan(q) == (0, 0.5, 5)
    q[0, 0, 3], q[0, 1, 0], q[0, 2], q[1, 2] = np.nan, np.inf, 0, -np.inf
    assert backend.scan(q) == (4, 0.5, 6)
    assert backend.scan(np.full((2, 2, 4), np.nan)) == (4, 0.0, 0)
    assert backend.scan(np.zeros((0, 2, 4))) == (0, 0.0, 0)
