"""The most probable pose: the core against the reference."""

import bodies
import numpy as np
import pytest
import tolerances
from quatfilt import _core, _reference


def agree(*arguments):
    ours, theirs = _core.solve_pose(*arguments), _reference.solve_pose(*arguments)
    for result, expected in zip(ours[:3], theirs[:3], strict=True):
        np.testing.assert_allclose(result, expected, rtol=tolerances.SOLUTION, atol=tolerances.SOLUTION)
    np.testing.assert_allclose(ours[3:5], theirs[3:5], rtol=tolerances.SOLUTION, atol=tolerances.SOLUTION)
    return ours


@pytest.mark.parametrize("up", [0, 1, 2])
@pytest.mark.parametrize("axes", [0, 4])
@pytest.mark.parametrize("seed", range(4))
def test_near_what_is_expected(seed, axes, up):
    rng = np.random.default_rng(seed)
    joints, points = 12, 4
    body, base = bodies.body(rng, joints, points, up), bodies.base(rng, joints)
    prior = bodies.prior(rng, joints, axes, spread=0.1)
    targets = bodies.targets(rng, points, deviation=1.0)
    start = prior.mean + 0.1 * rng.normal(size=len(prior.mean))
    agree(*bodies.arguments(body, base, prior, targets, start))


@pytest.mark.parametrize("most", [1, 2, 3])
@pytest.mark.parametrize("seed", range(4))
def test_step_by_step_where_steps_fail(seed, most):
    rng = np.random.default_rng(seed)
    joints, points = 9, 3
    body, base = bodies.body(rng, joints, points), bodies.base(rng, joints)
    prior, targets = bodies.prior(rng, joints, 2, spread=1.0), bodies.targets(rng, points, deviation=0.01)
    agree(*bodies.arguments(body, base, prior, targets, prior.mean, most))


def test_nothing_is_seen():
    rng = np.random.default_rng(5)
    body, base, prior = bodies.body(rng, 5, 2), bodies.base(rng, 5), bodies.prior(rng, 5, 3)
    targets = bodies.targets(rng, 2)._replace(
        position_deviations=np.full(2, np.inf), orientation_deviations=np.full(2, np.inf)
    )
    for start in (prior.mean, prior.mean + 1):
        x, _, _, likelihood, expected, _ = agree(*bodies.arguments(body, base, prior, targets, start))
        np.testing.assert_allclose(x, prior.mean, rtol=tolerances.SOLUTION, atol=tolerances.SOLUTION)
        assert likelihood == 0
        assert expected <= tolerances.SOLUTION


def test_a_single_joint():
    rng = np.random.default_rng(6)
    body, base, prior = bodies.body(rng, 1, 1), bodies.base(rng, 1), bodies.prior(rng, 1)
    agree(*bodies.arguments(body, base, prior, bodies.targets(rng, 1, deviation=0.5), prior.mean))


def test_wrong_lengths_are_refused():
    rng = np.random.default_rng(7)
    body, base, prior = bodies.body(rng, 3, 2), bodies.base(rng, 3), bodies.prior(rng, 3)
    targets = bodies.targets(rng, 2)
    short = prior._replace(deviation=prior.deviation[:-1].copy())
    zero = prior._replace(deviation=np.zeros_like(prior.deviation))
    late = body._replace(parents=np.array([-1, 2, 0]))
    for arguments, message in [
        ((body, base, short), "deviation: expected 13 elements, got 12"),
        ((body, base, zero), "deviation: expected numbers above 0"),
        ((late, base, prior), "parents: expected one root"),
    ]:
        with pytest.raises(ValueError, match=message):
            _core.solve_pose(*bodies.arguments(*arguments, targets, prior.mean))
