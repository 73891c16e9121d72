"""Derivatives of a prediction's results in its inputs, through the root-finds."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any

import numpy as np

from lightflyer.design.tables import NIGHT_SPEED, predicted_names, tabulate_places
from lightflyer.program.entry_point import elementwise_entry_point, only
from lightflyer.pytree import tree
from lightflyer.pytree.lazy_jax import jax, jnp
from lightflyer.statics.sinking import night_change, night_places
from lightflyer.uncertainty.inputs import Inputs

Table = dict[str, np.ndarray]


_COORDINATE_STEP = 1e-4  # relative, over which slopes are compared for second derivatives


@elementwise_entry_point
def _along(setup: Any, coordinate: Any, change: Any, coordinate_change: Any) -> Any:
    """Outputs, and how they change with the setup and the coordinate in one direction."""

    def outputs(moved: Any, place: Any) -> dict[str, Any]:
        light = jnp.broadcast_to(moved.environment.radiation.irradiance, place.shape)
        found: dict[str, Any] = tabulate_places(moved, place, light)
        return found

    direction = change, coordinate_change * jnp.ones_like(coordinate)
    value, changes = jax.jvp(outputs, (setup, coordinate), direction)
    return value | {_change_of(name): one for name, one in changes.items()}


def _change_of(name: str) -> str:
    return f"change of {name}"


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
        edges = self.coordinate[list(points)]
        (speed,), changes = _directions(self.inputs, night_places(*edges), (NIGHT_SPEED,))
        moving = zip(*(self.level(name, point) for point in points), strict=True)
        return np.array(
            [
                night_change(edges, speed, change, changes[-1, 0], moves)
                for change, moves in zip(changes[:-1, 0], moving, strict=True)
            ]
        )


def _directions(
    inputs: Inputs, coordinate: np.ndarray, names: Sequence[str]
) -> tuple[np.ndarray, np.ndarray]:
    """Outputs, shape (outputs, n), and their derivatives in the k inputs and the coordinate."""
    # those (k + 1, outputs, n)
    setup, tangents = inputs.setup_and_tangents
    still = tree.map_leaves(np.zeros_like, setup)
    changes, advance = [*tangents, still], np.r_[np.zeros(len(tangents)), 1.0]
    run = only(_along, [*names, *map(_change_of, names)])
    if any(np.ndim(leaf) and np.any(leaf) for leaf in tree.leaves(tangents)):  # tables move
        moves = [run(setup, coordinate, *one) for one in zip(changes, advance, strict=True)]
        found = {name: np.stack([move[name] for move in moves]) for name in moves[0]}
    else:  # all directions at once
        shape = len(changes), coordinate.size
        base, change = (
            tree.map_leaves(partial(_in_rows, shape, part), setup, *changes) for part in (0, 1)
        )
        places, forward = np.tile(coordinate, len(changes)), np.repeat(advance, coordinate.size)
        found = {
            name: row.reshape(shape) for name, row in run(base, places, change, forward).items()
        }
    return (
        np.stack([found[name][0] for name in names]),
        np.stack([found[_change_of(name)] for name in names], axis=1),
    )


def _in_rows(shape: tuple[int, int], part: int, number: Any, *changes: Any) -> Any:
    """A number, or its change in each direction, at each place, unless it never changes."""
    if not np.any(changes):
        return (number, changes[0])[part]
    return np.broadcast_to((number, np.reshape(changes, (-1, 1)))[part], shape).ravel()


def derivatives(inputs: Inputs, coordinate: np.ndarray) -> Derivatives:
    """Derivatives of all outputs of a prediction; ``coordinate`` (n,)."""
    # First derivatives are exact. Those of slopes, which say how an optimum moves, are differences
    # of exact ones: differentiating twice would take far longer to compile.
    step = _COORDINATE_STEP * coordinate
    shifted = np.concatenate([coordinate, coordinate - step, coordinate + step])
    names = predicted_names(inputs.design.setup)
    values, changes = _directions(inputs, shifted, names)
    value = dict(zip(names, values, strict=True))
    change = {name: changes[:, row] for row, name in enumerate(names)}
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
