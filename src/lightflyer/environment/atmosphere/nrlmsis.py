"""NRLMSIS 2.1: the atmosphere of a given day and place."""

import datetime
from typing import Any, NamedTuple

import numpy as np

from lightflyer.array.namespace import xp
from lightflyer.core import constants
from lightflyer.core.entry_point import entry_point
from lightflyer.core.errors import MissingExtraError
from lightflyer.core.quantity import (
    Altitude,
    GeomagneticIndex,
    Latitude,
    Longitude,
    SolarFlux,
    quantity_of,
)
from lightflyer.environment.atmosphere.base import AbstractAtmosphere
from lightflyer.environment.base import Place
from lightflyer.numerics.spline import Spline

_VERSION = 2.1
_TOP = 200e3
_SPACING = 500.0
# First and last column of pymsis that hold number densities, and its temperature column.
_FIRST_SPECIES, _LAST_SPECIES, _MASS_DENSITY, _TEMPERATURE = 1, 9, 0, 10


def _check(name: str, value: float, kind: Any) -> None:
    quantity = quantity_of(kind)
    if quantity is not None:
        quantity.check(name, value)


class Indices(NamedTuple):
    """Activity of the sun and of the geomagnetic field, as NRLMSIS takes it."""

    f107: float  # Solar flux at 10.7 cm of the previous day [sfu]
    f107a: float  # Its mean over 81 days [sfu]
    ap: float  # Daily geomagnetic index

    @classmethod
    def of(cls, f107: float, f107a: float | None, ap: float) -> "Indices":
        """Checked indices; a mean that is None is taken for that of the day."""
        f107a = f107 if f107a is None else f107a
        _check("f107", f107, SolarFlux)
        _check("f107a", f107a, SolarFlux)
        _check("ap", ap, GeomagneticIndex)
        return cls(f107, f107a, ap)

    def describe(self) -> str:
        """The indices in words."""
        return f"F10.7 = {self.f107:g} (mean {self.f107a:g}), ap = {self.ap:g}"


def evaluate(
    date: np.datetime64,
    latitude: np.ndarray,
    longitude: np.ndarray,
    indices: Indices,
    altitude: np.ndarray,
) -> np.ndarray:
    """NRLMSIS 2.1 at columns of one time [K], shape (3, m, n, k); ``altitude`` (k,)."""
    try:
        import pymsis
    except ImportError as error:
        raise MissingExtraError(
            "the NRLMSIS atmosphere needs pymsis: pip install 'lightflyer[nrlmsis]'"
        ) from error
    # All three indices are given, so pymsis has no reason to download any.
    result = pymsis.calculate(
        [date],
        longitude,
        latitude,
        altitude / 1e3,
        f107s=[indices.f107],
        f107as=[indices.f107a],
        aps=[[indices.ap] * 7],
        version=_VERSION,
    ).reshape(longitude.size, latitude.size, altitude.size, -1)
    temperature = result[..., _TEMPERATURE].astype(float)
    # pymsis marks species that are absent at an altitude by NaN
    species = result[..., _FIRST_SPECIES : _LAST_SPECIES + 1].astype(float)
    number_density = np.nansum(species, axis=-1)
    pressure = number_density * constants.BOLTZMANN * temperature
    molar_mass = result[..., _MASS_DENSITY] / number_density * constants.AVOGADRO * 1e3
    return np.stack([temperature, pressure, molar_mass / constants.MOLAR_MASS_AIR])


class NRLMSIS(AbstractAtmosphere):
    """NRLMSIS 2.1 over one place at one time, 0 to 200 km.

    The model is evaluated once, every 500 m, and kept as splines of temperature, log-pressure
    and molar mass, so that it is differentiable in altitude. Nothing is downloaded.

    Parameters
    ----------
    date : datetime.datetime
        Time, taken as UTC unless it has a time zone.
    latitude, longitude : float
        Geodetic [deg], north and east positive.
    f107 : float
        Solar flux at 10.7 cm of the previous day [sfu].
    ap : float
        Daily geomagnetic index.
    f107a : float, optional
        81-day mean of ``f107`` [sfu]; by default the same.

    Raises
    ------
    MissingExtraError
        If pymsis is not installed.
    ParameterError
        If an argument is outside its range.

    References
    ----------
    [Emmert2022]_.
    """

    log_pressure: Spline
    kinetic_temperature: Spline
    molar_mass: Spline
    place: Place
    indices: Indices

    def __init__(
        self,
        date: datetime.datetime,
        latitude: float,
        longitude: float,
        f107: float,
        ap: float,
        f107a: float | None = None,
    ):
        _check("latitude", latitude, Latitude)
        _check("longitude", longitude, Longitude)
        indices = Indices.of(f107, f107a, ap)
        if date.tzinfo is not None:
            date = date.astimezone(datetime.UTC)
        altitudes = np.arange(0.0, _TOP + _SPACING, _SPACING)
        temperature, pressure, ratio = evaluate(
            np.datetime64(date.replace(tzinfo=None)),
            np.array([latitude]),
            np.array([longitude]),
            indices,
            altitudes,
        )[:, 0, 0]
        self.kinetic_temperature = Spline.through(altitudes, temperature)
        self.log_pressure = Spline.through(altitudes, np.log(pressure))
        self.molar_mass = Spline.through(altitudes, ratio)
        self.place, self.indices = Place.at(date, latitude, longitude), indices

    def describe(self) -> str:
        return f"atmosphere: NRLMSIS 2.1, {self.place.describe()}, {self.indices.describe()}"

    @property
    def altitude_range(self) -> tuple[float, float]:
        """0 m to 200 km."""
        return 0.0, _TOP

    @entry_point
    def temperature(self, altitude: Altitude, place: Place | None = None) -> Any:  # noqa: ARG002
        return self._nan_outside(altitude, self.kinetic_temperature(altitude))

    @entry_point
    def pressure(self, altitude: Altitude, place: Place | None = None) -> Any:  # noqa: ARG002
        """Pressure [Pa], the sum of the species' number densities times kT."""
        return self._nan_outside(altitude, xp.exp(self.log_pressure(altitude)))

    @entry_point
    def molar_mass_ratio(self, altitude: Altitude, place: Place | None = None) -> Any:  # noqa: ARG002
        """Mean molar mass over that of the standard's sea-level air [1]."""
        return self._nan_outside(altitude, self.molar_mass(altitude))
