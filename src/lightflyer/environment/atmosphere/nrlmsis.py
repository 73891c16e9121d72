"""NRLMSIS 2.1: the atmosphere of a given day and place."""

import datetime
from typing import Any

import jax.numpy as jnp
import numpy as np

from lightflyer.environment.atmosphere.base import AbstractAtmosphere
from lightflyer.environment.base import Place
from lightflyer.foundation import constants
from lightflyer.foundation.checks import require_range
from lightflyer.foundation.errors import MissingExtraError
from lightflyer.foundation.precision import entry_point
from lightflyer.foundation.spline import Spline
from lightflyer.foundation.types import Numeric

_VERSION = 2.1
_TOP = 200e3
_SPACING = 500.0
# First and last column of pymsis that hold number densities, and its temperature column.
_FIRST_SPECIES, _LAST_SPECIES, _MASS_DENSITY, _TEMPERATURE = 1, 9, 0, 10


def _profile(
    date: datetime.datetime,
    latitude: float,
    longitude: float,
    indices: tuple[float, float, float],
    altitudes: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Temperature [K], pressure [Pa] and molar-mass ratio at ``altitudes`` [m]."""
    try:
        import pymsis
    except ImportError as error:
        raise MissingExtraError(
            "the NRLMSIS atmosphere needs pymsis: pip install 'lightflyer[nrlmsis]'"
        ) from error
    f107, f107a, ap = indices
    # All three indices are given, so pymsis has no reason to download any.
    result = pymsis.calculate(
        np.datetime64(date.replace(tzinfo=None)),
        longitude,
        latitude,
        altitudes / 1e3,
        f107s=f107,
        f107as=f107a,
        aps=[[ap] * 7],
        version=_VERSION,
    ).reshape(altitudes.size, -1)
    temperature = result[:, _TEMPERATURE].astype(float)
    # pymsis marks species that are absent at an altitude by NaN
    species = result[:, _FIRST_SPECIES : _LAST_SPECIES + 1].astype(float)
    number_density = np.nansum(species, axis=1)
    pressure = number_density * constants.BOLTZMANN * temperature
    molar_mass = result[:, _MASS_DENSITY] / number_density * constants.AVOGADRO * 1e3
    return temperature, pressure, molar_mass / constants.MOLAR_MASS_AIR


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

    def __init__(
        self,
        date: datetime.datetime,
        latitude: float,
        longitude: float,
        f107: float,
        ap: float,
        f107a: float | None = None,
    ):
        f107a = f107 if f107a is None else f107a
        require_range("latitude", latitude, -90.0, 90.0)
        require_range("longitude", longitude, -180.0, 360.0)
        require_range("f107", f107, 40.0, 500.0)
        require_range("f107a", f107a, 40.0, 500.0)
        require_range("ap", ap, 0.0, 400.0)
        if date.tzinfo is not None:
            date = date.astimezone(datetime.UTC)
        altitudes = np.arange(0.0, _TOP + _SPACING, _SPACING)
        profile = _profile(date, latitude, longitude, (f107, f107a, ap), altitudes)
        temperature, pressure, ratio = profile
        self.kinetic_temperature = Spline.through(altitudes, temperature)
        self.log_pressure = Spline.through(altitudes, np.log(pressure))
        self.molar_mass = Spline.through(altitudes, ratio)

    @property
    def altitude_range(self) -> tuple[float, float]:
        """0 m to 200 km."""
        return 0.0, _TOP

    @entry_point
    def temperature(self, altitude: Numeric, place: Place | None = None) -> Any:  # noqa: ARG002
        """Temperature [K]."""
        return self._nan_outside(altitude, self.kinetic_temperature(altitude))

    @entry_point
    def pressure(self, altitude: Numeric, place: Place | None = None) -> Any:  # noqa: ARG002
        """Pressure [Pa], the sum of the species' number densities times kT."""
        return self._nan_outside(altitude, jnp.exp(self.log_pressure(altitude)))

    @entry_point
    def molar_mass_ratio(self, altitude: Numeric, place: Place | None = None) -> Any:  # noqa: ARG002
        """Mean molar mass over that of the standard's sea-level air [1]."""
        return self._nan_outside(altitude, self.molar_mass(altitude))
