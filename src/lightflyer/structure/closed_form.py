"""How closed forms are made public."""

from collections.abc import Callable
from typing import ParamSpec, TypeVar

from lightflyer.program.entry_point import entry_point

P = ParamSpec("P")
R = TypeVar("R")


def closed_form(function: Callable[P, R]) -> Callable[P, R]:
    """An entry point that NumPy runs: too short for a compiler, and a constant in other traces."""
    return entry_point(function, way="numpy")
