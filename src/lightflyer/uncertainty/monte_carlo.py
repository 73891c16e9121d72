"""Monte Carlo for predictions: many slightly different flyers at once, and their results."""

from typing import Any

import jax
import numpy as np

from lightflyer.flight.balance import require_converged
from lightflyer.foundation.precision import quick_entry_point
from lightflyer.prediction.prediction import behaviour

BLOCK = 50
"""Samples evaluated at once."""

Table = dict[str, np.ndarray]


@quick_entry_point
def _tabulate(setup: Any, coordinate: Any) -> dict[str, Any]:
    return behaviour(setup, coordinate, setup[1].radiation.irradiance)


def tabulate(setup: Any, slopes: list[Any], shifts: np.ndarray, coordinate: np.ndarray) -> Table:
    """Behaviour of many flyers at the same coordinates.

    Parameters
    ----------
    setup : tuple of flyer, environment and model
    slopes : list of such tuples, length k
        Derivative of the setup in each input; only scalar numbers may move.
    shifts : array, shape (samples, k)
        Of the inputs.
    coordinate : array, shape (n,)
        [m] or [Pa].

    Returns
    -------
    dict of str to array, shape (samples, n)

    Raises
    ------
    ConvergenceError
        If a root-find failed.
    """
    leaves, structure = jax.tree.flatten(setup)
    rows = [jax.tree.leaves(slope) for slope in slopes]
    moving = [
        number for number in range(len(leaves)) if any(np.any(row[number] != 0.0) for row in rows)
    ]
    blocks = []
    for start in range(0, len(shifts), BLOCK):
        shift = np.pad(
            shifts[start : start + BLOCK],
            ((0, max(0, BLOCK - (len(shifts) - start))), (0, 0)),
            mode="edge",
        )
        moved = list(leaves)
        for number in moving:
            slope = np.array([float(row[number]) for row in rows])
            moved[number] = (leaves[number] + shift @ slope)[:, None]
        table = _tabulate(jax.tree.unflatten(structure, moved), coordinate)
        shape = (BLOCK, coordinate.size)
        blocks.append({name: np.broadcast_to(value, shape) for name, value in table.items()})
    table = {
        name: np.concatenate([block[name] for block in blocks])[: len(shifts)] for name in blocks[0]
    }
    require_converged("Monte Carlo", table.pop("converged") > 0.5, table.pop("residual"))
    return table


def edges(coordinate: np.ndarray, lift_over_weight: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Ends of the band around the strongest lift, by linear interpolation of its logarithm.

    Parameters
    ----------
    coordinate : array, shape (n,)
    lift_over_weight : array, shape (samples, n)

    Returns
    -------
    lower, upper : array, shape (samples,)
        NaN where a flyer does not levitate, the table's end where the band reaches it.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        margin = np.log(np.maximum(lift_over_weight, np.finfo(float).tiny))
    peak = np.argmax(margin, axis=1)[:, None]
    position = np.arange(coordinate.size)
    sinks = margin < 0.0
    before = np.max(np.where(sinks & (position < peak), position, -1), axis=1)
    after = np.min(np.where(sinks & (position > peak), position, coordinate.size), axis=1)
    last = coordinate.size - 1
    lower = np.where(
        before < 0, coordinate[0], _crossing(coordinate, margin, np.clip(before, 0, last - 1))
    )
    upper = np.where(
        after > last, coordinate[-1], _crossing(coordinate, margin, np.clip(after - 1, 0, last - 1))
    )
    flies = np.max(margin, axis=1) >= 0.0
    return np.where(flies, lower, np.nan), np.where(flies, upper, np.nan)


def _crossing(coordinate: np.ndarray, margin: np.ndarray, index: np.ndarray) -> np.ndarray:
    rows = np.arange(len(margin))
    here, there = margin[rows, index], margin[rows, index + 1]
    slope = np.where(there == here, 1.0, there - here)
    way = -here / slope
    return coordinate[index] + way * (coordinate[index + 1] - coordinate[index])


def optimum(
    coordinate: np.ndarray, objective: np.ndarray, table: Table
) -> tuple[np.ndarray, Table]:
    """Where an objective is largest, and the table there, by parabolas through three points.

    Parameters
    ----------
    coordinate : array, shape (n,)
        Evenly spaced.
    objective : array, shape (samples, n)
        NaN and minus infinity count as lowest.
    table : dict of str to array, shape (samples, n)

    Returns
    -------
    coordinate : array, shape (samples,)
        NaN where the objective has no value.
    table : dict of str to array, shape (samples,)
    """
    finite = np.where(np.isfinite(objective), objective, -np.inf)
    index = np.clip(np.argmax(finite, axis=1), 1, coordinate.size - 2)
    rows = np.arange(len(objective))

    def three(values: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        return values[rows, index - 1], values[rows, index], values[rows, index + 1]

    with np.errstate(invalid="ignore", divide="ignore"):
        left, middle, right = three(objective)
        way = np.clip(0.5 * (left - right) / (left - 2.0 * middle + right), -1.0, 1.0)
    known = np.isfinite(finite).any(axis=1)
    way = np.where(np.isfinite(way), way, 0.0)

    def interpolate(values: np.ndarray) -> np.ndarray:
        left, middle, right = three(values)
        with np.errstate(invalid="ignore"):
            curved = 0.5 * (right - left) * way + 0.5 * (left - 2.0 * middle + right) * way**2
        return np.where(known, middle + np.where(np.isfinite(curved), curved, 0.0), np.nan)

    spacing = coordinate[1] - coordinate[0]
    place = np.where(known, coordinate[index] + way * spacing, np.nan)
    return place, {name: interpolate(values) for name, values in table.items()}
