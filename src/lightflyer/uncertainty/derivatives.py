"""Derivatives of a prediction's results in its inputs, by differences of converged solutions.

Each is the mean of the slopes on both sides, which at a kink are two. An input at the end of its
range has the slope of the side that is possible.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from lightflyer.array.namespace import by_numpy
from lightflyer.design.tables import NIGHT_SPEED, predicted_names
from lightflyer.statics.sinking import night_change, night_places
from lightflyer.uncertainty.inputs import Inputs
from lightflyer.uncertainty.monte_carlo import tabulate_samples

Table = dict[str, np.ndarray]


_SHARE = 3e-5  # of a standard uncertainty, over which outputs are compared
_SHARE_OF_SLOPES = 2e-4  # the same where slopes are compared thereafter, which rounding blurs more
_COORDINATE_SHARE = 1e-5  # of the coordinate, over which they are
_FAR = 5e-4  # of the coordinate, over which slopes are compared for second derivatives


@dataclass(frozen=True)
class Derivatives:
    """Outputs at some coordinates with their derivatives."""

    inputs: Inputs
    coordinate: np.ndarray  # shape (n,)
    value: Table  # shape (n,)
    # shape (k + 1, n); derivatives in the k inputs and, last, the coordinate
    change: Table
    _slope_changes: Table = field(default_factory=dict, repr=False)  # those asked for so far

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
        return _moved(self.change[name][:, point])

    def optimum(self, objective: str, point: int) -> np.ndarray:
        """Gradient of the coordinate of an optimum, shape (k,)."""
        if objective not in self._slope_changes:
            self._slope_changes[objective] = self._slope_change(objective)
        return _moved(self._slope_changes[objective][:, point])

    def _slope_change(self, name: str) -> np.ndarray:
        """Derivatives of an output's slope over the coordinate, shape (k + 1, n)."""
        step = _FAR * self.coordinate
        both = np.concatenate([self.coordinate - step, self.coordinate + step])
        (rows,) = np.moveaxis(_directions(self.inputs, both, (name,), _SHARE_OF_SLOPES)[1], 1, 0)
        below, above = np.split(rows, 2, axis=1)
        # at sea level there is none
        return (above - below) / np.where(step > 0.0, 2.0 * step, np.nan)

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


def _moved(rows: np.ndarray) -> np.ndarray:
    """Gradient of the coordinate at which what has these derivatives stays; NaN for a flat one."""
    return -rows[:-1] / (rows[-1] or np.nan)


def _directions(
    inputs: Inputs, coordinate: np.ndarray, names: Sequence[str], share: float = _SHARE
) -> tuple[np.ndarray, np.ndarray]:
    """Outputs, shape (outputs, n), and their derivatives in the k inputs and the coordinate."""
    # those (k + 1, outputs, n)
    values, count = inputs.values, inputs.values.size
    low, high = (values + side * share * inputs.spreads for side in (-1.0, 1.0))
    low = np.where(low < inputs.ranges[:, 0], values, low)
    high = np.where(high > inputs.ranges[:, 1], values, high)
    far = _COORDINATE_SHARE * np.where(coordinate > 0.0, coordinate, 1.0)
    # each input, then the coordinate, less, and then more; last all as they are
    samples = np.tile(values, (2 * count + 3, 1))
    places = np.tile(coordinate, (2 * count + 3, 1))
    for first, ends in ((0, low), (count + 1, high)):
        samples[np.arange(first, first + count), np.arange(count)] = ends
    places[count], places[2 * count + 1] = coordinate - far, coordinate + far
    down, up = (np.vstack([np.tile(one[:, None], coordinate.size), far])[:, None]
                for one in (values - low, high - values))  # fmt: skip
    with by_numpy():  # where a step is impossible by so little, nothing is raised
        table = tabulate_samples(inputs, samples, places, names)
        rows = np.stack([table[name] for name in names], axis=1)
        below, above, here = rows[: count + 1], rows[count + 1 : -1], rows[-1]
        slopes = (above - below) / (up + down)
        # where there is nothing on one side, the slope is that of the other
        slopes = np.where(np.isnan(below), (above - here) / up, slopes)
        return here, np.where(np.isnan(above), (here - below) / down, slopes)


def derivatives(inputs: Inputs, coordinate: np.ndarray) -> Derivatives:
    """Derivatives of all outputs of a prediction; ``coordinate`` (n,)."""
    names = predicted_names(inputs.design.setup)
    values, changes = _directions(inputs, coordinate, names)
    return Derivatives(
        inputs,
        coordinate,
        value=dict(zip(names, values, strict=True)),
        change={name: changes[:, row] for row, name in enumerate(names)},
    )
