"""Monte Carlo for predictions: many slightly different flyers at once, and their results."""

from typing import Any

import numpy as np

from lightflyer.flight.balance import require_converged
from lightflyer.flight.outputs import tabulate
from lightflyer.foundation.precision import quick_entry_point
from lightflyer.foundation.rootfind import Ending
from lightflyer.uncertainty.inputs import Inputs

BLOCK = 50
"""Samples evaluated at once."""

Table = dict[str, np.ndarray]


@quick_entry_point
def _tabulate(setup: Any, coordinate: Any) -> dict[str, Any]:
    return tabulate(setup, coordinate, setup.environment.radiation.irradiance)


def tabulate_samples(inputs: Inputs, samples: np.ndarray, coordinate: np.ndarray) -> Table:
    """Outputs of many flyers at the same coordinates.

    Parameters
    ----------
    inputs : Inputs
    samples : array, shape (samples, k)
        Values of the inputs.
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
    blocks = []
    for start in range(0, len(samples), BLOCK):
        block = samples[start : start + BLOCK]
        filled = np.pad(block, ((0, BLOCK - len(block)), (0, 0)), mode="edge")
        table = _tabulate(inputs.setup_of(filled), coordinate)
        shape = (BLOCK, coordinate.size)
        blocks.append({name: np.broadcast_to(value, shape) for name, value in table.items()})
    table = {
        name: np.concatenate([block[name] for block in blocks])[: len(samples)]
        for name in blocks[0]
    }
    failed = table.pop("converged") < 0.5
    ending = np.where(failed, int(Ending.TOLERANCE_MISSED), int(Ending.CONVERGED))
    require_converged("Monte Carlo", ending, table.pop("residual"))
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
    coordinate: np.ndarray,
    objective: np.ndarray,
    table: Table,
    ends: tuple[bool, bool] = (True, True),
) -> tuple[np.ndarray, Table]:
    """Find where an objective is largest, and the table there, by parabolas through three points.

    Parameters
    ----------
    coordinate : array, shape (n,)
        Evenly spaced.
    objective : array, shape (samples, n)
        NaN and minus infinity count as lowest.
    table : dict of str to array, shape (samples, n)
    ends : tuple of bool
        Whether the first and the last coordinate are ends of the searched range, at which an
        optimum may lie; beyond others it goes on.

    Returns
    -------
    coordinate : array, shape (samples,)
        NaN where the objective has no value, or is largest at an end of the table only.
    table : dict of str to array, shape (samples,)
    """
    finite = np.where(np.isfinite(objective), objective, -np.inf)
    largest = np.argmax(finite, axis=1)
    index = np.clip(largest, 1, coordinate.size - 2)
    beyond = (largest == 0) & (not ends[0]) | (largest == coordinate.size - 1) & (not ends[1])
    rows = np.arange(len(objective))

    def three(values: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        return values[rows, index - 1], values[rows, index], values[rows, index + 1]

    with np.errstate(invalid="ignore", divide="ignore"):
        left, middle, right = three(objective)
        way = np.clip(0.5 * (left - right) / (left - 2.0 * middle + right), -1.0, 1.0)
    known = np.isfinite(finite).any(axis=1)
    way = np.where(np.isfinite(way), way, 0.0)
    # at an end of the table the three may bend upwards, and their parabola has a least value
    way = np.where(largest == index, way, np.sign(largest - index))

    def interpolate(values: np.ndarray) -> np.ndarray:
        left, middle, right = three(values)
        with np.errstate(invalid="ignore"):
            curved = 0.5 * (right - left) * way + 0.5 * (left - 2.0 * middle + right) * way**2
        return np.where(known, middle + np.where(np.isfinite(curved), curved, 0.0), np.nan)

    spacing = coordinate[1] - coordinate[0]
    place = np.where(known & ~beyond, coordinate[index] + way * spacing, np.nan)
    return place, {name: interpolate(values) for name, values in table.items()}


def least_light(
    coordinate: np.ndarray, table: Table, ends: tuple[bool, bool]
) -> tuple[np.ndarray, Table]:
    """Find where each sample needs the least light, and the table there.

    Parameters
    ----------
    coordinate, table, ends
        As for :func:`optimum`; the table has the ``"levitation_irradiance"``.

    Returns
    -------
    coordinate : array, shape (samples,)
        Of samples that need no light, the first such one.
    table : dict of str to array, shape (samples,)
    """
    needed = table["levitation_irradiance"]
    dark = needed == 0.0
    with np.errstate(divide="ignore"):
        logarithm = np.where(dark, np.nan, np.log(needed))
    place, there = optimum(
        coordinate, -logarithm, table | {"levitation_irradiance": logarithm}, ends
    )
    there["levitation_irradiance"] = np.exp(there["levitation_irradiance"])
    rows, first = np.arange(len(needed)), np.argmax(dark, axis=1)
    in_the_dark = dark[rows, first]
    return np.where(in_the_dark, coordinate[first], place), {
        name: np.where(in_the_dark, table[name][rows, first], values)
        for name, values in there.items()
    }
