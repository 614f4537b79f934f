"""How clips go on beyond their ends."""

from typing import Literal, TypeAlias

Boundary: TypeAlias = Literal["nearest", "mirror", "linear"]
"""The end pose is held; time turns round at the end frame, which is not repeated; the angular velocity is held."""

BOUNDARIES: tuple[Boundary, ...] = ("nearest", "mirror", "linear")

__all__ = ["BOUNDARIES", "Boundary"]
