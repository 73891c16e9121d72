"""The results of a prediction, one by one: where each is, and what moves it.

Monte Carlo predicts many slightly different flyers at once. First order takes derivatives in the
inputs by differences of converged solutions. Each is the mean of the slopes on both sides, which at
a kink are two. An input at the end of its range has the slope of the side that is possible.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from lightflyer.array import tree
from lightflyer.array.namespace import by_numpy
from lightflyer.core.entry_point import entry_point
from lightflyer.design.operating_point import sinks_at_night
from lightflyer.design.outputs import outputs_of
from lightflyer.design.tables import NIGHT_SPEED, predicted_names, table_of, tabulate
from lightflyer.prediction.evaluator import (
    Found,
    Names,
    Place,
    Table,
    Tabulate,
    coolness,
    find_edges_and_optima,
    find_usable,
    widest_of,
)
from lightflyer.prediction.prediction import Prediction
from lightflyer.statics.grid_refinement import crossing, rows_around
from lightflyer.statics.sinking import night_change, night_length, night_places
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

_SHARE = 3e-5  # of a standard uncertainty, over which outputs are compared
_SHARE_OF_SLOPES = 2e-4  # the same where slopes are compared thereafter, which rounding blurs more
_COORDINATE_SHARE = 1e-5  # of the coordinate, over which they are
_FAR = 5e-4  # of the coordinate, over which slopes are compared for second derivatives

EDGES = LOWER, UPPER  # Names of the edges of a band

_LIFT = "lift_over_weight"
_LEVELS = _LIFT, HEAT, LEAST_HEAT  # outputs that keep their value at an edge, whatever else changes


def tabulate_samples(
    inputs: Inputs,
    samples: np.ndarray,
    coordinate: np.ndarray,
    names: Sequence[str],
    **options: Any,
) -> Table:
    """Outputs of many flyers, shape (samples, n); ``coordinate`` (n,) or (samples, n)."""
    # NaN where a coordinate is NaN; options are those of table_of
    setup = inputs.setup_of(samples)
    shape = len(samples), np.shape(coordinate)[-1]
    places = np.broadcast_to(coordinate, shape)
    asked, found = ~np.isnan(places), np.full((len(names), *shape), np.nan)
    if not asked.any():
        return dict(zip(names, found, strict=True))
    if any(np.ndim(leaf) > 2 for leaf in tree.leaves(setup)):  # tables for each sample
        some = np.flatnonzero(asked.any(axis=1))
        filled = np.where(asked, places, places[asked][0])[some]
        each = len(samples), 1  # shape of what every sample has for itself, a number or a table
        rows = tree.map_leaves(lambda one: one[some] if np.shape(one)[:2] == each else one, setup)
        light = rows.environment.radiation.irradiance
        table = table_of(rows, filled, light, names, _tabulate_each, **options)
        found[:, some] = [np.broadcast_to(table[name], filled.shape) for name in names]
        found[:, ~asked] = np.nan
    else:
        # a number of each sample, (samples, 1), for each of its coordinates that are asked
        def in_row(leaf: Any) -> Any:
            own = np.shape(leaf) in ((len(asked), 1), asked.shape)  # and no table of an atmosphere
            return np.broadcast_to(leaf, asked.shape)[asked] if own else leaf

        rows = tree.map_leaves(in_row, setup)
        light = setup.environment.radiation.irradiance
        table = table_of(
            rows, places[asked], np.broadcast_to(light, shape)[asked], names, **options
        )
        found[:, asked] = [table[name] for name in names]
    return dict(zip(names, found, strict=True))


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
        # a search goes to where no light lifts some samples any more; tables have told the others
        found = tabulate_samples(inputs, samples, each, names or tuple(rows), most=1.0)
        return {name: values.T.reshape(places.shape) for name, values in found.items()}

    found = find_edges_and_optima(look, places, rows, lit=lit, widest=True, **CLOSE)
    edges = found.edges[:, 0]
    there = np.where(np.isnan(edges), places[0], edges)
    hot = look(there[:, None], (HEAT,))[HEAT][:, 0]
    at_edges = [{HEAT: row} for row in np.where(np.isnan(edges), np.nan, hot)]
    night = np.full(len(samples), np.nan)  # in which each sinks from edge to edge [s]
    if sinks_at_night(inputs.design.setup):
        lower, upper = where.from_axis(edges)
        exists = ~np.isnan(lower)
        down = night_places(np.where(exists, upper, 1.0), np.where(exists, lower, 0.0))
        speed = tabulate_samples(inputs, samples, down, (NIGHT_SPEED,))[NIGHT_SPEED]
        night = night_length(upper, lower, speed)
    known = {
        LOWER: (edges[0], at_edges[0]),
        UPPER: (edges[1], at_edges[1] | {NIGHT: night}),
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
            step = _FAR * self.coordinate
            both = np.concatenate([self.coordinate - step, self.coordinate + step])
            slopes = _directions(self.inputs, both, (objective,), _SHARE_OF_SLOPES)[1]
            (rows,) = np.moveaxis(slopes, 1, 0)
            below, above = np.split(rows, 2, axis=1)
            # derivatives of the slope over the coordinate, shape (k + 1, n); at sea level none
            changes = (above - below) / np.where(step > 0.0, 2.0 * step, np.nan)
            self._slope_changes[objective] = changes
        return _moved(self._slope_changes[objective][:, point])

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
        rows = np.where(np.isfinite(rows), rows, np.nan)  # where no light lifts it, it is endless
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


@dataclass(frozen=True)
class Target:
    """One result: which output, in which unit, at which coordinate, and what moves that."""

    # ``mover`` is empty at a fixed coordinate, else one of those of the Monte Carlo search; there
    # ``keeps`` names the output that keeps its value, or the objective of an optimum. Without a
    # quantity the coordinate itself is the result. ``at_end``: the optimum is an end of the
    # searched range, which does not move to first order.

    name: str
    nominal: float
    quantity: str
    scale: float
    point: int
    coordinate: float
    mover: str = ""
    keeps: str = ""
    at_end: bool = False

    @property
    def is_edge(self) -> bool:
        """Whether it is at an edge, where an output keeps its value."""
        return self.keeps in _LEVELS


class _Targets:
    """Collects the results of a prediction, and the coordinates at which they are."""

    def __init__(self, prediction: Prediction):
        self.prediction = prediction
        self.known = outputs_of(prediction.setup)
        self.ends = (prediction.coordinates[0], prediction.coordinates[-1])
        self.points: list[float] = []
        self.moved = "", ""
        self.targets: list[Target] = []

    def at(self, coordinate: float, mover: str = "", keeps: str = "") -> None:
        """Let what is added next be at a coordinate, and say what moves that."""
        self.points.append(coordinate)
        self.moved = mover, keeps

    def add(self, name: str, value: float, output: str, scale: float) -> None:
        """A result at the last coordinate; one that is not finite is left out."""
        if np.isfinite(value):
            point, at = len(self.points) - 1, self.points[-1]
            self.targets.append(
                Target(name, scale * value, output, scale, point, at, *self.moved, at in self.ends)
            )

    def add_coordinate(self, name: str) -> None:
        """The last coordinate itself."""
        self.add(name, self.points[-1], "", self.prediction.coordinate_key[1])

    def add_outputs(self, group: str, place: Place, names: tuple[str, ...]) -> None:
        """Some outputs at the last coordinate."""
        for output in names:
            key, scale = self.known[output].json
            self.add(f"{group}.{key}", place.values[output], output, scale)


def find_targets(prediction: Prediction) -> tuple[list[Target], np.ndarray]:
    """The results of a prediction, and the coordinates at which they are."""
    found = _Targets(prediction)
    key, _ = prediction.coordinate_key
    name = prediction.coordinate.name
    unit = key.removeprefix(name)
    widest = prediction.widest
    if widest is not None:
        for edge, coordinate in zip(EDGES, prediction.bands[widest], strict=True):
            if coordinate not in found.ends:  # else it is not the flyer's own edge
                found.at(coordinate, edge, _LIFT)
                found.add_coordinate(f"{name}_band{unit}.{edge}")
    _add_verdict(found, f"verdict.usable_band{unit}", key)
    if prediction.easiest is not None:
        group, light = prediction.coordinate.easiest_keys
        values = prediction.easiest.values
        found.at(prediction.easiest.coordinate, LEAST_LIGHT, LEAST_LIGHT)
        found.add_coordinate(f"{group}.{key}")
        found.add(f"{group}.{light}", values[LEAST_LIGHT], LEAST_LIGHT, 1.0)
        hot = "levitation_temperature"
        found.add(f"{group}.temperature_k", values[hot], hot, 1.0)
    found.at(prediction.best.coordinate, MOST_PAYLOAD, MOST_PAYLOAD)
    found.add_coordinate(f"best.{key}")
    found.add_outputs("best", prediction.best, prediction.best_names)
    given = ("pressure", "gas_temperature")
    names = tuple(name for name in prediction.point_names if name not in given)
    for number in range(prediction.asked.size):
        found.at(float(prediction.asked[number]))
        found.add_outputs(f"at[{number}]", prediction.place(number), names)
    return found.targets, np.array(found.points)


def _add_verdict(found: _Targets, band: str, key: str) -> None:
    """Add where the released flyer rests, where its film survives, and what it carries there."""
    verdict, bands = found.prediction.verdict, found.prediction.bands
    if verdict.rest is not None:
        found.at(verdict.rest.coordinate, UPPER, _LIFT)
        found.add_outputs("verdict.rest", verdict.rest, (HEAT,))
        if verdict.longest_night is not None:
            name, scale = found.known[NIGHT].json
            found.add(f"verdict.{name}", verdict.longest_night, NIGHT, scale)
    if verdict.strongest_rest is not None and verdict.strongest_light is not None:
        found.at(verdict.strongest_rest, STRONGEST, LEAST_HEAT)
        found.add("verdict.strongest_light_w_m2", verdict.strongest_light, LEAST_LIGHT, 1.0)
    if verdict.best is None or verdict.highest_temperature is None:
        return
    lifted = {edge for ends in bands for edge in ends}
    part = max(verdict.usable, key=lambda ends: ends[1] - ends[0])
    keeps = [_LIFT if edge in lifted else HEAT for edge in part]
    if verdict.ballast is not None:
        found.at(part[1], USABLE_UPPER, keeps[1])
        found.add("verdict.ballast_mg", verdict.ballast[0], PAYLOAD, 1e6)
    movers = USABLE_LOWER, USABLE_UPPER
    for edge, mover, coordinate, kept in zip(EDGES, movers, part, keeps, strict=True):
        if coordinate not in found.ends:
            found.at(coordinate, mover, kept)
            found.add_coordinate(f"{band}.{edge}")
    best = verdict.best
    found.at(best.coordinate, HELD, MOST_PAYLOAD if best is found.prediction.best else HEAT)
    found.add_coordinate(f"verdict.best.{key}")
    found.add_outputs("verdict.best", best, ("payload", HEAT))


def spread_of(target: Target, slopes: Derivatives) -> float:
    """Standard uncertainty of a result to first order."""
    point = target.point
    if target.quantity == NIGHT:
        edges = point, 0  # the lower one comes first
        return target.scale * slopes.spread(slopes.night(target.keeps, edges))
    if target.is_edge:
        moving = slopes.level(target.keeps, point)
    elif target.keeps and not target.at_end:
        moving = slopes.optimum(target.keeps, point)
    else:
        moving = np.zeros(len(slopes.covariance))
    if target.quantity:
        moving = slopes.moving(target.quantity, point, moving)
    return target.scale * slopes.spread(moving)


def sample_result(
    target: Target,
    found: dict[str, tuple[np.ndarray, Table]],
    tables: Sequence[tuple[np.ndarray, Table]],
) -> np.ndarray:
    """One result in each sample, shape (samples,)."""
    if not target.mover:
        ((coordinate, table),) = (one for one in tables if target.quantity in one[1])
        column = np.searchsorted(coordinate, target.coordinate)
        return target.scale * table[target.quantity][:, column]
    coordinate, outputs = found[target.mover]
    return target.scale * (outputs[target.quantity] if target.quantity else coordinate)
