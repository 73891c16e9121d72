"""Monte Carlo for predictions: many slightly different flyers at once, and their results.

A table over the whole searched range shows between which coordinates each sample has its edges and
optima. A second table, of coordinates of each sample's own, looks there closely.
"""

from typing import Any, NamedTuple

import jax
import numpy as np

from lightflyer.design.outputs import tabulate, tabulate_places
from lightflyer.flight.balance import require_converged
from lightflyer.numerics.rootfind import SolverStatus
from lightflyer.program.entry_point import entry_point
from lightflyer.uncertainty.inputs import Inputs

_CLOSER = 25  # coordinates of each sample around each edge and optimum

Table = dict[str, np.ndarray]

_tabulate_each = entry_point(tabulate)


def tabulate_samples(inputs: Inputs, samples: np.ndarray, coordinate: np.ndarray) -> Table:
    """Outputs of many flyers at the same coordinates, shape (samples, n); ``coordinate`` (n,)."""
    setup = inputs.setup_of(samples)
    shape = len(samples), np.shape(coordinate)[-1]
    places = np.broadcast_to(coordinate, shape)
    light = setup.environment.radiation.irradiance
    if any(np.ndim(leaf) > 2 for leaf in jax.tree.leaves(setup)):  # tables for each sample
        found = _tabulate_each(setup, places, light)
    else:
        rows = jax.tree.map(lambda leaf: _in_a_row(leaf, shape), setup)
        found = tabulate_places(rows, places.ravel(), np.broadcast_to(light, shape).ravel())
    table = {
        name: np.broadcast_to(values.reshape(-1, shape[1]), shape) for name, values in found.items()
    }
    failed = table.pop("converged") < 0.5
    status = np.where(failed, int(SolverStatus.TOLERANCE_MISSED), int(SolverStatus.CONVERGED))
    require_converged("Monte Carlo", status, table.pop("residual"))
    return table


def _in_a_row(leaf: Any, shape: tuple[int, int]) -> Any:
    """A number of each sample, shape (samples, 1), for each of its coordinates."""
    return np.broadcast_to(leaf, shape).ravel() if np.ndim(leaf) == 2 else leaf


class SampledPredictions(NamedTuple):
    """Where each sample has its edges and optima."""

    # shape (samples,); of ``"lower"`` and ``"upper"`` edge and of the optima, which have the names
    # of their objectives; NaN where a sample has none
    coordinate: Table
    table: dict[str, Table]  # shape (samples,); outputs at each optimum


def search(
    inputs: Inputs,
    samples: np.ndarray,
    coordinate: np.ndarray,
    table: Table,
    searched: tuple[float, float],
    *,
    logarithmic: bool,
) -> SampledPredictions:
    """Find the edges and optima of each sample.

    Parameters
    ----------
    inputs : Inputs
    samples : array, shape (samples, k)
    coordinate : array, shape (n,)
        In any order; both ends of the searched range are among them.
    table : dict of str to array, shape (samples, n)
    searched : tuple of float
        Ends of the searched range.
    logarithmic : bool
        Whether to search the logarithm of the coordinate.

    Returns
    -------
    SampledPredictions
    """
    increasing, order = np.unique(coordinate, return_index=True)
    inside = (searched[0] <= increasing) & (increasing <= searched[1])
    place = np.log(increasing[inside]) if logarithmic else increasing[inside]
    brackets = _brackets(place, {name: rows[:, order[inside]] for name, rows in table.items()})
    places = [_between(place, *ends, _CLOSER) for ends in brackets]
    closer = np.concatenate(places, axis=1)
    closer = np.exp(closer) if logarithmic else closer
    parts = [slice(part * _CLOSER, (part + 1) * _CLOSER) for part in range(len(brackets))]
    second = tabulate_samples(inputs, samples, closer)
    lower, upper, payload, light = (
        {name: rows[:, part] for name, rows in second.items()} for part in parts
    )
    lift = "lift_over_weight"
    most, at_most = optimum(places[2], payload["payload"], payload)
    least, at_least = least_light(places[3], light)
    found = {
        "lower": crossing(places[0], lower[lift]),
        "upper": crossing(places[1][:, ::-1], upper[lift][:, ::-1]),
        "payload": most,
        "levitation_irradiance": least,
    }
    return SampledPredictions(
        {name: np.exp(where) if logarithmic else where for name, where in found.items()},
        {"payload": at_most, "levitation_irradiance": at_least},
    )


def _brackets(place: np.ndarray, table: Table) -> list[tuple[np.ndarray, np.ndarray]]:
    """Columns between which lower edge, upper edge, most payload and least light lie."""
    lift, needed = table["lift_over_weight"], table["levitation_irradiance"]
    last = lift.shape[1] - 1

    def around(objective: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        best = np.argmax(np.where(np.isnan(objective), -np.inf, objective), axis=1)
        return np.maximum(best - 1, 0), np.minimum(best + 1, last)

    flies = lift >= 1.0
    # of a sample that sinks at every coordinate a narrow band may lie between two
    below, above = around(lift)
    first, final = widest_band(place, flies)
    somewhere = np.any(flies, axis=1)
    ends = (np.maximum(first - 1, 0), first, final, np.minimum(final + 1, last))
    outside, first, final, beyond = (
        np.where(somewhere, end, other)
        for end, other in zip(ends, (below, above, below, above), strict=True)
    )
    return [(outside, first), (final, beyond), around(table["payload"]), around(-needed)]


def _between(place: np.ndarray, start: np.ndarray, stop: np.ndarray, count: int) -> np.ndarray:
    """Evenly spaced places from one column to another, shape (samples, count)."""
    low, high = place[start][:, None], place[stop][:, None]
    return low + (high - low) * np.linspace(0.0, 1.0, count)


def widest_band(place: np.ndarray, flies: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """First and last column of the widest run of true values in each row, shape (samples,)."""
    column = np.arange(place.size)
    first = 1 + np.maximum.accumulate(np.where(flies, -1, column), axis=1)
    width = np.where(flies, place - place[np.minimum(first, place.size - 1)], -1.0)
    last = np.argmax(width, axis=1)
    return first[np.arange(len(flies)), last], last


def crossing(place: np.ndarray, lift_over_weight: np.ndarray) -> np.ndarray:
    """First place of each row with enough lift, by linear interpolation of its logarithm."""
    with np.errstate(divide="ignore", invalid="ignore"):
        margin = np.log(np.maximum(lift_over_weight, np.finfo(float).tiny))
    flies = margin >= 0.0
    rows, first = np.arange(len(margin)), np.argmax(flies, axis=1)
    before = np.maximum(first - 1, 0)
    here, there = margin[rows, before], margin[rows, first]
    way = np.where(first > 0, -here / np.where(there == here, 1.0, there - here), 0.0)
    found = place[rows, before] + way * (place[rows, first] - place[rows, before])
    return np.where(np.any(flies, axis=1), found, np.nan)


def optimum(place: np.ndarray, objective: np.ndarray, table: Table) -> tuple[np.ndarray, Table]:
    """Find where an objective is largest, and the table there, by parabolas."""
    finite = np.where(np.isfinite(objective), objective, -np.inf)
    largest = np.argmax(finite, axis=1)
    index = np.clip(largest, 1, place.shape[1] - 2)
    rows = np.arange(len(objective))

    def three(values: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        return values[rows, index - 1], values[rows, index], values[rows, index + 1]

    with np.errstate(invalid="ignore", divide="ignore"):
        left, middle, right = three(objective)
        way = np.clip(0.5 * (left - right) / (left - 2.0 * middle + right), -1.0, 1.0)
    known = np.isfinite(finite).any(axis=1)
    way = np.where(np.isfinite(way), way, 0.0)
    # at an end of the row the three may bend upwards, and their parabola has a least value
    way = np.where(largest == index, way, np.sign(largest - index))

    def interpolate(values: np.ndarray) -> np.ndarray:
        left, middle, right = three(values)
        with np.errstate(invalid="ignore"):
            curved = 0.5 * (right - left) * way + 0.5 * (left - 2.0 * middle + right) * way**2
        return np.where(known, middle + np.where(np.isfinite(curved), curved, 0.0), np.nan)

    return interpolate(place), {name: interpolate(values) for name, values in table.items()}


def least_light(place: np.ndarray, table: Table) -> tuple[np.ndarray, Table]:
    """Find where each sample needs the least light, and the table there; ``place`` (samples, n)."""
    needed = table["levitation_irradiance"]
    dark = needed == 0.0
    with np.errstate(divide="ignore"):
        logarithm = np.where(dark, np.nan, np.log(needed))
    found, there = optimum(place, -logarithm, table | {"levitation_irradiance": logarithm})
    there["levitation_irradiance"] = np.exp(there["levitation_irradiance"])
    rows, first = np.arange(len(needed)), np.argmax(dark, axis=1)
    in_the_dark = dark[rows, first]
    return np.where(in_the_dark, place[rows, first], found), {
        name: np.where(in_the_dark, table[name][rows, first], values)
        for name, values in there.items()
    }
