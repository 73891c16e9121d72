"""Outputs of one flyer at any coordinates, and the edges of its bands and optima among them."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from lightflyer.array.records import ShortRepr
from lightflyer.design.setup import Setup
from lightflyer.design.tables import predicted_names, table_of
from lightflyer.statics.grid_refinement import (
    EDGE_TOLERANCE,
    FLAT,
    at,
    band_brackets,
    band_count,
    best_of,
    crossing,
    first_largest,
    peak,
    rows_around,
    with_point,
)

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


_LIFT, _LIGHT = _SEARCHED = "lift_over_weight", "levitation_irradiance"
_HEAT = "temperature"

Names: TypeAlias = tuple[str, ...] | None
"""Outputs that are asked for; None for all that are reported."""

Tabulate: TypeAlias = Callable[[np.ndarray, Names], Table]
"""Takes places of shape (n, k, m), gives outputs of that shape: of m flyers at k places each.

NaN where a place is NaN, which costs nothing.
"""


class Found(NamedTuple):
    """Where m flyers have their edges and optima; places are NaN where there is none."""

    edges: np.ndarray  # Lower and upper edge of each band, shape (2, bands, m)
    best: np.ndarray  # Place of the largest payload, shape (m,)
    easiest: np.ndarray  # Place of the least light, shape (m,)
    at_best: Table  # Outputs there, shape (m,)
    at_easiest: Table


class Usable(NamedTuple):
    """Where m flyers levitate and their films survive; places are NaN where there is none."""

    edges: np.ndarray  # Lower and upper edge of each part of the bands, shape (2, parts, m)
    best: np.ndarray  # Place of the largest payload in them, shape (m,)
    at_best: Table  # Outputs there, shape (m,)


def find_edges_and_optima(
    tabulate: Tabulate,
    place: np.ndarray,
    table: Table,
    *,
    lit: np.ndarray | None = None,
    widest: bool = False,
    tolerance: float = EDGE_TOLERANCE,
    flat: float = FLAT,
) -> Found:
    """Find all edges and optima between the rows of a table, shape (n, m); ``place`` (n,)."""
    # ``lit``: places of the rows of the light that it takes, where they are fewer

    def objectives(places: np.ndarray) -> np.ndarray:
        rows = (
            tabulate(places[:, [row]], (name,))[name][:, 0] for row, name in enumerate(_SEARCHED)
        )
        return np.stack([_objective(*pair) for pair in zip(_SEARCHED, rows, strict=True)], axis=1)

    around = []
    for name, rows in zip(_SEARCHED, (place, place if lit is None else lit), strict=True):
        values = _objective(name, table[name])
        best, before, after = best_of(values)
        near = np.stack([before, best, after])
        around.append((rows[near], np.take_along_axis(values, near, axis=0)))
    known = [np.stack(part, axis=1) for part in zip(*around, strict=True)]  # (3, 2, m)
    optima, heights = peak(
        objectives, known[0][0], known[0][2], flat=flat, known=tuple(known), leaves_out=True
    )
    there = {name: values[0] for name, values in tabulate(optima[None], None).items()}
    optima = np.where(heights > -np.inf, optima, np.nan)
    best, easiest = (
        {name: np.where(np.isnan(found), np.nan, values[row]) for name, values in there.items()}
        for row, found in enumerate(optima)
    )
    # the place of most payload is added so as not to miss a narrow band
    places, lifts = with_point(place, table[_LIFT], optima[0], best[_LIFT])

    def margins(places: np.ndarray) -> np.ndarray:
        return _of_spread(tabulate, places, (_LIFT,))[_LIFT] - 1.0

    edges = _edges(margins, places, lifts - 1.0, lifts >= 1.0, widest=widest, tolerance=tolerance)
    return Found(edges, optima[0], optima[1], at_best=best, at_easiest=easiest)


def find_usable(
    tabulate: Tabulate,
    place: np.ndarray,
    table: Table,
    bands: np.ndarray,
    best: tuple[np.ndarray, Table],
    highest: float,
    tolerance: float = EDGE_TOLERANCE,
    flat: float = FLAT,
) -> Usable:
    """Find the parts of bands in which films survive, and the best place in them."""
    # of all bands, shape (2, bands, m), and of the place of most payload, (m,)

    def margins(places: np.ndarray) -> np.ndarray:
        table = _of_spread(tabulate, places, (_LIFT, _HEAT))
        return np.minimum(table[_LIFT] - 1.0, coolness(table[_HEAT], highest))

    # the best place, and the edges of the bands, which levitate, are added to the table's rows
    # (inside of these the lift suffices: what is sought there is heat)
    added = np.stack([best[0], *bands.reshape(-1, best[0].size)])
    lifts = np.full(added.shape, np.inf)
    lifts[0] = best[1][_LIFT]
    known = ~np.isnan(added)
    added, lifts = np.where(known, added, place[0]), np.where(known, lifts, table[_LIFT][0])
    rows = np.broadcast_to(place[:, None], table[_LIFT].shape), table[_LIFT], table[_HEAT]
    more = added, lifts, _of_spread(tabulate, added, (_HEAT,))[_HEAT]
    columns = [np.concatenate(column) for column in zip(rows, more, strict=True)]
    order = np.argsort(columns[0], axis=0, kind="stable")
    places, lifts, heats = (np.take_along_axis(column, order, axis=0) for column in columns)
    known = np.minimum(lifts - 1.0, coolness(heats, highest))
    usable = (lifts >= 1.0) & (coolness(heats, highest) >= 0.0)
    parts = _edges(margins, places, known, usable, settled=bands, tolerance=tolerance)

    def payloads(places: np.ndarray) -> np.ndarray:
        return _of_spread(tabulate, places, ("payload",))["payload"]

    within = np.any((parts[0] <= best[0]) & (best[0] <= parts[1]), axis=0)
    if within.all():
        return Usable(parts, *best)
    exists = ~np.isnan(parts[0])
    low, high = np.where(exists, parts, place[0])
    tops, heights = peak(payloads, low, high, flat=flat, leaves_out=True)
    top, some = at(tops, first_largest(np.where(exists, heights, -np.inf))), exists.any(axis=0)
    place_of_most = np.where(within, best[0], np.where(some, top, np.nan))
    values = _of_spread(tabulate, top[None], None).items()
    at_best = {
        name: np.where(within, best[1][name], np.where(some, row[0], np.nan))
        for name, row in values
    }
    return Usable(parts, place_of_most, at_best)


def _of_spread(tabulate: Tabulate, places: np.ndarray, names: Names) -> Table:
    """Outputs at places of any shape (..., m)."""
    spread = places.reshape(len(places), -1, places.shape[-1])
    return {name: row.reshape(places.shape) for name, row in tabulate(spread, names).items()}


def _edges(
    margins: Callable[[np.ndarray], np.ndarray],
    places: np.ndarray,
    known: np.ndarray,
    inside: np.ndarray,
    *,
    widest: bool = False,
    settled: Any = ((), ()),
    tolerance: float,
) -> np.ndarray:
    """Edges of the bands inside of which a margin is positive, shape (2, bands, m)."""
    # ``known``: margins at the places of a table; lower and upper edges that are settled are such
    # edges already
    count = int(band_count(inside).max())
    brackets = [band_brackets(places, inside, 1 + number) for number in range(max(count, 1))]
    outside, within, exists, is_open = (np.stack(part, 1) for part in zip(*brackets, strict=True))
    if widest:
        width = np.where(exists[0], within[1] - within[0], -np.inf)
        chosen = np.broadcast_to(first_largest(width), (2, width.shape[1]))
        outside, within, exists, is_open = (
            at(part.swapaxes(0, 1), chosen)[:, None] for part in (outside, within, exists, is_open)
        )
    sought = exists & ~is_open & ~np.stack([*map(np.isin, within, settled)])
    ends = np.stack([outside, within])
    around = tuple(rows_around(table, places, ends) for table in (places, known))
    edges = crossing(margins, outside, within, sought, tolerance, around, leaves_out=True)
    return np.where(exists, edges, np.nan)


def widest_of(edges: np.ndarray) -> np.ndarray:
    """Edges of the widest part, shape (2, m); ``edges`` (2, parts, m)."""
    width = np.nan_to_num(edges[1] - edges[0], nan=-np.inf)
    return at(edges.swapaxes(0, 1), np.broadcast_to(first_largest(width), edges[:, 0].shape))


def coolness(temperature: np.ndarray, highest: float) -> np.ndarray:
    """How far a temperature is below a film's limit, as a share of it."""
    # NaN stands where no light lifts the flyer: on the way there it gets hotter and hotter
    return np.nan_to_num(1.0 - temperature / highest, nan=-1.0)


def _objective(name: str, values: np.ndarray) -> np.ndarray:
    """What is largest where the payload is, or where the light is least."""
    with np.errstate(divide="ignore"):
        return values if name == _LIFT else -np.log(values)
