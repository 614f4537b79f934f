"""Rotations: the algebra on many quaternions."""

from collections.abc import Callable
from dataclasses import dataclass

import agreement
import numpy as np
import quaternion
import quaternionic
import quatfilt as qf
from clips import Array, rotations
from report import Results
from scipy.spatial.transform import Rotation
from timing import Contender, ours, race

FRAMES = 100_000

_SCIPY_PART = 10
"""SciPy's rotations, which take seconds, are timed on so small a part."""


@dataclass(frozen=True)
class _Peer:
    name: str
    call: Callable[[], object]
    as_array: Callable[[object], Array]
    part: int = 1


def run(repetitions: int) -> Results:
    """Measure."""
    results = Results()
    for dtype in (np.float32, np.float64):
        a, b = (rotations(FRAMES, dtype=dtype, seed=seed).reshape(-1, 4) for seed in (1, 2))
        vectors = qf.log(a)
        peers = _peers(*(np.asarray(array, np.float64) for array in (a, b, vectors)))
        calls = {
            "log": lambda a=a: qf.log(a),
            "exp": lambda vectors=vectors: qf.exp(vectors),
            "multiply": lambda a=a, b=b: qf.multiply(a, b),
            "geodesic_distance": lambda a=a, b=b: qf.geodesic_distance(a, b),
        }
        for name, call in calls.items():
            result = call()
            for peer in peers[name]:
                agree = agreement.angles if result.shape[-1] == 4 else agreement.numbers
                agree(f"{name}: {peer.name}", result[: len(result) // peer.part], peer.as_array(peer.call()))
            own = ours(call)
            others = [Contender(peer.name, peer.call, scale=peer.part) for peer in peers[name]]
            copied = vectors if name == "exp" else a
            table = results.table(
                f"{name}, {len(a) / 1e6:.1f} M rotations, {a.dtype}",
                race([*own, *others, Contender("numpy.copy", copied.copy)], repetitions),
                rotations=len(a),
                beside=[contender.name for contender in own],
                notes=[
                    (
                        "numpy.copy is of the (first) input. The other packages compute in float64 and are given float64. "
                        f"* on a part of 1/{_SCIPY_PART}, multiplied."
                    )
                ],
            )
            del result
            if name in {"log", "exp"}:
                for contender in own:
                    gain = table.median("numpy-quaternion") / table.median(contender.name)
                    results.aim(f"{name}, {a.dtype}: numpy-quaternion ÷ {contender.name}", gain, at_least=5)
            if name == "multiply":
                cost = table.median(own[-1].name) / table.median("numpy.copy")
                results.aim(f"multiply, {a.dtype}: {own[-1].name} ÷ numpy.copy", cost, at_most=1.5)
    return results


def _peers(a: Array, b: Array, vectors: Array) -> dict[str, list[_Peer]]:
    """Return the same work by others, on inputs that are ready in their own types."""
    pure = np.concatenate([np.zeros((len(vectors), 1)), vectors], axis=1)
    return {
        name: [numpy_quaternion, quaternionic_array, scipy]
        for name, numpy_quaternion, quaternionic_array, scipy in zip(
            ("log", "exp", "multiply", "geodesic_distance"),
            _numpy_quaternion(a, b, pure),
            _quaternionic(a, b, pure),
            _scipy(*(array[: len(array) // _SCIPY_PART] for array in (a, b, vectors))),
            strict=True,
        )
    }


def _numpy_quaternion(a: Array, b: Array, pure: Array) -> list[_Peer]:
    a, b, pure = (quaternion.as_quat_array(array) for array in (a, b, pure))
    components = quaternion.as_float_array
    distance = quaternion.rotation_intrinsic_distance
    name = "numpy-quaternion"
    return [
        _Peer(name, lambda: np.log(a), lambda q: components(q)[:, 1:]),
        _Peer(name, lambda: np.exp(pure), components),
        _Peer(name, lambda: a * b, components),
        _Peer(name, lambda: distance(a, b), np.asarray),
    ]


def _quaternionic(a: Array, b: Array, pure: Array) -> list[_Peer]:
    a, b, pure = (quaternionic.array(array) for array in (a, b, pure))
    distance = quaternionic.distance.rotation.intrinsic
    name = "quaternionic"
    return [
        _Peer(name, lambda: np.log(a), lambda q: q.ndarray[:, 1:]),
        _Peer(name, lambda: np.exp(pure), lambda q: q.ndarray),
        _Peer(name, lambda: a * b, lambda q: q.ndarray),
        _Peer(name, lambda: distance(a, b), np.asarray),
    ]


def _scipy(a: Array, b: Array, vectors: Array) -> list[_Peer]:
    a, b = (Rotation.from_quat(array, scalar_first=True) for array in (a, b))
    whole = 2 * vectors
    name = "SciPy Rotation"

    def components(rotation: Rotation) -> Array:
        return rotation.as_quat(scalar_first=True)

    def distance() -> Array:
        return (a.inv() * b).magnitude()

    return [
        _Peer(name, a.as_rotvec, lambda vectors: vectors / 2, _SCIPY_PART),
        _Peer(name, lambda: Rotation.from_rotvec(whole), components, _SCIPY_PART),
        _Peer(name, lambda: a * b, components, _SCIPY_PART),
        _Peer(name, distance, np.asarray, _SCIPY_PART),
    ]
