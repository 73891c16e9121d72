"""Under which conditions the paper is recomputed, and the model at any number of points.

Everything the paper states is in ``data/lu2023.toml``; everything it does not state and a
figure needs nevertheless is there too, marked as assumed.
"""

import math
import tomllib
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import Any

import jax.numpy as jnp
import numpy as np

from lightflyer.environment.atmosphere.lu2023 import Lu2023Atmosphere
from lightflyer.environment.base import EnvironmentState
from lightflyer.environment.radiation import Radiation
from lightflyer.film.properties import FilmProperties
from lightflyer.flight.balance import equilibrium, require_converged
from lightflyer.flight.levitation import levitate, weight
from lightflyer.flyer.disk import Disk
from lightflyer.force.lu2023 import PRINTED, REPORTED, Lu2023, Reading
from lightflyer.foundation import constants
from lightflyer.foundation.precision import quick_entry_point
from lightflyer.gas.gas import LU2023_AIR

REPORTED_MEAN = Reading(
    heat_weight=REPORTED.heat_weight,
    continuum_faces=REPORTED.continuum_faces,
    force_weight=REPORTED.force_weight,
    creep_weight=1.0,
)
"""The reported reading with the mean temperature in Eq. (20), which its larger disks point to."""

POINTS = 1024
"""Points that one call of the compiled model takes."""

_KILOGRAMS_PER_GRAM = 1e-3
_LOOKS = 4  # each narrows a maximum some hundred times
_LOOK_POINTS = POINTS // 4


@cache
def facts() -> dict[str, Any]:
    """What the paper states, as in ``data/lu2023.toml``.

    Returns
    -------
    dict
    """
    text = (resources.files("lightflyer") / "data" / "lu2023.toml").read_text(encoding="utf-8")
    return tomllib.loads(text)


def film(coating: str, areal_density_g_m2: float | None = None) -> FilmProperties:
    """The model's film with a coating.

    Parameters
    ----------
    coating : str
        ``"ge"`` or ``"cnt"``.
    areal_density_g_m2 : float, optional
        Instead of the stated one [g/m²].

    Returns
    -------
    FilmProperties
    """
    stated = facts()["film"][coating]
    emittance = stated["emittance"]
    grams = stated["areal_density_g_m2"] if areal_density_g_m2 is None else areal_density_g_m2
    return FilmProperties(
        areal_density=grams * _KILOGRAMS_PER_GRAM,
        absorptance=stated["absorptance"],
        emittance_top=emittance,
        emittance_bottom=emittance,
        tac_top=stated["tac_top"],
        tac_bottom=stated["tac_bottom"],
    )


@dataclass(frozen=True)
class Column:
    """One way to compute the paper's numbers: a column of the report.

    Attributes
    ----------
    key, title, description : str
    reading : Reading
    """

    key: str
    title: str
    description: str
    reading: Reading

    @property
    def model(self) -> Lu2023:
        """The force model with the paper's coefficients."""
        fitted = facts()["coefficients"]
        return Lu2023(fitted["c_fm"], fitted["c_cont"], self.reading)


COLUMNS = (
    Column("printed", "printed", "the equations as printed, misprints corrected", PRINTED),
    Column(
        "reported",
        "reported",
        "the conventions that give the paper's own predictions: mean speed at the gas "
        "temperature in (4), (5) once for each face, the mean temperature in (19)",
        REPORTED,
    ),
    Column(
        "reported-mean",
        "reported, T̄ in (20)",
        "as reported, with the mean temperature for that of the disk in (20)",
        REPORTED_MEAN,
    ),
)
"""The report's columns. A further model is a further entry."""

Table = dict[str, np.ndarray]


@quick_entry_point
def _behaviour(flyer: Disk, state: EnvironmentState, model: Lu2023) -> dict[str, Any]:
    balance = equilibrium(flyer, state, model, throw=False)
    levitation = levitate(flyer, state, model, throw=False)
    lift = model.force(flyer, state, balance.excess)
    payload = lift / state.gravity - flyer.own_mass
    return {
        "temperature": balance.temperature,
        "lift_over_weight": lift / weight(flyer, state),
        "payload": payload,
        "relative_payload": payload / flyer.own_mass,
        "levitation_irradiance": levitation.irradiance,
        "levitation_temperature": levitation.temperature,
        "converged": jnp.where(balance.converged & levitation.converged, 1.0, 0.0),
    }


def behaviour(
    model: Lu2023,
    properties: FilmProperties,
    *,
    diameter: Any,
    pressure: Any,
    gas_temperature: Any,
    irradiance: Any = constants.SOLAR_CONSTANT,
    incidence: Any = 0.0,
) -> Table:
    """What a disk does at many points, with the paper's gas, gravity and rounded constant.

    Parameters
    ----------
    model : Lu2023
    properties : FilmProperties
    diameter, pressure, gas_temperature, irradiance, incidence : array, shape (...)
        [m], [Pa], [K], [W/m²], [rad]; they broadcast.

    Returns
    -------
    dict of str to array, broadcast shape
        Temperature [K], payload [kg], lift over weight, relative payload [1], and irradiance
        [W/m²] and temperature [K] to levitate; infinite and NaN where nothing lifts the disk.

    Raises
    ------
    ConvergenceError
        If a root-find failed.
    """
    given = (diameter, pressure, gas_temperature, irradiance, incidence)
    arrays = np.broadcast_arrays(*(np.asarray(value, float) for value in given))
    shape, size = arrays[0].shape, arrays[0].size
    missing = -size % POINTS
    rows = [np.pad(array.ravel(), (0, missing), mode="edge") for array in arrays]
    parts = [
        _chunk(model, properties, *(row[start : start + POINTS] for row in rows))
        for start in range(0, size, POINTS)
    ]
    table = {
        name: np.concatenate([part[name] for part in parts])[:size].reshape(shape)
        for name in parts[0]
    }
    require_converged("the paper's model", table.pop("converged") > 0.5, np.nan)
    return table


def _chunk(
    model: Lu2023,
    properties: FilmProperties,
    diameter: np.ndarray,
    pressure: np.ndarray,
    gas_temperature: np.ndarray,
    irradiance: np.ndarray,
    incidence: np.ndarray,
) -> Table:
    radiation = Radiation(irradiance, incidence, stefan_boltzmann=constants.STEFAN_BOLTZMANN_LU2023)
    gravity = np.full(POINTS, constants.GRAVITY_LU2023)
    state = EnvironmentState(pressure, gas_temperature, gravity, LU2023_AIR, radiation)
    return _behaviour(Disk(properties, 0.5 * diameter, np.zeros(POINTS)), state, model)


def atmosphere(altitude: Any) -> tuple[np.ndarray, np.ndarray]:
    """Pressure [Pa] and temperature [K] of the paper's atmosphere at altitudes [m].

    Parameters
    ----------
    altitude : array, shape (...)

    Returns
    -------
    pressure, temperature : array, shape (...)
    """
    air = Lu2023Atmosphere()
    return np.asarray(air.pressure(altitude)), np.asarray(air.temperature(altitude))


def over_altitude(
    column: Column, altitude: Any, diameter: Any, irradiance: Any, incidence_deg: float = 0.0
) -> Table:
    """The germanium-coated disk in the paper's atmosphere.

    Parameters
    ----------
    column : Column
    altitude, diameter, irradiance : array, shape (...)
        [m], [m], [W/m²]; they broadcast.
    incidence_deg : float
        Angle between light and normal [deg].

    Returns
    -------
    dict of str to array
        As from :func:`behaviour`.
    """
    pressure, temperature = atmosphere(altitude)
    return behaviour(
        column.model,
        film("ge"),
        diameter=diameter,
        pressure=pressure,
        gas_temperature=temperature,
        irradiance=irradiance,
        incidence=math.radians(incidence_deg),
    )


def in_chamber(
    column: Column,
    properties: FilmProperties,
    pressure: Any,
    diameter: Any,
    irradiance: Any = constants.SOLAR_CONSTANT,
) -> Table:
    """A coated disk in the chamber, under the assumed conditions.

    Parameters
    ----------
    column : Column
    properties : FilmProperties
        From :func:`film`.
    pressure, diameter, irradiance : array, shape (...)
        [Pa], [m], [W/m²]; they broadcast.

    Returns
    -------
    dict of str to array
        As from :func:`behaviour`.
    """
    return behaviour(
        column.model,
        properties,
        diameter=diameter,
        pressure=pressure,
        gas_temperature=facts()["chamber"]["temperature_k"],
        irradiance=irradiance,
    )


def maximum(
    function: Callable[[np.ndarray], np.ndarray], low: float, high: float
) -> tuple[np.ndarray, np.ndarray]:
    """Largest values of functions of one coordinate, by looking closer and closer.

    Parameters
    ----------
    function : callable
        Takes coordinates of shape (n, m), returns values of that shape, one function a column.
        NaN counts as lowest.
    low, high : float
        Range of the coordinate.

    Returns
    -------
    coordinate, value : array, shape (m,)
    """
    ends = np.array([[low], [high]])
    fractions = np.linspace(0.0, 1.0, _LOOK_POINTS)[:, None]
    for _ in range(_LOOKS):
        points = ends[0] + fractions * (ends[1] - ends[0])
        values = function(points)
        points = np.broadcast_to(points, values.shape)
        best = np.argmax(np.where(np.isnan(values), -np.inf, values), axis=0)
        column = np.arange(values.shape[1])
        before, after = np.maximum(best - 1, 0), np.minimum(best + 1, _LOOK_POINTS - 1)
        found = points[best, column], values[best, column]
        ends = np.stack([points[before, column], points[after, column]])
    return found
