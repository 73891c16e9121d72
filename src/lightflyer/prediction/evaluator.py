"""Outputs of one flyer at any number of coordinates."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from lightflyer.array.records import ShortRepr
from lightflyer.design.setup import Setup
from lightflyer.design.tables import predicted_names, table_of

POINTS = 301  # Coordinates of a prediction's table

Table: TypeAlias = dict[str, np.ndarray]
"""Outputs by name, each an array over the same coordinates, in SI units."""


@dataclass(frozen=True)
class Place(ShortRepr):
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


class Rows:
    """Table of one flyer as a search takes it: along the coordinate's axis, solved rows alone."""

    def __init__(
        self,
        evaluate: Evaluator,
        coordinates: np.ndarray,
        table: Table,
        exact: Sequence[float] = (),
    ):
        solved = ~np.isnan(table["lift_over_weight"])
        self._evaluate, self._axis = evaluate, evaluate.setup.environment.coordinate
        self.places = self._axis.to_axis(coordinates[solved])  # shape (n,)
        # coordinates that are given back without rounding
        self._exact = np.array([*coordinates[solved][[0, -1]], *exact])
        self.columns = {name: row[solved, None] for name, row in table.items()}  # shape (n, 1)

    def coordinates(self, places: np.ndarray) -> np.ndarray:
        """Coordinates of places of any shape."""
        found = self._axis.from_axis(places)
        for place, coordinate in zip(self._axis.to_axis(self._exact), self._exact, strict=True):
            found = np.where(places == place, coordinate, found)
        return found

    def tabulate(self, places: np.ndarray, names: tuple[str, ...] | None = None) -> Table:
        """Outputs at places of any shape; NaN at those that are NaN."""
        names = names or tuple(self.columns)
        found, asked = np.full((len(names), *places.shape), np.nan), ~np.isnan(places)
        if asked.any():
            table = self._evaluate(self.coordinates(places[asked]), names=names)
            found[:, asked] = [table[name] for name in names]
        return dict(zip(names, found, strict=True))

    def place(self, place: np.ndarray, outputs: Table) -> Place:
        """One place, shape (1,), with its outputs."""
        values = {name: float(one[0]) for name, one in outputs.items()}
        return Place(float(self.coordinates(place)[0]), values)

    def ranges(self, edges: np.ndarray) -> list[tuple[float, float]]:
        """Ranges of the coordinate between edges, shape (2, n, 1), that exist."""
        found = self.coordinates(edges[:, :, 0])
        return [(float(lower), float(upper)) for lower, upper in found.T if lower == lower]
