"""Outputs of one flyer at any number of coordinates."""

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from lightflyer.design.outputs import predicted_names, table_of
from lightflyer.design.setup import Setup

POINTS = 301  # Coordinates of a prediction's table

Table: TypeAlias = dict[str, np.ndarray]
"""Outputs by name, each an array over the same coordinates, in SI units."""


@dataclass(frozen=True)
class Place:
    """One coordinate and the outputs there."""

    coordinate: float  #: [m] or [Pa]
    values: dict[str, float]  #: Outputs by name, in SI units


class Evaluator:
    """Evaluates a setup's outputs at any number of coordinates."""

    def __init__(self, setup: Setup):
        self.setup = setup
        self.irradiance = float(setup.environment.radiation.irradiance)

    def __call__(
        self,
        coordinates: np.ndarray,
        irradiance: np.ndarray | None = None,
        names: tuple[str, ...] | None = None,
    ) -> Table:
        """Outputs, by default all, at coordinates, shape (n,); ``irradiance`` (n,)."""
        light = np.full(coordinates.shape, self.irradiance) if irradiance is None else irradiance
        # in the order in which they are listed: JAX sorts them by name
        return table_of(self.setup, coordinates, light, names or predicted_names(self.setup))

    def place(self, coordinate: float) -> Place:
        """One coordinate and all outputs there."""
        values = self(np.array([coordinate]))
        return Place(coordinate, {name: float(column[0]) for name, column in values.items()})
