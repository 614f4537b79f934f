"""The most probable pose: what holds by definition."""

import bodies
import numpy as np
import pytest
import tolerances
from quatfilt._reference.reconstruction import solver

JOINTS, POINTS = 10, 3

STEP = 1e-4
"""Of central differences, whose fourth-order combination is then exact to some 1e-10."""

DERIVATIVE = 1e-8
"""Of a Jacobian with entries up to some tens, against differences."""


def drawn(seed, **options):
    rng = np.random.default_rng(seed)
    body, base = bodies.body(rng, JOINTS, POINTS), bodies.base(rng, JOINTS)
    return rng, body, base, bodies.prior(rng, JOINTS, **options), bodies.targets(rng, POINTS)


@pytest.mark.parametrize("up", [0, 1, 2])
@pytest.mark.parametrize("seed", range(3))
def test_jacobian_against_differences(seed, up):
    rng, body, base, prior, targets = drawn(seed)
    body = body._replace(up=up)
    x = prior.mean + 0.5 * rng.normal(size=len(prior.mean))
    x[3:6] *= 1e-3  # where the series is taken
    _, rows = solver.errors(body, base, targets, x)

    def difference(step):
        sides = [
            np.stack([solver.errors(body, base, targets, x + sign * e)[0] for e in step * np.eye(len(x))], 1)
            for sign in (1, -1)
        ]
        return (sides[0] - sides[1]) / (2 * step)

    np.testing.assert_allclose(
        rows, (4 * difference(STEP) - difference(2 * STEP)) / 3, rtol=0, atol=DERIVATIVE * 10
    )


@pytest.mark.parametrize("axes", [0, 4])
@pytest.mark.parametrize("seed", range(5))
def test_energy_never_rises_and_its_slope_vanishes(backend, seed, axes):
    rng, body, base, prior, _ = drawn(seed, axes=axes)
    targets = bodies.targets(rng, POINTS, deviation=1.0)
    before = solver.energy(body, base, prior, targets, prior.mean)
    for most in (1, 2, 5, 200):
        x, _, _, likelihood, expected, _ = backend.solve_pose(
            *bodies.arguments(body, base, prior, targets, prior.mean, most)
        )
        assert likelihood + expected <= before
        before = likelihood + expected
        again = solver.energy(body, base, prior, targets, x)
        assert abs(again - before) <= tolerances.SOLUTION * max(before, 1)
    error, rows = solver.errors(body, base, targets, x)
    slope = (error @ rows + prior.force(x - prior.mean)) * prior.deviation
    assert np.abs(slope).max() <= SLOPE


SLOPE = 1e-3
"""Energy per standard deviation: what is left to gain is its square."""


def test_dual_step_is_the_least_squares_step(backend):
    """On one step without damping, against the normal equations in the space of the coordinates."""
    _, body, base, prior, targets = drawn(3, axes=2, spread=0.05)
    error, rows = solver.errors(body, base, targets, prior.mean)
    covariance = np.diag(prior.deviation**2) + prior.axes @ prior.axes.T
    step = np.linalg.solve(rows.T @ rows + np.linalg.inv(covariance), -rows.T @ error)
    x, *_, steps = backend.solve_pose(*bodies.arguments(body, base, prior, targets, prior.mean, 1))
    assert steps == 1
    np.testing.assert_allclose(x, prior.mean + step, rtol=0, atol=tolerances.SOLUTION)


def test_turning_and_moving_all_turns_and_moves_the_pose(backend):
    _, body, base, prior, targets = drawn(4)
    angle, away = 2.0, np.array([3.0, 0.0, -5.0])
    q = np.array([np.cos(angle / 2), 0, np.sin(angle / 2), 0])
    moved = base._replace(place=bodies.rotated(q, base.place) + away, heading=base.heading + angle)
    seen = targets._replace(
        positions=bodies.rotated(q, targets.positions) + away,
        orientations=bodies.product(q, targets.orientations),
    )
    x, rotations, translation, *_ = backend.solve_pose(
        *bodies.arguments(body, base, prior, targets, prior.mean)
    )
    x_there, rotations_there, translation_there, *_ = backend.solve_pose(
        *bodies.arguments(body, moved, prior, seen, prior.mean)
    )
    np.testing.assert_allclose(x_there, x, rtol=0, atol=tolerances.SOLUTION)
    np.testing.assert_allclose(
        translation_there, bodies.rotated(q, translation) + away, rtol=0, atol=tolerances.SOLUTION
    )
    np.testing.assert_allclose(rotations_there[1:], rotations[1:], rtol=0, atol=tolerances.SOLUTION)


def test_all_joints_seen_without_noise_give_the_truth(backend):
    rng = np.random.default_rng(8)
    body, base, prior = bodies.body(rng, JOINTS, JOINTS), bodies.base(rng, JOINTS), bodies.prior(rng, JOINTS)
    truth = prior.mean + prior.deviation * rng.normal(size=len(prior.mean))
    seen = solver.control_points(body, base, truth)
    small = np.full(JOINTS, 1e-5)
    targets = solver.Targets(seen.positions, small, seen.orientations, small)
    _, rotations, translation, *_ = backend.solve_pose(
        *bodies.arguments(body, base, prior, targets, prior.mean, 100)
    )
    expected, place = solver.pose(base, truth, body.up)
    np.testing.assert_allclose(np.abs(np.sum(rotations * expected, axis=1)), 1, rtol=0, atol=1e-8)
    np.testing.assert_allclose(translation, place, rtol=0, atol=1e-4)


def test_signs_of_centres_and_orientations_do_not_matter(backend):
    _, body, base, prior, targets = drawn(9)
    first = backend.solve_pose(*bodies.arguments(body, base, prior, targets, prior.mean))
    turned = backend.solve_pose(
        *bodies.arguments(
            body,
            base._replace(centres=-base.centres),
            prior,
            targets._replace(orientations=-targets.orientations),
            prior.mean,
        )
    )
    np.testing.assert_allclose(turned[0], first[0], rtol=0, atol=tolerances.SOLUTION)
    np.testing.assert_allclose(turned[2], first[2], rtol=0, atol=tolerances.SOLUTION)
