"""What becomes of a molecule that meets a face: the walls that the solver knows."""

from typing import Literal

from lightflyer.core.errors import ParameterError

Wall = Literal["maxwell", "accommodated"]
"""A share α of the molecules leaves at the temperature of the face and the rest is reflected, or
all leave diffusely at one temperature between those of face and arriving gas."""

WALLS: dict[Wall, str] = {"maxwell": "Maxwell walls", "accommodated": "accommodated walls"}
"""Walls in words."""


def require_wall(wall: str) -> Wall:
    """Raise unless the solver knows a wall."""
    for name in WALLS:
        if wall == name:
            return name
    only = "; for free molecules and the force model only" if wall == "cercignani-lampis" else ""
    raise ParameterError(f'wall = "{wall}" is not {" or ".join(WALLS)}{only}')
