"""The results of a prediction, one by one: where each is, and what moves it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from lightflyer.design.outputs import outputs_of
from lightflyer.prediction.evaluator import Place, Table
from lightflyer.prediction.prediction import Prediction
from lightflyer.uncertainty.derivatives import Derivatives
from lightflyer.uncertainty.monte_carlo import (
    HEAT,
    HELD,
    LEAST_HEAT,
    LEAST_LIGHT,
    LOWER,
    MOST_PAYLOAD,
    NIGHT,
    PAYLOAD,
    STRONGEST,
    UPPER,
    USABLE_LOWER,
    USABLE_UPPER,
)

EDGES = LOWER, UPPER  # Names of the edges of a band

_LIFT = "lift_over_weight"
_LEVELS = _LIFT, HEAT, LEAST_HEAT  # outputs that keep their value at an edge, whatever else changes


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
