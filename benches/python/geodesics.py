"""Geodesics: the Karcher mean and principal geodesics of many rotations."""

from collections.abc import Callable

import agreement
import numpy as np
import quatfilt as qf
from clips import Array, rotations
from report import Results
from scipy.spatial.transform import Rotation
from timing import Contender, ours, race, reference

ROTATIONS = 100_000
COMPONENTS = 5

_GEOMSTATS_PART = 100
"""geomstats' estimators, which take minutes, are timed on so small a part."""

_REFERENCE_PART = 10
"""The NumPy reference of the analysis too."""


def run(repetitions: int) -> Results:
    """Measure."""
    results = Results()
    logs = 0.5 * np.random.default_rng(0).standard_normal((ROTATIONS, 3)) * [0.4, 0.3, 0.1]
    centre = rotations(1, dtype=np.float64).reshape(-1, 4)[0]
    q = qf.multiply(np.broadcast_to(centre, (ROTATIONS, 4)), qf.exp(logs))
    peers, note = _geomstats(q)
    _means(results, q, peers.get("FrechetMean"), note, repetitions)
    _analyses(results, q, peers.get("TangentPCA"), note, repetitions)
    return results


def _means(
    results: Results, q: Array, peer: Callable[[], object] | None, note: str, repetitions: int
) -> None:
    scipy = Rotation.from_quat(q, scalar_first=True)
    own = ours(lambda: qf.mean(q))
    slow = reference(lambda: qf.mean(q))
    agreement.angles("mean: reference", qf.mean(q), slow.call())
    others = [slow, Contender("SciPy Rotation.mean", scipy.mean), Contender("numpy.copy", q.copy)]
    if peer is not None:
        others.append(Contender("geomstats FrechetMean", peer, scale=_GEOMSTATS_PART))
    table = results.table(
        f"mean of {ROTATIONS:,} rotations, {q.dtype}",
        race([*own, *others], repetitions),
        rotations=ROTATIONS,
        beside=[contender.name for contender in own],
        notes=["SciPy's is the chordal mean, one eigenvector.", note],
    )
    gain = table.median("NumPy reference") / table.median(own[-1].name)
    results.aim(f"mean: NumPy reference ÷ {own[-1].name}", gain, at_least=20)


def _analyses(
    results: Results, q: Array, peer: Callable[[], object] | None, note: str, repetitions: int
) -> None:
    part = q[: ROTATIONS // _REFERENCE_PART].copy()

    def fit(q: Array) -> Array:
        return qf.PrincipalGeodesicAnalysis(COMPONENTS).fit(q).residuals_

    slow = reference(lambda: fit(part), scale=_REFERENCE_PART)
    agreement.numbers("principal geodesics: reference", fit(part), slow.call())
    own = ours(lambda: fit(q))
    others = [slow]
    if peer is not None:
        others.append(Contender("geomstats TangentPCA", peer, scale=_GEOMSTATS_PART))
    table = results.table(
        f"{COMPONENTS} principal geodesics of {ROTATIONS:,} rotations, {q.dtype}",
        race([*own, *others], repetitions),
        rotations=ROTATIONS,
        beside=[contender.name for contender in own],
        notes=[f"The reference on a part of 1/{_REFERENCE_PART}, multiplied. {note}"],
    )
    milliseconds = 1e3 * table.median(own[-1].name)
    results.aim(f"{COMPONENTS} principal geodesics, {own[-1].name}, ms", milliseconds, at_most=100)


def _geomstats(q: Array) -> tuple[dict[str, Callable[[], object]], str]:
    """Return geomstats' estimators on a part of the rotations, and what to say of them."""
    try:
        from geomstats.geometry.special_orthogonal import SpecialOrthogonal
        from geomstats.learning.frechet_mean import FrechetMean
        from geomstats.learning.pca import TangentPCA
    except ImportError as error:
        return {}, f"Without geomstats: {error}."
    space = SpecialOrthogonal(3, point_type="vector")
    vectors = Rotation.from_quat(q[: len(q) // _GEOMSTATS_PART], scalar_first=True).as_rotvec()
    estimators: dict[str, Callable[[], object]] = {
        "FrechetMean": lambda: FrechetMean(space).fit(vectors),
        "TangentPCA": lambda: TangentPCA(space, n_components=3).fit(vectors),
    }
    return estimators, f"geomstats on a part of 1/{_GEOMSTATS_PART}, multiplied."
