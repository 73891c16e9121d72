"""Monte Carlo for predictions: many slightly different flyers at once, and their results."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from lightflyer.array import tree
from lightflyer.core.entry_point import entry_point
from lightflyer.design.operating_point import sinks_at_night
from lightflyer.design.tables import NIGHT_SPEED, table_of, tabulate
from lightflyer.environment.base import Coordinate
from lightflyer.prediction.evaluator import (
    Found,
    Names,
    Table,
    Tabulate,
    coolness,
    find_edges_and_optima,
    find_usable,
    widest_of,
)
from lightflyer.statics.grid_refinement import crossing, rows_around
from lightflyer.statics.sinking import night_length, night_places
from lightflyer.uncertainty.inputs import Inputs

LOWER, UPPER, MOST_PAYLOAD, LEAST_LIGHT = "lower", "upper", "payload", "levitation_irradiance"
"""What moves a result: an edge of the widest band, or the place of an optimum."""

USABLE_LOWER, USABLE_UPPER, HELD = "usable lower", "usable upper", "held"
STRONGEST = "strongest light"
"""What moves one that the film's limit decides: an edge of the widest part of the bands that the
film survives, the place of most payload in them, or the place of rest in the strongest light."""

HEAT, LEAST_HEAT, PAYLOAD = "temperature", "levitation_temperature", "payload"
NIGHT = "longest_night"

TOLERANCE = 1e-7  # Of lift over weight, and of heat over a film's limit, at edges of samples
CLOSE = {"tolerance": TOLERANCE, "flat": 1e-5}  # How closely samples are searched

_tabulate_each = entry_point(tabulate)


def tabulate_samples(
    inputs: Inputs, samples: np.ndarray, coordinate: np.ndarray, names: Sequence[str]
) -> Table:
    """Outputs of many flyers, shape (samples, n); ``coordinate`` (n,) or (samples, n)."""
    # NaN where a coordinate is NaN
    setup = inputs.setup_of(samples)
    shape = len(samples), np.shape(coordinate)[-1]
    places = np.broadcast_to(coordinate, shape)
    asked, found = ~np.isnan(places), np.full((len(names), *shape), np.nan)
    if not asked.any():
        return dict(zip(names, found, strict=True))
    if any(np.ndim(leaf) > 2 for leaf in tree.leaves(setup)):  # tables for each sample
        some = np.flatnonzero(asked.any(axis=1))
        filled = np.where(asked, places, places[asked][0])[some]
        rows = tree.map_leaves(lambda leaf: _rows_of(leaf, len(samples), some), setup)
        light = rows.environment.radiation.irradiance
        table = table_of(rows, filled, light, names, _tabulate_each)
        found[:, some] = [np.broadcast_to(table[name], filled.shape) for name in names]
        found[:, ~asked] = np.nan
    else:
        rows = tree.map_leaves(lambda leaf: _place_in_row(leaf, asked), setup)
        light = setup.environment.radiation.irradiance
        table = table_of(rows, places[asked], np.broadcast_to(light, shape)[asked], names)
        found[:, asked] = [table[name] for name in names]
    return dict(zip(names, found, strict=True))


def _rows_of(leaf: Any, samples: int, some: np.ndarray) -> Any:
    """A number or a table of each sample, shape (samples, 1, ...), for some samples."""
    return leaf[some] if np.shape(leaf)[:2] == (samples, 1) else leaf


def _place_in_row(leaf: Any, asked: np.ndarray) -> Any:
    """A number of each sample, shape (samples, 1), for each of its coordinates that are asked."""
    own = np.shape(leaf) in ((len(asked), 1), asked.shape)  # and no table of an atmosphere
    return np.broadcast_to(leaf, asked.shape)[asked] if own else leaf


def _strongest_light(
    look: Tabulate, places: np.ndarray, rows: Table, found: Found, highest: float
) -> tuple[np.ndarray, Table]:
    """Place of rest in the strongest light in which each sample's film survives, and that light."""

    # zero where the film is too hot already in the least light, NaN where no light is too strong
    def cool(there: np.ndarray) -> np.ndarray:
        return 1.0 - look(there[:, None], (LEAST_HEAT,))[LEAST_HEAT][:, 0] / highest

    known, never = ~np.isnan(rows[LEAST_LIGHT]), coolness(found.at_easiest[LEAST_HEAT], highest) < 0
    hot = (coolness(rows[LEAST_HEAT], highest) < 0.0) & known & (places[:, None] > found.easiest)
    first, wanted = hot.argmax(axis=0), hot.any(axis=0) & ~never
    before = np.maximum(first - 1, 0)
    easiest_is_inside = found.easiest > places[before]
    columns = np.broadcast_to(places[:, None], hot.shape)
    margins, ends = 1.0 - rows[LEAST_HEAT] / highest, places[np.stack([first, before])]
    around = tuple(rows_around(table, columns, ends) for table in (columns, margins))
    inside = found.easiest, 1.0 - found.at_easiest[LEAST_HEAT] / highest
    for table, one in zip(around, inside, strict=True):
        table[2:] = np.where(easiest_is_inside, [one, table[2]], table[2:])
    far, near = np.where(wanted, around[0][1:3], places[0])
    place = crossing(cool, far, near, wanted, TOLERANCE, around, leaves_out=True)
    light = look(place[None, None], (LEAST_LIGHT,))[LEAST_LIGHT][0, 0]
    return place, {LEAST_LIGHT: np.where(wanted, light, np.where(never, 0.0, np.nan))}


def _nights(
    inputs: Inputs, samples: np.ndarray, edges: np.ndarray, where: Coordinate
) -> np.ndarray:
    """Time in which each sample sinks from edge to edge in the dark, shape (samples,) [s]."""
    # NaN where it has none; ``edges`` (2, samples)
    if not sinks_at_night(inputs.design.setup):
        return np.full(len(samples), np.nan)
    lower, upper = where.from_axis(edges)
    known = ~np.isnan(lower)
    places = night_places(np.where(known, upper, 1.0), np.where(known, lower, 0.0))
    speed = tabulate_samples(inputs, samples, places, (NIGHT_SPEED,))[NIGHT_SPEED]
    return night_length(upper, lower, speed)


def search_samples(
    inputs: Inputs, samples: np.ndarray, tables: Sequence[tuple[np.ndarray, Table]]
) -> dict[str, tuple[np.ndarray, Table]]:
    """Edges and optima of each sample, of which tables have the rows to begin with."""
    # Coordinate and outputs of each sample, shape (samples,), by what moves a result there. Each
    # table has coordinates (n,), increasing, and outputs (samples, n): the first those in the
    # available light, the second those in the least.
    where = inputs.design.setup.environment.coordinate
    places, lit = (where.to_axis(coordinate) for coordinate, _ in tables)
    rows = {name: values.T for _, table in tables for name, values in table.items()}

    def look(places: np.ndarray, names: Names) -> Table:
        each = where.from_axis(np.moveaxis(places, -1, 0).reshape(len(samples), -1))
        found = tabulate_samples(inputs, samples, each, names or tuple(rows))
        return {name: values.T.reshape(places.shape) for name, values in found.items()}

    found = find_edges_and_optima(look, places, rows, lit=lit, widest=True, **CLOSE)
    edges = found.edges[:, 0]
    there = np.where(np.isnan(edges), places[0], edges)
    hot = look(there[:, None], (HEAT,))[HEAT][:, 0]
    at_edges = [{HEAT: row} for row in np.where(np.isnan(edges), np.nan, hot)]
    known = {
        LOWER: (edges[0], at_edges[0]),
        UPPER: (edges[1], at_edges[1] | {NIGHT: _nights(inputs, samples, edges, where)}),
        MOST_PAYLOAD: (found.best, found.at_best),
        LEAST_LIGHT: (found.easiest, found.at_easiest),
    }
    highest = inputs.design.setup.flyer.highest_temperature
    if highest is not None:
        best = found.best, found.at_best
        usable = find_usable(look, places, rows, found.edges, best, float(highest), **CLOSE)
        ends = widest_of(usable.edges)
        there = np.where(np.isnan(ends[1]), places[0], ends[1])
        least = np.where(np.isnan(ends[1]), np.nan, look(there[None, None], (PAYLOAD,))[PAYLOAD])
        known |= {USABLE_LOWER: (ends[0], {}), USABLE_UPPER: (ends[1], {PAYLOAD: least[0, 0]})}
        known[HELD] = usable.best, usable.at_best
        known[STRONGEST] = _strongest_light(look, lit, rows, found, float(highest))
    return {name: (where.from_axis(place), values) for name, (place, values) in known.items()}
