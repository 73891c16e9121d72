"""Prediction of one flyer: where it levitates, what it carries, how hot it gets.

Band edges and optima are found by looking closer with the function that makes the tables.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from lightflyer.array.records import ShortRepr
from lightflyer.core.units import scale_and_offset
from lightflyer.design.design import AbstractDesign
from lightflyer.design.diagnostics import (
    TOO_HOT,
    diagnose_at,
    diagnose_force,
    shape_failures,
)
from lightflyer.design.outputs import (
    budget_outputs,
    json_name,
    model_outputs,
    node_outputs,
    outputs_of,
    shape_outputs,
)
from lightflyer.design.setup import Setup
from lightflyer.design.tables import predicted_names
from lightflyer.environment.base import Coordinate
from lightflyer.files.result_text import (
    NARROW,
    Parts,
    PrintedResult,
    warning_lines,
    wrap,
)
from lightflyer.prediction.evaluator import (
    POINTS,
    Evaluator,
    Place,
    Rows,
    Table,
    find_edges_and_optima,
)
from lightflyer.prediction.verdict import Verdict, verdict_of

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

AT_A_POINT = (
    "pressure",
    "gas_temperature",
    "levitation_irradiance",
    "levitation_temperature",
    "temperature",
    "lift",
    "lift_over_weight",
    "buoyancy",
    "climb_speed",
)
"""Outputs reported at each coordinate asked for, besides those of the flyer's nodes, of the force
model and of a payload's budget."""

AT_THE_BEST = (
    "payload",
    "relative_payload",
    "payload_per_area",
    "temperature",
    "lift_over_weight",
)
"""Outputs reported at the coordinate of the largest payload, besides those of the force model and
of a payload's budget."""

_ROWS = 8  # most coordinates that are reported where none is asked for
_AROUND = 0.1  # of the bands, by which they reach beyond them
_LEAST_AROUND = 0.01  # of the searched range
_MAP_POINTS = (91, 61)  # pressures and irradiances of the temperature map
_MAP_TOP = 2.0  # its largest irradiance, over the lamp's or the least that levitates


@dataclass(frozen=True)
class TemperatureMap(ShortRepr):
    """Temperature of the flyer over pressure and irradiance, where the light can be dimmed.

    Attributes
    ----------
    coordinate : array, shape (i,)
        [Pa].
    irradiance : array, shape (j,)
        [W/m²].
    temperature : array, shape (i, j)
        Of the hottest node [K].
    """

    coordinate: np.ndarray
    irradiance: np.ndarray
    temperature: np.ndarray


@dataclass(frozen=True, repr=False)
class Prediction(PrintedResult):
    """Bands, tables and peaks of a flyer in its environment."""

    setup: Setup
    coordinates: np.ndarray  #: shape (n,); coordinates searched: altitudes [m] or pressures [Pa]
    #: shape (n,); outputs there, in SI units; an irradiance that no light gives is infinite
    table: Table
    #: Ranges of the coordinate in which the flyer levitates with its payload, lowest first
    bands: list[tuple[float, float]]
    band_pressures: list[tuple[float, float]]  #: Pressure at both edges of each band [Pa]
    asked: np.ndarray  #: shape (m,); coordinates asked for
    at: Table  #: shape (m,); outputs there
    #: Where the flyer needs the least light; None where no light lifts it anywhere
    easiest: Place | None
    best: Place  #: Where it carries the largest payload
    map: TemperatureMap | None  #: Where the light can be dimmed
    #: What a reader must know, one line each: where optical data are missing, and where the force
    #: model or the film is beyond its range while the flyer flies or is reported
    warnings: tuple[str, ...]
    #: What computes its 95 % bands, when they are first asked for; None where nobody wants them
    propagate: "Callable[..., Any] | None" = None

    @cached_property
    def uncertainty(self) -> Any:
        """A :class:`~lightflyer.uncertainty.PredictionUncertainty`; None where nothing has a ±."""
        return None if self.propagate is None else self.propagate(prediction=self)

    @property
    def assumptions(self) -> tuple[str, ...]:
        """Light, heat radiation, walls and payload that are assumed, in short texts with units."""
        setup, budget = self.setup, self.setup.budget
        needs = () if budget is None else budget.describe()
        of_model = setup.model.assumptions(setup.flyer)
        return (*setup.environment.assumptions(), *of_model, *needs)

    @property
    def other_warnings(self) -> tuple[str, ...]:
        """Warnings of what the verdict does not say: it tells where a film survives."""
        stated = self.verdict.highest_temperature is not None
        return tuple(text for text in self.warnings if not (stated and text.startswith(TOO_HOT)))

    @property
    def coordinate(self) -> Coordinate:
        """The environment's coordinate."""
        return self.setup.environment.coordinate

    @property
    def available(self) -> float:
        """Irradiance available [W/m²]."""
        return float(self.setup.environment.radiation.irradiance)

    @property
    def widest(self) -> int | None:
        """Index of the widest band; None where there is none."""
        if not self.bands:
            return None
        ends = self.coordinate.to_axis(np.array(self.bands))
        return int(np.argmax(ends[:, 1] - ends[:, 0]))

    @cached_property
    def coordinate_key(self) -> tuple[str, float]:
        """Name of the coordinate in JSON, and the factor from its SI unit."""
        where = self.coordinate
        factor = scale_and_offset(where.unit, where.shown_unit)[0]
        return json_name(where.name, where.shown_unit), factor

    @property
    def point_names(self) -> tuple[str, ...]:
        """Names of the outputs reported at each coordinate asked for."""
        reported = {*AT_A_POINT, *node_outputs(self.setup.flyer), *self.own_names}
        known = (name for name in predicted_names(self.setup) if name in reported)
        return tuple(name for name in known if name != self.coordinate.name)

    @property
    def best_names(self) -> tuple[str, ...]:
        """Names of the outputs reported where the payload is largest."""
        return (*AT_THE_BEST, *self.own_names)

    @property
    def own_names(self) -> tuple[str, ...]:
        """Names of the outputs of its shape, the force model's own, its flows', the budget's."""
        setup = self.setup
        return (*shape_outputs(setup.flyer), *model_outputs(setup), *budget_outputs(setup))

    @cached_property
    def verdict(self) -> Verdict:
        """Where the flyer is usable, where it comes to rest, and what limits it."""
        return verdict_of(self)

    def text_parts(self, width: int = NARROW) -> Parts:
        from lightflyer.prediction.text import prediction_parts

        found = self.uncertainty
        if found is None:
            none = "; no bands, as no ± is stated" if self.propagate else ""
            yield from prediction_parts(self, width, sources=none)
            return
        told = found.bands, found.shares
        yield from prediction_parts(self, width, *told, sources=f"; {found.sources}")
        yield from (wrap(line, width) for line in warning_lines(found.warnings))

    def summary(self) -> dict[str, Any]:
        """The prediction as a JSON object, with a unit at the end of each name."""
        key, factor = self.coordinate_key
        unit = key.removeprefix(self.coordinate.name)
        bands = [[lower * factor, upper * factor] for lower, upper in self.bands]
        widest = self.widest
        band, pressures = None, None
        if widest is not None:
            band, pressures = bands[widest], list(self.band_pressures[widest])
        group, light = self.coordinate.easiest_keys
        easiest = None
        if self.easiest is not None:
            easiest = {
                light: _number(self.easiest.values["levitation_irradiance"]),
                key: self.easiest.coordinate * factor,
                "temperature_k": _number(self.easiest.values["levitation_temperature"]),
            }
        found = self.verdict
        release, strongest, night = found.lowest_release, found.strongest_light, found.longest_night
        nodes = ("temperature", *node_outputs(self.setup.flyer))
        places = {
            name: None if place is None else self.place_summary(place, names)
            for name, place, names in (
                ("best", found.best, self.best_names),
                ("rest", found.rest, nodes),
                ("best_covered", found.best_covered, self.best_names),
            )
        }
        described: dict[str, Any] = {
            f"{self.coordinate.name}_band{unit}": band,
            f"{self.coordinate.name}_bands{unit}": bands,
            "pressure_band_pa": pressures,
            group: easiest,
            "best": self.place_summary(self.best, self.best_names),
            "at": [
                self.place_summary(self.place(index), self.point_names)
                for index in range(self.asked.size)
            ],
            "verdict": {
                "limit": found.limit,
                "shape_failures": list(found.shape_failures),
                "highest_temperature_k": found.highest_temperature,
                f"usable_bands{unit}": [
                    [low * factor, high * factor] for low, high in found.usable
                ],
                "best": places["best"],
                f"lowest_release{unit}": None if release is None else release * factor,
                "rest": places["rest"],
                "longest_night_h": None if night is None else _number(night / 3600.0),
                "survives": found.survives,
                "strongest_light_w_m2": None if strongest is None else _number(strongest),
                "ballast_mg": found.ballast and [1e6 * end for end in found.ballast],
                "carries_afloat": found.carries_afloat,
                f"covered_bands{unit}": [
                    [low * factor, high * factor] for low, high in found.covered
                ],
                "best_covered": places["best_covered"],
            },
            "assumptions": list(self.assumptions),
            "warnings": list(self.warnings),
        }
        if self.uncertainty is not None:
            described["uncertainty"] = self.uncertainty.summary()
        return described

    def plot(self, what: str | None = None, ax: "Axes | None" = None) -> "Figure":
        """Draw irradiance, temperature, payload and, in a chamber, the map of temperatures."""
        from lightflyer.prediction.figures import plot_prediction

        if self.uncertainty is not None:
            return self.uncertainty.plot(what, ax)
        return plot_prediction(self, what, ax)

    def place(self, index: int) -> Place:
        """One of the coordinates asked for, with the outputs there."""
        values = {name: float(column[index]) for name, column in self.at.items()}
        return Place(float(self.asked[index]), values)

    def place_summary(self, place: Place, names: Sequence[str]) -> dict[str, Any]:
        """A place as a JSON object; none for a number that is not finite."""
        key, factor = self.coordinate_key
        known = outputs_of(self.setup)
        described: dict[str, Any] = {key: place.coordinate * factor}
        for name in names:
            json_key, scale = known[name].json
            described[json_key] = _number(place.values[name] * scale)
        return described

    @cached_property
    def dataset(self) -> "xr.Dataset":
        """The tables as a dataset with units; see :func:`to_dataset`."""
        from lightflyer.prediction.tables import to_dataset

        found = to_dataset(self)
        if self.uncertainty is not None:
            self.uncertainty.add_to_dataset(found)
        return found


def _number(value: float) -> float | None:
    """Number for JSON, which has neither infinity nor NaN; None stands for both."""
    return float(value) if np.isfinite(value) else None


def predict_design(
    design: AbstractDesign,
    at: Sequence[float] | None = None,
    searched: tuple[float, float] | None = None,
) -> Prediction:
    """Predict what a design does, without bands; ``at``: coordinates to report one by one."""
    setup = design.setup if searched is None else replace(design.setup, search_range=searched)
    evaluate, where = Evaluator(setup), setup.environment.coordinate
    coordinates = search_grid(setup, POINTS)
    table = evaluate(coordinates)
    rows = Rows(evaluate, coordinates, table)
    found = find_edges_and_optima(rows.tabulate, rows.places, rows.columns)
    bands, best = rows.ranges(found.edges), rows.place(found.best, found.at_best)
    easiest: Place | None = rows.place(found.easiest, found.at_easiest)
    if easiest is not None and np.isnan(easiest.coordinate):
        easiest = None
    if at is None:  # round ones on and around the bands
        around = np.ravel(bands or best.coordinate)
        ends, whole = where.to_axis(around[[0, -1]]), where.to_axis(coordinates[[0, -1]])
        more = max(_AROUND * np.ptp(ends), _LEAST_AROUND * np.ptp(whole))
        low, high = where.from_axis(np.clip(ends + np.array([-more, more]), *whole))
        asked = where.round_points(float(low), float(high), _ROWS)
    else:
        asked = np.ravel(np.asarray(where.quantity.number("at", at), float))
        where.quantity.check(f"{where.name} [{where.unit}]", asked)
    at_asked = evaluate(asked) if asked.size else dict.fromkeys(table, asked)
    edges = np.array(bands).reshape(-1, 2)
    pressures = edges
    if bands:
        pressures = evaluate(edges.ravel(), names=("pressure",))["pressure"].reshape(-1, 2)
    flying = [coordinates[(coordinates >= low) & (coordinates <= high)] for low, high in bands]
    explicit = asked[:0] if at is None else asked
    reported = np.unique(np.concatenate([*flying, edges.ravel(), explicit, [best.coordinate]]))
    temperature = evaluate(reported, names=("temperature",))["temperature"]
    solved = ~np.isnan(temperature)
    temperatures = None
    if setup.environment.dimmable_light:
        lamp, (across, up) = evaluate.irradiance, _MAP_POINTS
        least = lamp if easiest is None else easiest.values["levitation_irradiance"]
        pressure = np.geomspace(coordinates[0], coordinates[-1], across)
        irradiance = np.linspace(0.0, _MAP_TOP * max(lamp, least), up)
        grid = np.meshgrid(pressure, irradiance, indexing="ij")
        found_there = evaluate(grid[0].ravel(), grid[1].ravel(), ("temperature",))["temperature"]
        temperatures = TemperatureMap(pressure, irradiance, found_there.reshape(grid[0].shape))
    return Prediction(
        setup=setup,
        coordinates=coordinates,
        table=table,
        bands=bands,
        band_pressures=[(float(lower), float(upper)) for lower, upper in pressures],
        asked=asked,
        at=at_asked,
        easiest=easiest,
        best=best,
        map=temperatures,
        warnings=(
            *design.warnings,
            *_describe_unsolved(where, coordinates, table),
            *_describe_unsolved(where, asked, at_asked),
            *diagnose_force(setup.flyer, table),
            *shape_failures(setup, table).values(),
            *diagnose_at(setup, reported[solved], temperature[solved]),
        ),
    )


def search_grid(setup: Setup, points: int) -> np.ndarray:
    """Coordinates that are searched, evenly spaced as the coordinate wants it, shape (points,)."""
    where = setup.environment.coordinate
    low, high = (float(end) for end in setup.searched)
    where.quantity.check(f"searched {where.name} [{where.unit}]", np.array([low, high]))
    return where.evenly(low, high, points)


def _describe_unsolved(where: Coordinate, coordinates: np.ndarray, table: Table) -> Iterator[str]:
    """What is missing, where a balance has no solution within the tolerance."""
    unbalanced = np.isnan(table["lift_over_weight"])
    for what, missing in (
        ("the heat balance", unbalanced),
        ("levitation", np.isnan(table["levitation_irradiance"]) & ~unbalanced),
    ):
        if missing.any():
            factor = scale_and_offset(where.unit, where.shown_unit)[0]
            ends = (f"{end * factor:.4g}" for end in coordinates[missing][[0, -1]])
            yield (
                f"{what} missed its tolerance at {missing.sum()} of {missing.size} {where.name}s, "
                f"{' to '.join(dict.fromkeys(ends))} {where.shown_unit}: missing there"
            )
