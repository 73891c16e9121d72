"""Derivatives of a prediction's results in its inputs, through the root-finds."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from lightflyer.design.outputs import predicted_names, tabulate_places
from lightflyer.program.entry_point import entry_point
from lightflyer.statics.sinking import longest_night
from lightflyer.uncertainty.inputs import Inputs

Table = dict[str, np.ndarray]


_COORDINATE_STEP = 1e-4  # relative, over which slopes are compared for second derivatives


@entry_point
def _along(setup: Any, coordinate: Any, change: Any, coordinate_change: Any) -> Any:
    """Outputs, and how they change with the setup and the coordinate in one direction."""

    def outputs(moved: Any, place: Any) -> dict[str, Any]:
        light = jnp.broadcast_to(moved.environment.radiation.irradiance, place.shape)
        table = tabulate_places(moved, place, light)
        return {name: table[name] for name in predicted_names(moved)}

    direction = change, coordinate_change * jnp.ones_like(coordinate)
    return jax.jvp(outputs, (setup, coordinate), direction)


@dataclass(frozen=True)
class Derivatives:
    """Outputs at some coordinates with their derivatives."""

    inputs: Inputs
    coordinate: np.ndarray  # shape (n,)
    value: Table  # shape (n,)
    # shape (k + 1, n); derivatives of the value, and of its slope over the coordinate, in the k
    # inputs and, last, the coordinate
    change: Table
    slope_change: Table

    @cached_property
    def covariance(self) -> np.ndarray:
        """Covariance of the inputs, shape (k, k)."""
        return self.inputs.covariance

    def spread(self, gradient: np.ndarray) -> float:
        """Standard uncertainty of what has this gradient, shape (k,), in the inputs."""
        return float(np.sqrt(np.maximum(gradient @ self.covariance @ gradient, 0.0)))

    def spreads(self, name: str) -> np.ndarray:
        """Standard uncertainty of an output at each coordinate, shape (n,)."""
        gradient = self.change[name][:-1]
        variance = np.einsum("ip,ij,jp->p", gradient, self.covariance, gradient)
        return np.sqrt(np.maximum(variance, 0.0))

    def level(self, name: str, point: int) -> np.ndarray:
        """Gradient of the coordinate at which an output keeps its value, shape (k,)."""
        rows = self.change[name][:, point]
        return -rows[:-1] / rows[-1]

    def optimum(self, objective: str, point: int) -> np.ndarray:
        """Gradient of the coordinate of an optimum, shape (k,)."""
        rows = self.slope_change[objective][:, point]
        return -rows[:-1] / rows[-1]

    def moving(self, name: str, point: int, coordinate: np.ndarray) -> np.ndarray:
        """Gradient of an output where the coordinate has a gradient itself, shape (k,)."""
        return self.change[name][:-1, point] + self.change[name][-1, point] * coordinate

    def night(self, name: str, points: tuple[int, int]) -> np.ndarray:
        """Gradient of the night [s] between places that keep an output's value, shape (k,)."""
        setup, tangents = self.inputs.setup_and_tangents()
        moving = zip(*(self.level(name, point) for point in points), strict=True)
        edges = tuple(self.coordinate[list(points)])
        parts = zip(tangents, moving, strict=True)
        return np.array([float(_night(setup, edges, tangent, moves)) for tangent, moves in parts])


@entry_point
def _night(setup: Any, edges: Any, change: Any, edge_changes: Any) -> Any:
    """How the longest night changes with the setup and the edges in one direction [s]."""

    def night(moved: Any, edges: Any) -> Any:
        return longest_night(moved.flyer, moved.environment, moved.model, *edges)

    return jax.jvp(night, (setup, edges), (change, edge_changes))[1]


def derivatives(inputs: Inputs, coordinate: np.ndarray) -> Derivatives:
    """Derivatives of all outputs of a prediction; ``coordinate`` (n,)."""
    # First derivatives are exact. Those of slopes, which say how an optimum moves, are differences
    # of exact ones: differentiating twice would take far longer to compile.
    step = _COORDINATE_STEP * coordinate
    shifted = np.concatenate([coordinate, coordinate - step, coordinate + step])
    setup, tangents = inputs.setup_and_tangents()
    still = jax.tree.map(np.zeros_like, setup)
    directions = [(tangent, 0.0) for tangent in tangents] + [(still, 1.0)]
    moves = [_along(setup, shifted, *direction) for direction in directions]
    value = moves[0][0]
    change = {name: np.stack([move[name] for _, move in moves]) for name in value}
    count = coordinate.size
    step = np.where(step > 0.0, step, np.nan)  # at sea level there is none
    return Derivatives(
        inputs,
        coordinate,
        value={name: values[:count] for name, values in value.items()},
        change={name: rows[:, :count] for name, rows in change.items()},
        slope_change={
            name: (rows[:, 2 * count :] - rows[:, count : 2 * count]) / (2.0 * step)
            for name, rows in change.items()
        },
    )
