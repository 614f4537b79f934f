"""Local models against other ways to the same numbers: the primal problem, models that are fitted again, scikit-learn."""

import numpy as np
import pytest
import tolerances
from local_models import examples, predict, vectors
from sklearn.cross_decomposition import PLSRegression
from sklearn.decomposition import PCA
from sklearn.linear_model import LinearRegression

ALL_ALIKE = 1e9
"""Radians: a bandwidth with which all examples have the same weight."""

SIZES = [(40, 1, 2), (12, 3, 4), (6, 2, 1)]
"""Examples, poses and joints: more examples than inputs, and fewer."""


class Problem:
    """The inputs, outputs and weights of a prediction, from its chart."""

    def __init__(self, segments, steps, recent, chart, bandwidth):
        count = len(segments)
        self.x = vectors(chart, segments[:, :-1]).reshape(count, -1)
        self.y = np.concatenate([vectors(chart, segments[:, -1]), steps], axis=1)
        self.query = vectors(chart, recent).reshape(-1)
        squares = np.sum((self.x - self.query) ** 2, axis=1)
        scale = bandwidth**2 or np.sort(squares)[count // 2]
        self.weights = np.exp(-(squares - squares.min()) / (2 * scale))

    def ridge(self, share):
        """`λ`, from the covariance of the inputs."""
        centred = self.x - np.average(self.x, axis=0, weights=self.weights)
        trace = np.trace(centred.T @ (self.weights[:, None] * centred))
        return share * trace / len(self.x)

    def primal(self, used, query, ridge, direction):
        """Predict from the examples `used`, in the space of the inputs: eqs. (8) and (9) of the paper."""
        x, y, weights = self.x[used], self.y[used], self.weights[used, None]
        x_mean, y_mean = (np.sum(weights * z, axis=0) / weights.sum() for z in (x, y))
        x, y = x - x_mean, y - y_mean
        u = x.T @ (weights * y)
        if direction == "local_regression":
            u = np.linalg.solve(x.T @ (weights * x) + ridge * np.eye(x.shape[1]), u)
        along = x @ u
        factor = np.sum(weights * along * y, axis=0) / np.sum(weights * along**2, axis=0)
        return y_mean + factor * ((query - x_mean) @ u)


def close(a, b):
    np.testing.assert_allclose(a, b, atol=tolerances.LOCAL_MODELS_ORACLE)


@pytest.mark.parametrize("bandwidth", [0.0, 1.0])
@pytest.mark.parametrize("model", ["local_regression", "partial_least_squares"])
@pytest.mark.parametrize("size", SIZES)
def test_the_dual_is_the_primal_problem(backend, size, model, bandwidth):
    given = examples(np.random.default_rng(1), *size)
    chart, mean, _, _ = predict(backend, *given, model, bandwidth=bandwidth, ridge=0.05)
    problem = Problem(*given, chart, bandwidth)
    every = np.arange(size[0])
    close(mean, problem.primal(every, problem.query, problem.ridge(0.05), model))


@pytest.mark.parametrize("model", ["local_regression", "partial_least_squares"])
@pytest.mark.parametrize("size", SIZES)
def test_residuals_are_those_of_models_fitted_without_the_example(backend, size, model):
    given = examples(np.random.default_rng(2), *size)
    chart, _, deviation, _ = predict(backend, *given, model, deviation="leave_one_out", ridge=0.05)
    problem = Problem(*given, chart, 0.0)
    every = np.arange(size[0])
    others = [np.delete(every, k) for k in every]
    ridge = problem.ridge(0.05)
    left_out = [problem.y[k] - problem.primal(others[k], problem.x[k], ridge, model) for k in every]
    expected = np.sqrt(np.average(np.square(left_out), axis=0, weights=problem.weights))
    close(deviation, np.maximum(expected, 0.002))


@pytest.mark.parametrize("size", SIZES)
def test_predictive_deviations_are_those_of_a_gaussian_process(backend, size):
    given = examples(np.random.default_rng(3), *size)
    options = {"bandwidth": ALL_ALIKE, "ridge": 0.05}
    chart, _, deviation, _ = predict(backend, *given, "local_regression", **options)
    problem = Problem(*given, chart, ALL_ALIKE)
    ridge = problem.ridge(0.05)
    x = problem.x - problem.x.mean(axis=0)
    query = problem.query - problem.x.mean(axis=0)
    # Variances of a process with covariance x·x' and noise λ, in the space of the inputs: λ (1 + xᵀ (XᵀX + λ)⁻¹ x).
    precision = np.linalg.inv(x.T @ x + ridge * np.eye(x.shape[1]))
    at_query = ridge * (1 + query @ precision @ query)
    squares = []
    for k in range(size[0]):
        others = np.delete(np.arange(size[0]), k)
        without = np.linalg.inv(x[others].T @ x[others] + ridge * np.eye(x.shape[1]))
        residual = problem.y[k] - problem.primal(others, problem.x[k], ridge, "local_regression")
        squares.append(residual**2 / (ridge * (1 + x[k] @ without @ x[k])))
    close(deviation, np.maximum(np.sqrt(np.mean(squares, axis=0) * at_query), 0.002))


@pytest.mark.parametrize("size", SIZES)
def test_partial_least_squares_is_scikit_learns(backend, size):
    given = examples(np.random.default_rng(4), *size)
    chart, mean, _, _ = predict(backend, *given, "partial_least_squares", bandwidth=ALL_ALIKE)
    problem = Problem(*given, chart, ALL_ALIKE)
    for output, expected in enumerate(mean):
        fitted = PLSRegression(n_components=1, scale=False).fit(problem.x, problem.y[:, output])
        close(fitted.predict(problem.query[None]).item(), expected)


@pytest.mark.parametrize("share", [0.5, 0.9, 0.99])
@pytest.mark.parametrize("size", SIZES)
def test_principal_component_regression_is_scikit_learns(backend, size, share):
    given = examples(np.random.default_rng(5), *size)
    chart, mean, _, _ = predict(backend, *given, "local_pcr", bandwidth=ALL_ALIKE, share=share)
    problem = Problem(*given, chart, ALL_ALIKE)
    analysis = PCA(n_components=share, svd_solver="full").fit(problem.x)
    fitted = LinearRegression().fit(analysis.transform(problem.x), problem.y)
    close(mean, fitted.predict(analysis.transform(problem.query[None]))[0])


@pytest.mark.parametrize("share", [0.5, 0.9, 0.99])
@pytest.mark.parametrize("size", SIZES)
def test_axes_are_scikit_learns_principal_components(backend, size, share):
    given = examples(np.random.default_rng(6), *size)
    chart, mean, _, axes = predict(backend, *given, "local_pca", bandwidth=ALL_ALIKE, share=share)
    problem = Problem(*given, chart, ALL_ALIKE)
    analysis = PCA(n_components=share, svd_solver="full").fit(problem.y)
    close(mean, analysis.mean_)
    # scikit-learn divides by one less than the number of examples.
    scale = analysis.explained_variance_ * (size[0] - 1) / size[0]
    close(axes @ axes.T, (analysis.components_.T * scale) @ analysis.components_)


def test_the_nearest_example_and_the_mean(backend):
    given = examples(np.random.default_rng(7), 15, 2, 3)
    chart, mean, _, _ = predict(backend, *given, "nearest")
    problem = Problem(*given, chart, 0.0)
    close(mean, problem.y[np.argmax(problem.weights)])
    chart, mean, deviation, _ = predict(backend, *given, "mean_pose")
    close(mean, np.average(problem.y, axis=0, weights=problem.weights))
    close(deviation**2, np.average((problem.y - mean) ** 2, axis=0, weights=problem.weights))


def test_joint_weights_scale_distances(backend):
    rng = np.random.default_rng(8)
    given = examples(rng, 15, 2, 3)
    weights = np.array([2.0, 0.0, 0.3])
    chart, mean, _, _ = predict(backend, *given, "mean_pose", weights=weights, bandwidth=0.7)
    problem = Problem(*given, chart, 0.7)
    scale = np.tile(np.repeat(weights, 3), 2)
    squares = np.sum(scale * (problem.x - problem.query) ** 2, axis=1)
    close(mean, np.average(problem.y, axis=0, weights=np.exp(-squares / (2 * 0.7**2))))
