"""Principal geodesics of the joints of a motion: what `quatfilt pga` shows."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from quatfilt._typing import Array
from quatfilt.evaluation.channels import Values
from quatfilt.geodesics.pga import Objective, PrincipalGeodesicAnalysis
from quatfilt.motion.motion import Motion


@dataclass(frozen=True)
class Joint:
    """A joint, and what k geodesics make of it."""

    name: str
    spread: float
    """Mean angle from the mean, radians: `R_0`."""
    residuals: Values
    """`R_1`, `R_2`, …, radians."""
    worst: Values
    """The greatest error of a frame, likewise."""
    directions: Values
    """``(k, 3)``: unit axes in the frame of the mean."""
    trouble: str
    """Why there are none of these, or nothing."""


def analyse(motion: Motion, joints: Sequence[int], components: int, objective: Objective) -> list[Joint]:
    """Fit the geodesics of joints, each by itself.

    Parameters
    ----------
    motion : Motion
        What is analysed.
    joints : sequence of int
        Which of its joints.
    components : int
        How many geodesics.
    objective : {"geodesic", "squared", "chordal"}
        What they minimise.

    Returns
    -------
    list of Joint
        In the order of `joints`; those that one chart does not hold say so.
    """
    return [
        _joint(motion.skeleton.names[joint], of(motion, joint), components, objective) for joint in joints
    ]


def of(motion: Motion, joint: int) -> Array:
    """Return the rotations of a joint, ``(frames, 4)``."""
    return np.ascontiguousarray(motion.rotations[:, joint])


def _joint(name: str, q: Array, components: int, objective: Objective) -> Joint:
    nothing = np.full(components, np.nan)
    try:
        fitted = PrincipalGeodesicAnalysis(n_components=components, objective=objective).fit(q)
    except ValueError as error:
        # Half a turn from the mean: the other joints can do without this one.
        trouble = str(error).removeprefix("rotations: ").removesuffix(" at joint 0")
        return Joint(name, np.nan, nothing, nothing, np.full((components, 3), np.nan), trouble)
    errors = [fitted.reconstruction_error(q, k) for k in range(components + 1)]
    return Joint(
        name,
        float(np.nanmean(errors[0])),
        np.asarray(fitted.residuals_, np.float64),
        np.array([np.nanmax(error) for error in errors[1:]], np.float64),
        np.asarray(fitted.components_, np.float64),
        "",
    )


def as_dict(joints: Sequence[Joint]) -> list[dict[str, Any]]:
    """Return plain values, angles in degrees."""
    return [
        {
            "name": joint.name,
            "spread_degrees": float(np.degrees(joint.spread)),
            "residuals_degrees": np.degrees(joint.residuals).tolist(),
            "worst_degrees": np.degrees(joint.worst).tolist(),
            "directions": joint.directions.tolist(),
            **({"trouble": joint.trouble} if joint.trouble else {}),
        }
        for joint in joints
    ]


__all__ = ["Joint", "analyse", "as_dict", "of"]
