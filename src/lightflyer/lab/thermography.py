r"""Reflectance, transmittance and emissivity from temperatures, or from a light meter.

A thermal camera sees three apparent temperatures of a film above a hotplate: that of the hotplate,
that of the film's lower side, which reflects the hotplate, and that of its upper side, which
transmits it. In excess of the radiation of surroundings at :math:`T_\infty`,

.. math::
    \rho = \frac{T_\mathrm{lower}^4 - T_\infty^4}{T_\mathrm{hotplate}^4 - T_\infty^4}, \quad
    \tau = \frac{T_\mathrm{upper}^4 - T_\infty^4}{T_\mathrm{hotplate}^4 - T_\infty^4}, \quad
    \varepsilon = 1 - \tau - \rho .

For a light meter's readings of incident, reflected and transmitted light, less its reading in the
dark, the same relations hold with the first power in place of the fourth.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from lightflyer.foundation.checks import require_range
from lightflyer.foundation.errors import ConfigurationError, ParameterError
from lightflyer.foundation.layout import Column
from lightflyer.foundation.quantity import Quantity, Temperature, quantity_of
from lightflyer.foundation.table import Table, read_table
from lightflyer.foundation.units import Measured
from lightflyer.lab.estimate import Estimate, central_interval
from lightflyer.lab.record import dataset

if TYPE_CHECKING:
    import xarray as xr

DRAWS = 100_000
"""Number of Monte Carlo draws."""

PROPERTIES = ("reflectance", "transmittance", "emissivity")
"""Properties that the readings determine."""


class Method(NamedTuple):
    """Kind of reading.

    Attributes
    ----------
    readings : tuple of str
        Names of the readings of source, reflection, transmission and background.
    power : int
        Power of the reading that is proportional to radiation.
    quantity : Quantity
        Unit and possible range of the readings.
    remainder : str
        Name of the part that is neither reflected nor transmitted.
    """

    readings: tuple[str, str, str, str]
    power: int
    quantity: Quantity
    remainder: str


THERMAL = Method(
    ("hotplate_temperature", "lower_temperature", "upper_temperature", "ambient_temperature"),
    4, quantity_of(Temperature) or Quantity("K"), "emissivity",
)  # fmt: skip
"""Apparent temperatures of a thermal camera."""

LIGHT = Method(
    ("incident", "reflected", "transmitted", "dark"), 1, Quantity("", 0.0), "absorptivity"
)
"""Readings of a light meter, all in the same unit."""

_ALIASES = {
    "hotplate_temperature": ("t_hotplate", "hotplate"),
    "lower_temperature": ("t_lower", "lower"),
    "upper_temperature": ("t_upper", "upper"),
    "ambient_temperature": ("t_ambient", "t_inf", "ambient"),
}


@dataclass(frozen=True)
class Readings:
    """Repeated readings of source, reflection, transmission and background.

    Attributes
    ----------
    method : Method
    values : array, shape (4, n)
        In the order of the method's readings [K], or in the light meter's unit.
    uncertainties : array, shape (4,)
        Standard uncertainties common to all n rows, such as a calibration's.
    """

    method: Method
    values: np.ndarray
    uncertainties: np.ndarray


@dataclass(frozen=True)
class RadiativeProperties:
    """Reflectance, transmittance and emissivity, or absorptivity for a light meter.

    Attributes
    ----------
    readings : Readings
    first_order, monte_carlo : dict of str to Estimate
        Uncertainty propagated by derivatives and by draws; by names of :data:`PROPERTIES`.
    """

    readings: Readings
    first_order: dict[str, Estimate]
    monte_carlo: dict[str, Estimate]

    @property
    def emissivity(self) -> Estimate:
        """Emissivity, or absorptivity for a light meter [1]."""
        return self.first_order["emissivity"]

    def summary(self) -> dict[str, Any]:
        """The result as a JSON object."""
        remainder = self.readings.method.remainder

        def named(estimates: Mapping[str, Estimate]) -> dict[str, Any]:
            return {
                remainder if name == "emissivity" else name: one.to_json()
                for name, one in estimates.items()
            }

        return named(self.first_order) | {
            "monte_carlo": named(self.monte_carlo),
            "rows_used": self.readings.values.shape[1],
        }


def columns_of(method: Method) -> tuple[Column, ...]:
    """Columns of a table of readings, each with its standard uncertainty.

    Parameters
    ----------
    method : Method

    Returns
    -------
    tuple of Column
    """
    readings = [Column(name, method.quantity, _ALIASES.get(name, ())) for name in method.readings]
    return tuple(column for one in readings for column in (one, one.uncertainty()))


def read_readings(
    path: str | Path,
    method: Method,
    *,
    columns: str | None = None,
    given: Mapping[str, Measured] | None = None,
) -> tuple[Readings, Table]:
    """Read a table of readings, one measurement per row.

    Parameters
    ----------
    path : str or path
    method : Method
    columns : str, optional
        The columns in the order of the file, in place of a header; see
        :func:`~lightflyer.foundation.table.read_table`.
    given : mapping of str to Measured, optional
        Readings for which the file has no column.

    Returns
    -------
    readings : Readings
    table : Table

    Raises
    ------
    ConfigurationError
        One line that names file and line or column.
    """
    table = read_table(path, columns_of(method), layout=columns)
    given = dict(given or {})
    if method is LIGHT and "dark" not in table.numbers:
        given.setdefault("dark", Measured(0.0))
    values, spreads = [], []
    for name in method.readings:
        if name in table.numbers:
            values.append(table.numbers[name])
            own = table.numbers.get(f"{name}_uncertainty")
            stated = given[name].uncertainty if name in given else None
            spreads.append(float(own.max()) if own is not None else stated or 0.0)
        elif name in given:
            values.append(np.full(len(table), given[name].value))
            spreads.append(given[name].uncertainty or 0.0)
        else:
            raise ConfigurationError(f"{path}: the column {name} is missing")
    readings = Readings(method, np.stack(values), np.array(spreads))
    source, _, _, background = readings.values
    for row in np.flatnonzero(source <= background):
        raise ConfigurationError(
            f"{path}:{table.lines[row]}: {method.readings[0]} is not above {method.readings[3]}"
        )
    return readings, table


def given_readings(given: Mapping[str, Measured], method: Method) -> Readings:
    """Readings from single values.

    Parameters
    ----------
    given : mapping of str to Measured
        By the names of the method's readings.
    method : Method

    Returns
    -------
    Readings

    Raises
    ------
    ConfigurationError
        If one is missing, or the source is not above the background.
    """
    missing = [name for name in method.readings if name not in given]
    if missing:
        raise ConfigurationError(f"give a file, or also {', '.join(missing)}")
    picked = [given[name] for name in method.readings]
    values = np.array([[one.value] for one in picked])
    if values[0, 0] <= values[3, 0]:
        raise ConfigurationError(f"{method.readings[0]} is not above {method.readings[3]}")
    return Readings(method, values, np.array([one.uncertainty or 0.0 for one in picked]))


def properties_of(values: np.ndarray, power: int) -> np.ndarray:
    """Reflectance, transmittance and remainder from readings.

    Parameters
    ----------
    values : array, shape (4, ...)
        Readings of source, reflection, transmission and background.
    power : int
        Power of a reading that is proportional to radiation.

    Returns
    -------
    array, shape (3, ...)
        [1].
    """
    source, reflected, transmitted, background = values**power
    reflectance = (reflected - background) / (source - background)
    transmittance = (transmitted - background) / (source - background)
    return np.stack([reflectance, transmittance, 1.0 - reflectance - transmittance])


def _derivatives(values: np.ndarray, power: int) -> np.ndarray:
    """Derivatives of the three properties by the four readings, shape (3, 4)."""
    source, _, _, background = values**power
    slope = power * values ** (power - 1)
    span = source - background
    found = properties_of(values, power)
    rows = np.zeros((3, 4))
    for number in (0, 1):
        rows[number, 0] = -found[number] * slope[0] / span
        rows[number, 1 + number] = slope[1 + number] / span
        rows[number, 3] = (found[number] - 1.0) * slope[3] / span
    rows[2] = -rows[0] - rows[1]
    return rows


def reduce_readings(
    readings: Readings, *, draws: int = DRAWS, seed: int = 0
) -> RadiativeProperties:
    """Reflectance, transmittance and emissivity with propagated uncertainties.

    Parameters
    ----------
    readings : Readings
    draws : int
        Number of Monte Carlo draws.
    seed : int
        Seed of the draws.

    Returns
    -------
    RadiativeProperties

    Raises
    ------
    ParameterError
        If a reading is negative, or the source does not exceed the background.

    Notes
    -----
    The stated uncertainties are common to all rows and do not average out. The scatter of several
    rows does average out; the scatter of their properties is added. First order uses derivatives
    at the mean readings, Monte Carlo normal draws of the readings, whose interval need not be
    symmetric.
    """
    require_range("draws", draws, 1000)
    power, count = readings.method.power, readings.values.shape[1]
    mean = readings.values.mean(axis=1)
    if np.any(readings.values < 0.0) or np.any(readings.values[0] <= readings.values[3]):
        raise ParameterError("readings must not be negative, and the source must exceed background")
    each = properties_of(readings.values, power)
    value = each.mean(axis=1)
    scatter = np.cov(each) / count if count > 1 else np.zeros((3, 3))
    slopes = _derivatives(mean, power)
    common = (slopes * readings.uncertainties**2) @ slopes.T
    # the scatter of few rows is poorly known, which the degrees of freedom account for
    total, random = np.diag(common + scatter), np.diag(scatter)
    with np.errstate(divide="ignore", invalid="ignore"):
        freedom = np.where(random > 0.0, (count - 1) * (total / random) ** 2, np.inf)
    rng = np.random.default_rng(seed)
    drawn = mean[:, None] + readings.uncertainties[:, None] * rng.normal(size=(4, draws))
    cloud = properties_of(np.maximum(drawn, 0.0), power) - properties_of(mean, power)[:, None]
    cloud += value[:, None] + rng.multivariate_normal(np.zeros(3), scatter, draws).T
    low, high = central_interval(cloud, axis=1)
    return RadiativeProperties(
        readings=readings,
        first_order={
            name: Estimate.normal(float(one), float(np.sqrt(variance)), "", float(known))
            for name, one, variance, known in zip(PROPERTIES, value, total, freedom, strict=True)
        },
        monte_carlo={
            name: Estimate(float(cloud[number].mean()), (float(low[number]), float(high[number])),
                           "", float(cloud[number].std()))
            for number, name in enumerate(PROPERTIES)
        },
    )  # fmt: skip


def to_dataset(result: RadiativeProperties, files: Sequence[str]) -> "xr.Dataset":
    """Readings and properties of each row.

    Parameters
    ----------
    result : RadiativeProperties
    files : sequence of str
        Names of the files read.

    Returns
    -------
    xarray.Dataset
    """
    readings = result.readings
    method = readings.method
    each = properties_of(readings.values, method.power)
    names = [method.remainder if name == "emissivity" else name for name in PROPERTIES]
    variables: dict[str, Any] = {
        name: (
            "row",
            values,
            {"units": method.quantity.unit or "1", "long_name": name.replace("_", " ")},
        )
        for name, values in zip(method.readings, readings.values, strict=True)
    }
    variables |= {
        name: ("row", values, {"units": "1", "long_name": name})
        for name, values in zip(names, each, strict=True)
    }
    return dataset("reflectance, transmittance and emissivity", variables, files)
