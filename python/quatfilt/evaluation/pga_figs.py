"""Figures 1 to 4 of exact principal geodesic analysis, and `R_k` of the joints of recordings."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from quatfilt._typing import Array
from quatfilt.evaluation import pga_figs_samples as samples
from quatfilt.evaluation.channels import Values
from quatfilt.evaluation.clips import CLIPS, SYNTHETIC, Clip, load, thinned
from quatfilt.evaluation.pga_figs_descent import descend, distances, residual, start
from quatfilt.evaluation.pga_figs_results import Descents, Figures, Gaussian, Joints, Root
from quatfilt.geodesics.pga import PrincipalGeodesicAnalysis
from quatfilt.rotations.mean import mean
from quatfilt.rotations.quaternion import conjugate, exp, geodesic_distance, log, multiply

COMPONENTS = 5

ROOT = {"86_01": "jumps, kicks and punches"}
"""The clip whose root is drawn: fixed before anything was run on it."""

ROOT_FRAMES = 300
ROOT_FPS = 30

TOLERANCES = (1.0, 0.1, 0.01)
"""Degrees of mean angle."""

MOST = 24
"""Geodesics, in the count of how many a tolerance needs."""

_SETS: dict[str, Callable[[np.random.Generator], Array]] = {
    "one geodesic (Fig. 1)": samples.on_a_geodesic,
    "products of two geodesics (Fig. 2)": samples.on_products,
    "a plane of half rotation vectors": samples.on_a_plane,
}


def run(data: Path | None, *, seeds: int, progress: Callable[[int, int], None] | None = None) -> Figures:
    """Compute everything that the figures show.

    Parameters
    ----------
    data : Path or None
        Folder of CMU's recordings; None for the built-in walk.
    seeds : int
        How many samples of the Gaussian are drawn.
    progress : callable or None, default None
        Is told how many of how many parts are done.

    Returns
    -------
    Figures
        The numbers behind the figures.
    """
    clips = load(data, CLIPS)
    tell = progress or (lambda _done, _total: None)
    parts = len(clips) + 3
    low = tuple(_descents(what, make(np.random.default_rng(0))) for what, make in _SETS.items())
    tell(1, parts)
    gaussian = _gaussian(seeds)
    tell(2, parts)
    root = _root(load(data, ROOT)[0])
    tell(3, parts)
    joints = []
    for clip in clips:
        joints.append(_joints(clip))
        tell(3 + len(joints), parts)
    return Figures(low, gaussian, root, tuple(joints))


def tangent_residuals(q: Array, components: int) -> Values:
    """Return the mean angle that 1, 2, … principal axes in the tangent space of the mean leave, for ``(frames, 4)``."""
    centre = mean(q)
    x = multiply(conjugate(centre), q)
    v = log(np.where(x[:, :1] < 0, -x, x)).astype(np.float64)
    found = np.linalg.svd(v, full_matrices=False)[2]
    left = []
    for k in range(1, components + 1):
        near = exp(v @ found[:k].T @ found[:k])
        left.append(float(geodesic_distance(x, near).mean()))
    return np.array(left)


def _descents(what: str, q: Array) -> Descents:
    q = multiply(conjugate(mean(q)), q)
    rng = np.random.default_rng(1)
    first = _random(rng)
    fitted = PrincipalGeodesicAnalysis(n_components=COMPONENTS).fit(q)
    return Descents(
        what,
        printed=_two(q, first, printed=True),
        exact=_two(q, first, printed=False),
        started=2 * float(distances(q, start(q)).mean()),
        residuals=np.asarray(fitted.residuals_, np.float64),
    )


def _two(q: Array, first: Values, *, printed: bool) -> tuple[Values, Values]:
    """Find two directions by the paper's descent, the first from a random start."""
    v, curve = descend(q, first, printed=printed)
    left = residual(q, v)
    if distances(left, v).mean() + np.abs(log(left)).mean() < 1e-9:
        return 2 * curve, np.zeros(1)
    return 2 * curve, 2 * descend(left, start(left), printed=printed)[1]


def _random(rng: np.random.Generator) -> Values:
    v = rng.standard_normal(3)
    return np.asarray(v / np.linalg.norm(v), np.float64)


def _gaussian(seeds: int) -> Gaussian:
    descents: list[Values] = []
    residuals, off = [], []
    for seed in range(seeds):
        q, vectors = samples.gaussian(np.random.default_rng([seed, 3]))
        fitted = PrincipalGeodesicAnalysis(n_components=COMPONENTS).fit(q)
        residuals.append(fitted.residuals_)
        cosines = np.abs(np.sum(fitted.components_[:3] * vectors, axis=-1))
        off.append(np.degrees(np.arccos(np.minimum(cosines, 1))))
        if not seed:
            left = multiply(conjugate(fitted.mean_), q)
            rng = np.random.default_rng(1)
            for component in fitted.components_:
                descents.append(2 * descend(left, _random(rng), printed=True)[1])
                left = residual(left, np.asarray(component, np.float64))
    return Gaussian(seeds, descents, np.array(residuals), np.array(off))


def _root(clip: Clip) -> Root:
    every = max(round(clip.motion.fps / ROOT_FPS), 1)
    motion = thinned(clip, every).motion
    motion = motion.replace(
        rotations=motion.rotations[:ROOT_FRAMES], translation=motion.translation[:ROOT_FRAMES]
    )
    q = np.ascontiguousarray(motion.rotations[:, 0])
    fitted = PrincipalGeodesicAnalysis(n_components=COMPONENTS).fit(q)
    errors = [fitted.reconstruction_error(q, k) for k in range(1, COMPONENTS + 1)]
    return Root(
        clip.name,
        clip.what,
        motion,
        np.asarray(errors, np.float64),
        np.asarray(fitted.residuals_, np.float64),
        tangent_residuals(q, COMPONENTS),
    )


def _joints(clip: Clip) -> Joints:
    """Analyse the joints that count, those apart that one chart does not hold."""
    names = clip.motion.skeleton.names
    kept: list[str] = []
    left_out: list[str] = []
    residuals, tangent = [], []
    needed: dict[float, list[int]] = {tolerance: [] for tolerance in TOLERANCES}
    for place in np.flatnonzero(clip.steady):
        q = np.ascontiguousarray(clip.motion.rotations[:, place])
        if not np.ptp(q, axis=0).any():
            continue
        try:
            fitted = PrincipalGeodesicAnalysis(n_components=MOST).fit(q)
        except ValueError:
            left_out.append(names[place])
            continue
        kept.append(names[place])
        residuals.append(fitted.residuals_[:COMPONENTS])
        tangent.append(tangent_residuals(q, COMPONENTS))
        for tolerance, counts in needed.items():
            enough = np.flatnonzero(np.degrees(fitted.residuals_) <= tolerance)
            counts.append(int(enough[0]) + 1 if len(enough) else MOST + 1)
    return Joints(
        clip.name,
        clip.what,
        tuple(kept),
        np.array(residuals, np.float64).T,
        np.array(tangent, np.float64).T,
        {tolerance: np.array(counts) for tolerance, counts in needed.items()},
        tuple(left_out),
    )


def as_dict(figures: Figures, run: dict[str, Any]) -> dict[str, Any]:
    """Return everything but the motion as plain values, angles in degrees."""

    def degrees(values: Any) -> Any:
        return np.round(np.degrees(values), 6).tolist()

    return {
        **run,
        "seeds": figures.gaussian.seeds,
        "low": [
            {
                "what": one.what,
                "printed": [degrees(curve) for curve in one.printed],
                "exact": [degrees(curve) for curve in one.exact],
                "at_eq_14": degrees(one.started),
                "residuals": degrees(one.residuals),
            }
            for one in figures.low
        ],
        "gaussian": {
            "descents": [degrees(curve) for curve in figures.gaussian.descents],
            "residuals": degrees(figures.gaussian.residuals),
            "off_eigenvectors": np.round(figures.gaussian.off, 3).tolist(),
        },
        "root": {
            "clip": figures.root.clip,
            "errors": degrees(figures.root.errors),
            "residuals": degrees(figures.root.residuals),
            "tangent": degrees(figures.root.tangent),
        },
        "joints": [
            {
                "clip": one.clip,
                "names": list(one.names),
                "residuals": degrees(one.residuals),
                "tangent": degrees(one.tangent),
                "needed": {f"{tolerance:g}": counts.tolist() for tolerance, counts in one.needed.items()},
                "left_out": list(one.left_out),
            }
            for one in figures.joints
        ],
    }


__all__ = ["COMPONENTS", "MOST", "ROOT", "SYNTHETIC", "TOLERANCES", "as_dict", "run", "tangent_residuals"]
