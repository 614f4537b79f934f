"""Samples of rotations with a known structure: on a geodesic, on surfaces, Gaussian on S³."""

import numpy as np

from quatfilt._typing import Array
from quatfilt.evaluation.channels import Values
from quatfilt.rotations.quaternion import exp, multiply

SAMPLES = 400

SPREAD = 0.6
"""Radians on S³: the greatest parameter along a geodesic."""

CONCENTRATIONS = (6.0, 20.0, 70.0)
"""Eigenvalues of the paper's Γ: deviations of 0.41, 0.22 and 0.12 on S³, 47, 26 and 14 degrees of rotation."""


def axes(rng: np.random.Generator) -> Values:
    """Return three random axes at right angles to each other, as rows."""
    return np.asarray(np.linalg.qr(rng.standard_normal((3, 3)))[0].T, np.float64)


def on_a_geodesic(rng: np.random.Generator) -> Array:
    """Return ``c_v(s)``, with `s` evenly spread and symmetric, so that the mean is the identity."""
    half = SPREAD * rng.random(SAMPLES // 2)
    return exp(np.concatenate([half, -half])[:, None] * axes(rng)[0])


def on_products(rng: np.random.Generator) -> Array:
    """Return ``c_v(s)·c_w(t)``, with `s` wider than `t` and each pair with all signs."""
    first, second, _ = axes(rng)
    s, t = _pairs(rng)
    return multiply(exp(s[:, None] * first), exp(t[:, None] * second))


def on_a_plane(rng: np.random.Generator) -> Array:
    """Return ``exp(s·v + t·w)``: a surface of another form, the half rotation vectors of a plane."""
    first, second, _ = axes(rng)
    s, t = _pairs(rng)
    return exp(s[:, None] * first + t[:, None] * second)


def gaussian(rng: np.random.Generator) -> tuple[Array, Values]:
    """Draw from the density ``exp(−log(q)ᵀ Γ log(q) / 2)`` on S³, the paper's eq. (18).

    Returns
    -------
    array (samples, 4)
    array (3, 3)
        Eigenvectors of Γ as rows, the widest direction first.
    """
    vectors = axes(rng)
    drawn: list[Values] = []
    while len(drawn) < SAMPLES:
        v = (rng.standard_normal(3) / np.sqrt(CONCENTRATIONS)) @ vectors
        # On S³ a shell of radius r has the volume sin² r instead of r².
        if rng.random() < np.sinc(np.linalg.norm(v) / np.pi) ** 2 and np.linalg.norm(v) < np.pi / 2:
            drawn.append(v)
    return exp(np.array(drawn)), vectors


def _pairs(rng: np.random.Generator) -> tuple[Values, Values]:
    """Return parameters along two geodesics: without the symmetry the nearest geodesic is not the first of the product."""
    s, t = SPREAD * rng.random((2, SAMPLES // 4)) * [[1.0], [0.5]]
    return np.concatenate([s, s, -s, -s]), np.concatenate([t, -t, t, -t])


__all__ = [
    "CONCENTRATIONS",
    "SAMPLES",
    "SPREAD",
    "axes",
    "gaussian",
    "on_a_geodesic",
    "on_a_plane",
    "on_products",
]
