"""Monte Carlo for predictions: many slightly different flyers at once, and their results.

A table over the whole searched range shows between which coordinates each sample has its edges and
optima. Coordinates of each sample's own look there closely, at what is searched alone.
"""

from collections.abc import Callable, Sequence
from typing import Any

import jax
import numpy as np

from lightflyer.design.outputs import table_of, tabulate
from lightflyer.program.entry_point import entry_point
from lightflyer.uncertainty.inputs import Inputs

_CLOSER = 25  # coordinates of each sample around each edge and optimum
_FEWER = (
    4  # of the whole range, one in as many is looked at for the least light, which takes longest
)

LIFT, PAYLOAD, LIGHT = "lift_over_weight", "payload", "levitation_irradiance"

Table = dict[str, np.ndarray]
Look = Callable[[np.ndarray, Sequence[str]], Table]
"""Some outputs of all samples, shape (samples, n), at coordinates (n,) or (samples, n)."""

_tabulate_each = entry_point(tabulate)


def tabulate_samples(
    inputs: Inputs, samples: np.ndarray, coordinate: np.ndarray, names: Sequence[str]
) -> Table:
    """Outputs of many flyers, shape (samples, n); ``coordinate`` (n,) or (samples, n)."""
    setup = inputs.setup_of(samples)
    shape = len(samples), np.shape(coordinate)[-1]
    places = np.broadcast_to(coordinate, shape)
    light = setup.environment.radiation.irradiance
    if any(np.ndim(leaf) > 2 for leaf in jax.tree.leaves(setup)):  # tables for each sample
        found = table_of(setup, places, light, names, _tabulate_each)
    else:
        rows = jax.tree.map(lambda leaf: _in_a_row(leaf, shape), setup)
        found = table_of(rows, places.ravel(), np.broadcast_to(light, shape).ravel(), names)
    return {
        name: np.broadcast_to(values.reshape(-1, shape[1]), shape) for name, values in found.items()
    }


def _in_a_row(leaf: Any, shape: tuple[int, int]) -> Any:
    """A number of each sample, shape (samples, 1), for each of its coordinates."""
    return np.broadcast_to(leaf, shape).ravel() if np.ndim(leaf) == 2 else leaf


def search(
    look: Look, coordinate: np.ndarray, table: Table, whole: np.ndarray, *, logarithmic: bool
) -> Table:
    """Find where each sample has its edges and optima, shape (samples,); NaN where it has none.

    Parameters
    ----------
    look : callable
    coordinate : array, shape (n,)
        In any order.
    table : dict of str to array, shape (samples, n)
        Lift over weight, payload and light needed there.
    whole : array, shape (m,)
        Coordinates over the whole searched range, increasing.
    logarithmic : bool
        Whether to search the logarithm of the coordinate.

    Returns
    -------
    dict of str to array, shape (samples,)
        Coordinates of the edges ``"lower"`` and ``"upper"``, and of the optima, which have the
        names of their objectives.
    """

    def known(names: Sequence[str], more: np.ndarray) -> tuple[np.ndarray, Table]:
        """Places in order with what is known there, after a look at more of them."""
        found = look(more, names)
        places, order = np.unique(np.concatenate([coordinate, more]), return_index=True)
        inside = (whole[0] <= places) & (places <= whole[-1])
        return np.log(places[inside]) if logarithmic else places[inside], {
            name: np.concatenate([table[name], found[name]], axis=1)[:, order[inside]]
            for name in names
        }

    def closely(names: Sequence[str], *places: np.ndarray) -> list[Table]:
        """What is found at places of each sample, array by array."""
        every = np.concatenate(places, axis=1)
        found = look(np.exp(every) if logarithmic else every, names)
        ends = np.cumsum([part.shape[1] for part in places])[:-1]
        parts = {name: np.split(rows, ends, axis=1) for name, rows in found.items()}
        return [{name: parts[name][n] for name in names} for n in range(len(places))]

    place, rows = known((LIFT, PAYLOAD), whole)
    lower, upper = (_between(place, *ends) for ends in _around_edges(place, rows[LIFT]))
    most = _between(place, *_around(rows[PAYLOAD]))
    below, above, best = closely((LIFT, PAYLOAD), lower, upper, most)
    place, rows = known((LIGHT,), whole[::_FEWER])
    least = _between(place, *_around(-rows[LIGHT]))
    (dim,) = closely((LIGHT,), least)
    found = {
        "lower": crossing(lower, below[LIFT]),
        "upper": crossing(upper[:, ::-1], above[LIFT][:, ::-1]),
        PAYLOAD: optimum(most, best[PAYLOAD]),
        LIGHT: least_light(least, dim[LIGHT]),
    }
    return {name: np.exp(where) if logarithmic else where for name, where in found.items()}


def _around(objective: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Columns on either side of the largest value of each row."""
    best = np.argmax(np.where(np.isnan(objective), -np.inf, objective), axis=1)
    return np.maximum(best - 1, 0), np.minimum(best + 1, objective.shape[1] - 1)


def _around_edges(place: np.ndarray, lift: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """Columns between which the lower and the upper edge of each row lie."""
    # of a sample that sinks at every coordinate a narrow band may lie between two
    below, above = _around(lift)
    first, final = widest_band(place, lift >= 1.0)
    somewhere = np.any(lift >= 1.0, axis=1)
    ends = (np.maximum(first - 1, 0), first, final, np.minimum(final + 1, lift.shape[1] - 1))
    outside, first, final, beyond = (
        np.where(somewhere, end, other)
        for end, other in zip(ends, (below, above, below, above), strict=True)
    )
    return [(outside, first), (final, beyond)]


def _between(place: np.ndarray, start: np.ndarray, stop: np.ndarray) -> np.ndarray:
    """Evenly spaced places from one column to another, shape (samples, :data:`_CLOSER`)."""
    low, high = place[start][:, None], place[stop][:, None]
    return low + (high - low) * np.linspace(0.0, 1.0, _CLOSER)


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


def optimum(place: np.ndarray, objective: np.ndarray) -> np.ndarray:
    """Find where each row of an objective is largest, by parabolas; NaN where none is finite."""
    finite = np.where(np.isfinite(objective), objective, -np.inf)
    largest = np.argmax(finite, axis=1)
    index = np.clip(largest, 1, place.shape[1] - 2)
    rows = np.arange(len(objective))
    with np.errstate(invalid="ignore", divide="ignore"):
        left, middle, right = (objective[rows, index + step] for step in (-1, 0, 1))
        way = np.clip(0.5 * (left - right) / (left - 2.0 * middle + right), -1.0, 1.0)
    way = np.where(np.isfinite(way), way, 0.0)
    # at an end of the row the three may bend upwards, and their parabola has a least value
    way = np.where(largest == index, way, np.sign(largest - index))
    step = np.where(way < 0.0, -1, 1)
    found = place[rows, index] + np.abs(way) * (place[rows, index + step] - place[rows, index])
    return np.where(np.isfinite(finite).any(axis=1), found, np.nan)


def least_light(place: np.ndarray, needed: np.ndarray) -> np.ndarray:
    """Find where each row needs the least light, the first place in the dark where there is one."""
    dark = needed == 0.0
    with np.errstate(divide="ignore"):
        found = optimum(place, -np.where(dark, np.nan, np.log(needed)))
    rows, first = np.arange(len(needed)), np.argmax(dark, axis=1)
    return np.where(dark[rows, first], place[rows, first], found)
