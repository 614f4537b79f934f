"""Principal geodesics against search on a grid, against tangent PCA, and in the hands of scikit-learn."""

import clips
import numpy as np
import pytest
import quatfilt as qf
import tolerances
from quatfilt import _core
from scipy.optimize import minimize
from sklearn.base import clone
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler
from sklearn.utils.validation import check_is_fitted

DIRECTIONS = 10_000
"""On the half sphere: a degree and a half apart."""

REFINED = 10
"""The best of them are refined."""

FUNCTIONS = {
    "geodesic": lambda d: d,
    "squared": lambda d: d**2,
    "chordal": lambda d: 1 - np.cos(d),
}


def spiral():
    """Directions spread evenly over a half sphere."""
    i = np.arange(DIRECTIONS) + 0.5
    z = 1 - i / DIRECTIONS
    turn = np.pi * (1 + 5**0.5) * i
    return np.stack([np.sqrt(1 - z * z) * np.cos(turn), np.sqrt(1 - z * z) * np.sin(turn), z], axis=1)


def objective_at(x, directions, objective):
    """Mean over the samples `x` of a function of the distance to geodesics, from the angle to their plane."""
    p = np.atleast_2d(directions) @ x[:, 1:].T
    cosine = np.minimum(np.sqrt(x[:, 0] ** 2 + p**2), 1)
    d = np.arccos(cosine)
    sine = np.linalg.norm(np.cross(x[None, :, 1:], np.atleast_2d(directions)[:, None]), axis=-1)
    return FUNCTIONS[objective](np.where(cosine > 0.9, np.arcsin(np.minimum(sine, 1)), d)).mean(axis=1)


def lowest(x, objective):
    """Objective of the best direction on the grid, refined by SciPy; the directions of samples are tried too."""
    grid = spiral()
    values = np.concatenate([objective_at(x, part, objective) for part in np.array_split(grid, 20)])
    length = np.linalg.norm(x[:, 1:], axis=1)
    own = x[length > 0, 1:] / length[length > 0, None]
    found = [
        values.min(),
        *np.concatenate([objective_at(x, part, objective) for part in np.array_split(own, 5) if len(part)]),
    ]
    for v in grid[np.argsort(values)[:REFINED]]:
        across = np.linalg.svd(v[None])[2][1:]

        def at(step, v=v, across=across):
            moved = v + step @ across
            return objective_at(x, moved / np.linalg.norm(moved), objective)[0]

        options = {"xatol": 1e-10, "fatol": 1e-14}
        found.append(minimize(at, np.zeros(2), method="Nelder-Mead", options=options).fun)
    return min(found)


def samples(seed):
    """Concentrated, wide, with outliers, planar, nearly planar, repeated, and few samples."""
    rng = np.random.default_rng(seed)
    kind, n = seed % 7, int(rng.integers(5, 120))
    scale = rng.uniform(0.02, 0.8, 3)
    if kind == 1:
        scale *= 0.05
    if kind == 2:
        scale[2] = 0
    if kind == 3:
        scale[2] *= 1e-5
    if kind == 4:
        n = 4
    logs = scale * rng.standard_normal((n, 3))
    if kind == 5:
        logs[: n // 8 + 1] = rng.standard_normal((n // 8 + 1, 3))
    if kind == 6:
        logs = np.repeat(logs[:5], 1 + rng.integers(0, 5, len(logs[:5])), axis=0)
    length = np.linalg.norm(logs, axis=1, keepdims=True)
    logs *= np.minimum(1, 1.3 / np.maximum(length, 1e-9))
    rotation = np.linalg.qr(rng.standard_normal((3, 3)))[0]
    return qf.exp(logs @ rotation)


def seen_from(mean, q):
    x = clips.product(mean * [1, -1, -1, -1], q)
    return x * np.where(x[:, :1] < 0, -1, 1)


def has_centre(q):
    """Whether there is one mean, and no sample near half a turn from it."""
    _, radius, unique = _core.geodesic_centre(q[:, None])
    return bool(unique.all() and radius.max() < np.pi - 1e-3)


SETS = [seed for seed in range(130) if has_centre(samples(seed))][:100]
"""Sets of samples with a centre."""


def test_there_are_a_hundred_sets():
    assert len(SETS) == 100


@pytest.mark.parametrize("seed", SETS)
def test_nothing_on_a_grid_is_better(seed):
    q = samples(seed)
    objective = ("geodesic", "geodesic", "squared", "chordal")[seed // 7 % 4]
    pga = qf.PrincipalGeodesicAnalysis(2, objective=objective).fit(q)
    x = seen_from(pga.mean_, q)
    for k in range(2):
        found = pga.descent_[k][np.isfinite(pga.descent_[k])][-1]
        assert found <= lowest(x, objective) * (1 + 1e-12) + 1e-15
        rest = pga.inverse_transform(pga.transform(q)[:, : k + 1])
        x = seen_from_each(rest, q)


def seen_from_each(rebuilt, q):
    x = clips.product(rebuilt * [1, -1, -1, -1], q)
    return x * np.where(x[:, :1] < 0, -1, 1)


@pytest.mark.parametrize("seed", SETS)
def test_the_first_geodesic_is_nearer_than_the_first_tangent_axis(seed):
    q = samples(seed)
    pga = qf.PrincipalGeodesicAnalysis(1).fit(q)
    x = seen_from(pga.mean_, q)
    logs = qf.log(x)
    axis = np.linalg.eigh(logs.T @ logs)[1][:, -1]
    assert pga.residuals_[0] <= 2 * objective_at(x, axis, "geodesic")[0] + tolerances.FLOAT64


def test_of_a_small_cloud_it_is_tangent_pca():
    """With squared distances, to second order in the width."""
    rng = np.random.default_rng(0)
    for width, tolerance in ((1e-2, 1e-3), (1e-4, 1e-7)):
        logs = width * np.array([1, 0.5, 0.2]) * rng.standard_normal((500, 3))
        q = qf.exp(logs)
        pga = qf.PrincipalGeodesicAnalysis(3, objective="squared").fit(q)
        x = qf.log(seen_from(pga.mean_, q))
        axes = np.linalg.eigh(x.T @ x)[1].T[::-1]
        assert (np.abs(np.sum(axes[:2] * pga.components_[:2], axis=1)) > 1 - tolerance).all()


def test_scikit_learn_copies_chains_and_asks():
    q = clips.noisy(np.random.default_rng(0), clips.smooth(np.random.default_rng(1), 80, 1), 0.1)[:, 0]
    pga = qf.PrincipalGeodesicAnalysis(2, objective="squared", tol=1e-6)
    copy = clone(pga)
    assert copy is not pga
    assert copy.get_params() == pga.get_params()
    assert not hasattr(copy.fit(q), "nothing_")
    chain = make_pipeline(qf.PrincipalGeodesicAnalysis(), StandardScaler())
    chain.set_params(principalgeodesicanalysis__n_components=2)
    scores = chain.fit_transform(q)
    assert scores.shape == (80, 2)
    np.testing.assert_allclose(scores.std(axis=0), 1)
    check_is_fitted(chain)
    back = chain.inverse_transform(scores)
    expected = chain[0].reconstruction_error(q)
    np.testing.assert_allclose(clips.angles(q, back), expected, rtol=0, atol=tolerances.FLOAT64)
    assert "n_components=2" in repr(chain)
