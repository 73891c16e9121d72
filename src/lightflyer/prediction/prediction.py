"""What a flyer will do, in one object: over altitude on a planet, over pressure in a chamber.

The flyer's behaviour is evaluated on tables of a fixed length, so that JAX compiles one
function once. Band edges and optima are then found by looking again, at as many points, between
the neighbours of what the last look found: three looks narrow a step of the table a
million-fold. :func:`lightflyer.altitude_band` finds the same edges for many flyers at once, and
differentiably, but takes longer to compile than a whole prediction takes.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import equinox as eqx
import jax.numpy as jnp
import numpy as np

from lightflyer.config.sections import Setup
from lightflyer.environment.base import AbstractEnvironment
from lightflyer.environment.chamber import Chamber
from lightflyer.flight.balance import equilibrium, require_converged
from lightflyer.flight.bands import HIGHEST_SEARCHED
from lightflyer.flight.levitation import levitate, weight
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.force.base import AbstractForceModel
from lightflyer.foundation.checks import require_positive, require_range
from lightflyer.foundation.precision import quick_entry_point
from lightflyer.foundation.types import Numeric

POINTS = 301
"""Length of the tables."""

DEFAULT_ALTITUDES = tuple(np.arange(50e3, 101e3, 5e3))
"""Altitudes reported one by one where none are asked for [m]: the mesosphere."""

DEFAULT_PRESSURES = tuple(digit * 10.0**decade for decade in range(-4, 6) for digit in (1.0, 3.0))
"""Pressures reported one by one where none are asked for, if in the chamber's range [Pa]."""

_REFINEMENTS = 3
_KILOMETRE = 1e3
_MILLIGRAMS = 1e6

Table: TypeAlias = dict[str, np.ndarray]
"""Quantities by name, each an array over the same coordinates, in SI units."""


def behaviour(
    setup: tuple[AbstractFlyer, AbstractEnvironment, AbstractForceModel],
    coordinate: Numeric,
    irradiance: Numeric,
) -> dict[str, Any]:
    """Everything a prediction tabulates, at each coordinate under its irradiance.

    Parameters
    ----------
    setup : tuple of flyer, environment and force model
    coordinate : array, shape (...)
        Altitude [m] or pressure [Pa].
    irradiance : array, shape (...)
        [W/m²].

    Returns
    -------
    dict of str to array, broadcast shape
        SI units; to be called under double precision, by way of an entry point.
    """
    flyer, environment, model = setup
    state = environment.state(coordinate)
    state = eqx.tree_at(lambda state: state.radiation.irradiance, state, irradiance)
    balance = equilibrium(flyer, state, model, throw=False)
    levitation = levitate(flyer, state, model, throw=False)
    lift = model.force(flyer, state, balance.excess)
    load = weight(flyer, state)
    payload = lift / state.gravity - flyer.own_mass
    quantities = {
        "pressure": state.pressure,
        "gas_temperature": state.temperature,
        "levitation_irradiance": levitation.irradiance,
        "levitation_temperature": levitation.temperature,
        "temperature": balance.temperature,
        "lift": lift,
        "lift_over_weight": lift / load,
        "payload": payload,
        "relative_payload": payload / flyer.own_mass,
        "converged": balance.converged & levitation.converged,
        "residual": jnp.abs(balance.residual) + jnp.abs(levitation.residual),
    }
    return {name: value + jnp.zeros_like(coordinate) for name, value in quantities.items()}


_behaviour = quick_entry_point(behaviour)


class _Evaluator:
    """Evaluates the behaviour at any number of coordinates with one compiled function."""

    def __init__(self, setup: Setup):
        self.setup = (setup.flyer, setup.environment, setup.model)
        self.irradiance = float(setup.environment.radiation.irradiance)

    def __call__(self, coordinates: np.ndarray, irradiance: np.ndarray | None = None) -> Table:
        """Table over ``coordinates``, shape (n,), under ``irradiance`` or the environment's."""
        light = np.full(coordinates.shape, self.irradiance) if irradiance is None else irradiance
        missing = -coordinates.size % POINTS
        padded = np.pad(coordinates, (0, missing), mode="edge").reshape(-1, POINTS)
        lights = np.pad(light, (0, missing), mode="edge").reshape(-1, POINTS)
        parts = [_behaviour(self.setup, *rows) for rows in zip(padded, lights, strict=True)]
        table = {
            name: np.concatenate([part[name] for part in parts])[: coordinates.size]
            for name in parts[0]
        }
        require_converged("prediction", table.pop("converged") > 0.5, table.pop("residual"))
        return table

    def edge(self, outside: float, inside: float) -> float:
        """Coordinate between two at which lift equals weight."""
        for _ in range(_REFINEMENTS):
            points = np.linspace(outside, inside, POINTS)
            first = int(np.argmax(self(points)["lift_over_weight"] >= 1.0))
            outside, inside = points[max(first - 1, 0)], points[first]
        return 0.5 * (outside + inside)

    def optimum(self, coordinates: np.ndarray, name: str, sign: float) -> tuple[float, Table]:
        """Coordinate of the largest ``sign * quantity``, and the behaviour there."""
        best = int(np.nanargmax(sign * self(coordinates)[name]))
        for _ in range(_REFINEMENTS):
            low, high = coordinates[max(best - 1, 0)], coordinates[min(best + 1, POINTS - 1)]
            coordinates = np.linspace(low, high, POINTS)
            best = int(np.nanargmax(sign * self(coordinates)[name]))
        point = coordinates[best]
        return float(point), self(np.array([point]))


def _number(value: Any) -> float | None:
    """For JSON, which has neither infinity nor NaN."""
    return float(value) if np.isfinite(value) else None


@dataclass(frozen=True)
class AltitudePrediction:
    """What a flyer does over a planet.

    Attributes
    ----------
    altitude : array, shape (n,)
        Searched altitudes [m].
    table : dict of str to array, shape (n,)
        Behaviour there, in SI units.
    bands : list of (float, float)
        Altitude bands in which the flyer levitates with its payload [m], lowest first.
    at_altitude : array, shape (m,)
        Altitudes asked for [m].
    at_table : dict of str to array, shape (m,)
        Behaviour there.
    easiest : (float, dict) or None
        Altitude [m] of the smallest irradiance that levitates the flyer, and the behaviour
        there; None where no irradiance does anywhere.
    best : (float, dict)
        Altitude [m] of the largest payload, and the behaviour there.
    """

    altitude: np.ndarray
    table: Table
    bands: list[tuple[float, float]]
    at_altitude: np.ndarray
    at_table: Table
    easiest: tuple[float, Table] | None
    best: tuple[float, Table]
    band_pressures: list[tuple[float, float]]

    @property
    def widest(self) -> int | None:
        """Index of the widest band."""
        if not self.bands:
            return None
        return int(np.argmax([upper - lower for lower, upper in self.bands]))

    def summary(self) -> dict[str, Any]:
        """The prediction as a JSON object, with a unit at the end of each name."""
        widest = self.widest
        bands = [[lower / _KILOMETRE, upper / _KILOMETRE] for lower, upper in self.bands]
        return {
            "altitude_band_km": None if widest is None else bands[widest],
            "altitude_bands_km": bands,
            "pressure_band_pa": None if widest is None else list(self.band_pressures[widest]),
            "minimum_irradiance": self._easiest_summary(),
            "best": self._best_summary(),
            "at": [self._at_summary(index) for index in range(self.at_altitude.size)],
        }

    def _easiest_summary(self) -> dict[str, Any] | None:
        if self.easiest is None:
            return None
        altitude, there = self.easiest
        return {
            "value_w_m2": _number(there["levitation_irradiance"][0]),
            "altitude_km": altitude / _KILOMETRE,
            "temperature_k": _number(there["levitation_temperature"][0]),
        }

    def _best_summary(self) -> dict[str, Any]:
        altitude, there = self.best
        return {
            "altitude_km": altitude / _KILOMETRE,
            "payload_mg": _number(there["payload"][0] * _MILLIGRAMS),
            "relative_payload": _number(there["relative_payload"][0]),
            "temperature_k": _number(there["temperature"][0]),
            "lift_over_weight": _number(there["lift_over_weight"][0]),
        }

    def _at_summary(self, index: int) -> dict[str, Any]:
        return {
            "altitude_km": float(self.at_altitude[index]) / _KILOMETRE,
            **_point_summary(self.at_table, index, with_gas=True),
        }


@dataclass(frozen=True)
class ChamberPrediction:
    """What a flyer does in a vacuum chamber.

    Attributes
    ----------
    pressure : array, shape (n,)
        Pressures over the chamber's range [Pa].
    table : dict of str to array, shape (n,)
        Behaviour there under the lamp's irradiance, in SI units.
    at_pressure, at_table
        The same at the pressures asked for.
    optimum : (float, dict) or None
        Pressure [Pa] of the smallest irradiance that levitates the flyer, and the behaviour
        there; None where no irradiance does in the range.
    map_pressure, map_irradiance : array, shape (i,), (j,)
        Axes of the temperature map [Pa], [W/m²].
    map_temperature : array, shape (i, j)
        Temperature of the flyer [K].
    """

    pressure: np.ndarray
    table: Table
    at_pressure: np.ndarray
    at_table: Table
    optimum: tuple[float, Table] | None
    map_pressure: np.ndarray
    map_irradiance: np.ndarray
    map_temperature: np.ndarray

    def summary(self) -> dict[str, Any]:
        """The prediction as a JSON object, with a unit at the end of each name."""
        optimum = None
        if self.optimum is not None:
            pressure, there = self.optimum
            optimum = {
                "pressure_pa": pressure,
                "irradiance_w_m2": _number(there["levitation_irradiance"][0]),
                "temperature_k": _number(there["levitation_temperature"][0]),
            }
        return {
            "optimum": optimum,
            "at": [
                _point_summary(self.at_table, index, with_gas=False)
                for index in range(self.at_pressure.size)
            ],
        }


def _point_summary(table: Table, index: int, *, with_gas: bool) -> dict[str, Any]:
    names = {
        "pressure_pa": "pressure",
        "gas_temperature_k": "gas_temperature",
        "levitation_irradiance_w_m2": "levitation_irradiance",
        "levitation_temperature_k": "levitation_temperature",
        "temperature_k": "temperature",
        "lift_n": "lift",
        "lift_over_weight": "lift_over_weight",
    }
    if not with_gas:
        names.pop("gas_temperature_k")
    return {key: _number(table[name][index]) for key, name in names.items()}


def predict(
    setup: Setup, at: Sequence[float] | None = None
) -> AltitudePrediction | ChamberPrediction:
    """Predict what a flyer does in its environment.

    Parameters
    ----------
    setup : Setup
        From :meth:`FlyerFile.build`, or made of your own objects. One flyer: every number a
        scalar.
    at : sequence of float, optional
        Altitudes [m] or, in a chamber, pressures [Pa] to report one by one.

    Returns
    -------
    AltitudePrediction or ChamberPrediction

    Raises
    ------
    ParameterError
        If an altitude or pressure is outside the environment's range.
    ConvergenceError
        If a heat balance has not converged.
    """
    if isinstance(setup.environment, Chamber):
        return _predict_chamber(setup, at)
    return _predict_altitude(setup, at)


def _searched(setup: Setup, limit: float = np.inf) -> tuple[float, float]:
    lowest, highest = (float(end) for end in setup.environment.coordinate_range)
    low, high = setup.coordinate_range
    low, high = lowest if low is None else low, min(highest, limit) if high is None else high
    require_range("searched altitude or pressure", np.array([low, high]), lowest, highest)
    return low, high


def _predict_altitude(setup: Setup, at: Sequence[float] | None) -> AltitudePrediction:
    evaluate = _Evaluator(setup)
    low, high = _searched(setup, HIGHEST_SEARCHED)
    altitude = np.linspace(low, high, POINTS)
    if at is None:
        asked = np.array([point for point in DEFAULT_ALTITUDES if low <= point <= high])
    else:
        asked = np.asarray(at, float)
        require_range("altitude [m]", asked, *setup.environment.coordinate_range)
    table = evaluate(altitude)
    best = evaluate.optimum(altitude, "payload", +1.0)
    bands = _bands(evaluate, altitude, table, best)
    edges = np.array(bands).reshape(-1, 2)
    edge_pressures = evaluate(edges.ravel())["pressure"].reshape(-1, 2) if bands else edges
    levitates = np.isfinite(table["levitation_irradiance"])
    return AltitudePrediction(
        altitude=altitude,
        table=table,
        bands=bands,
        at_altitude=asked,
        at_table=evaluate(asked) if asked.size else dict.fromkeys(table, asked),
        easiest=(
            evaluate.optimum(altitude, "levitation_irradiance", -1.0) if levitates.any() else None
        ),
        best=best,
        band_pressures=[(float(lower), float(upper)) for lower, upper in edge_pressures],
    )


def _bands(
    evaluate: _Evaluator, altitude: np.ndarray, table: Table, best: tuple[float, Table]
) -> list[tuple[float, float]]:
    """Altitude bands [m]; the point of most payload is added so as not to miss a narrow one."""
    position = int(np.searchsorted(altitude, best[0]))
    points = np.insert(altitude, position, best[0])
    margins = np.insert(table["lift_over_weight"], position, best[1]["lift_over_weight"])
    flies = np.concatenate([[False], margins >= 1.0, [False]])
    starts = np.flatnonzero(flies[1:-1] & ~flies[:-2])
    ends = np.flatnonzero(flies[1:-1] & ~flies[2:])
    last = points.size - 1
    return [
        (
            evaluate.edge(points[start - 1], points[start]) if start else float(points[0]),
            evaluate.edge(points[end + 1], points[end]) if end < last else float(points[last]),
        )
        for start, end in zip(starts, ends, strict=True)
    ]


def _predict_chamber(setup: Setup, at: Sequence[float] | None) -> ChamberPrediction:
    evaluate = _Evaluator(setup)
    low, high = _searched(setup)
    pressure = np.geomspace(low, high, POINTS)
    if at is None:
        asked = np.array([point for point in DEFAULT_PRESSURES if low <= point <= high])
    else:
        asked = np.asarray(at, float)
        require_positive(pressure=asked)
    table = evaluate(pressure)
    needed = table["levitation_irradiance"]
    optimum = None
    if np.isfinite(needed).any():
        optimum = evaluate.optimum(pressure, "levitation_irradiance", -1.0)
    lamp = evaluate.irradiance
    least = optimum[1]["levitation_irradiance"][0] if optimum else lamp
    map_pressure = np.geomspace(low, high, 91)
    map_irradiance = np.linspace(0.0, 2.0 * max(lamp, least), 61)
    grid = np.meshgrid(map_pressure, map_irradiance, indexing="ij")
    temperature = evaluate(grid[0].ravel(), grid[1].ravel())["temperature"]
    return ChamberPrediction(
        pressure=pressure,
        table=table,
        at_pressure=asked,
        at_table=evaluate(asked) if asked.size else dict.fromkeys(table, asked),
        optimum=optimum,
        map_pressure=map_pressure,
        map_irradiance=map_irradiance,
        map_temperature=temperature.reshape(grid[0].shape),
    )
