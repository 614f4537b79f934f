"""The numbers behind the figures of exact principal geodesic analysis."""

from dataclasses import dataclass

from quatfilt.evaluation.channels import Values
from quatfilt.motion.motion import Motion


@dataclass(frozen=True)
class Descents:
    """Mean distance on the way to the first and the second direction, radians of rotation."""

    what: str
    printed: tuple[Values, Values]
    """With eq. (13): the first from a random start, the second from eq. (14)."""
    exact: tuple[Values, Values]
    """With the gradient of eq. (9), likewise."""
    started: float
    """Mean distance at eq. (14), without a step."""
    residuals: Values
    """`R_k` of the exact analysis."""


@dataclass(frozen=True)
class Gaussian:
    """Figure 3: samples of the paper's Gaussian."""

    seeds: int
    descents: list[Values]
    """Of the first seed: the mean distance on the way to each direction from a random one, with eq. (13), radians of rotation."""
    residuals: Values
    """``(seeds, k)``."""
    off: Values
    """``(seeds, 3)``: degrees between directions and eigenvectors of Γ."""


@dataclass(frozen=True)
class Root:
    """Figure 4: the root of a clip."""

    clip: str
    what: str
    motion: Motion
    errors: Values
    """``(k, frames)``, radians of rotation."""
    residuals: Values
    tangent: Values
    """Mean angle that k tangent principal axes leave."""


@dataclass(frozen=True)
class Joints:
    """`R_k` of the joints of a clip."""

    clip: str
    what: str
    names: tuple[str, ...]
    residuals: Values
    """``(k, joints)``, radians of rotation."""
    tangent: Values
    """The same for tangent principal axes."""
    needed: dict[float, Values]
    """From a mean angle in degrees to how many geodesics each joint needs for it."""
    left_out: tuple[str, ...]
    """Joints that turn half a turn away from their mean."""


@dataclass(frozen=True)
class Figures:
    """All that is shown."""

    low: tuple[Descents, ...]
    gaussian: Gaussian
    root: Root
    joints: tuple[Joints, ...]


__all__ = ["Descents", "Figures", "Gaussian", "Joints", "Root"]
