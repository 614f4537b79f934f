"""How a motion is reconstructed: the options of a reconstructor, and what the kernels take."""

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from quatfilt import _validation
from quatfilt.reconstruction.reconstructor.examples import Examples

ReconstructionModel = Literal["local_regression", "local_pca", "local_pcr", "nearest", "mean_pose", "gplvm"]

MODELS: tuple[ReconstructionModel, ...] = (
    "local_regression",
    "local_pca",
    "local_pcr",
    "nearest",
    "mean_pose",
    "gplvm",
)

WINDOW = (0.0, 1 / 12, 1 / 6, 1 / 4)
"""Seconds ago at which control points are compared: a quarter of a second tells a step from a stand."""

STRIDE = 1 / 15
"""Seconds between poses that may be examples: less tells hardly more, and is searched longer."""

SPACING = 2 / 15
"""Seconds between examples of one clip: neighbours in time tell the same, and agree about what is wrong."""

PATIENCE = 0.25
"""Seconds without any control point after which the next one is a new start: a prediction does not know longer."""

POSE_FLOOR = 0.045
"""Radians: how far people differ, joint by joint, beyond what the examples of others differ from each other."""

STEP_FLOOR, HEIGHT_FLOOR, TURN_FLOOR = 0.025, 0.005, 0.05
"""Of the root's step and height as parts of the reach, and of its turn in radians: the root's place in the frame before is an
estimate too, which each frame may put right."""

CONTROL_NOISE, CONTROL_SCALE = 0.01, 0.06
"""Parts of the reach: about a centimetre for an adult, the accuracy of a marker on skin; and six."""

MOST_STEPS = 12
"""Steps of the solver per frame: most frames take five."""

MOST_NEIGHBORS = 1024
"""The cost grows with the cube."""

REFRESH = 1.0
"""Seconds after which all examples are looked at again, where there is a graph: of a million poses that takes some frames' time."""

FARTHEST = 1.5
"""How many times as far as at best since then the last of the examples may be before all are looked at."""

SHARE = 0.95
"""Of the variance that principal components make up."""


@dataclass(frozen=True)
class Settings:
    """Checked options.

    Parameters
    ----------
    order, neighbors : int
        How many poses before count, and how many examples.
    model : str
        One of `MODELS`.
    control_noise, orientation_noise, control_scale : float
        As of the reconstructor, in skeleton units and radians.
    ridge : float
        As of `predict_pose`.
    """

    order: int
    neighbors: int
    model: str
    control_noise: float
    orientation_noise: float
    control_scale: float
    ridge: float

    @classmethod
    def checked(
        cls,
        reach: float,
        *,
        order: Any,
        neighbors: Any,
        model: Any,
        control_noise: Any,
        orientation_noise: Any,
        control_scale: Any,
        ridge: Any,
    ) -> "Settings":
        """Check what a user passed in."""
        noise = CONTROL_NOISE * reach if control_noise is None else control_noise
        scale = CONTROL_SCALE * reach if control_scale is None else control_scale
        return cls(
            _validation.integer(order, "order", at_least=1, at_most=64),
            _validation.integer(neighbors, "neighbors", at_least=1, at_most=MOST_NEIGHBORS),
            _validation.choice(model, "model", MODELS),
            _validation.number(noise, "control_noise", at_least=1e-6 * reach),
            _validation.number(orientation_noise, "orientation_noise", at_least=1e-6),
            _validation.number(scale, "control_scale", above=0, infinite=True),
            _validation.number(ridge, "ridge", at_least=1e-9, at_most=1e6),
        )

    def window(self, fps: float) -> list[int]:
        """Frames ago at which control points are compared, each once."""
        return sorted({round(seconds * fps) for seconds in WINDOW})

    def before(self, fps: float) -> int:
        """How many poses of its clip an example needs before it."""
        return max(self.order, *self.window(fps))

    def kernel(self, examples: Examples) -> tuple[tuple[Any, ...], tuple[str, str, str, float, float, float]]:
        """Return the options and the model that the kernels take."""
        fps, reach = examples.database.fps, examples.reach
        floor: NDArray[np.float64] = np.array(
            [POSE_FLOOR, STEP_FLOOR * reach, STEP_FLOOR * reach, HEIGHT_FLOOR * reach, TURN_FLOOR]
        )
        options = (
            self.order,
            self.neighbors,
            max(1, round(STRIDE * fps)),
            max(1, round(SPACING * fps)),
            np.array(self.window(fps), np.int64),
            self.control_scale,
            max(1, round(PATIENCE * fps)),
            floor,
            MOST_STEPS,
            round(REFRESH * fps),
            FARTHEST,
        )
        return options, (self.model, "pose", "predictive", 0.0, self.ridge, SHARE)


__all__ = ["MODELS", "ReconstructionModel", "Settings"]
