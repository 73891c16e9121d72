"""NRLMSIS 2.1: the atmosphere of a given day and place, and of all places and times.

NRLMSIS 2.1 over all places and times, as harmonics that JAX evaluates.

At a latitude and an altitude, what the model gives is a sum of a few waves in the time of day and
the longitude: the zonal mean, tides that follow the sun, waves that stand over the ground. The
amplitude of each is a sum of a few harmonics of the year. Their coefficients are fitted once, over
nodes of latitude and altitude, and interpolated between these by local cubics.
"""

import datetime
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from lightflyer.array.namespace import Array, xp
from lightflyer.core import constants
from lightflyer.core.entry_point import entry_point
from lightflyer.core.errors import ConfigurationError, MissingExtraError
from lightflyer.core.quantity import (
    RADIANS_PER_DEGREE,
    Altitude,
    GeomagneticIndex,
    Latitude,
    Longitude,
    SolarFlux,
    quantity_of,
)
from lightflyer.environment.base import AbstractAtmosphere, Place
from lightflyer.numerics.interpolation import Axis, Spline, interpolate

_VERSION = 2.1
_TOP_OF_PROFILE = 200e3
_STEP_OF_PROFILE = 500.0
# First and last column of pymsis that hold number densities, and its temperature column.
_FIRST_SPECIES, _LAST_SPECIES, _MASS_DENSITY, _TEMPERATURE = 1, 9, 0, 10


def _check(name: str, value: float, kind: Any) -> None:
    quantity = quantity_of(kind)
    if quantity is not None:
        quantity.check(name, value)


class SolarActivity(NamedTuple):
    """Activity of the sun and of the geomagnetic field, as NRLMSIS takes it."""

    f107: float  # Solar flux at 10.7 cm of the previous day [sfu]
    f107a: float  # Its mean over 81 days [sfu]
    ap: float  # Daily geomagnetic index

    @classmethod
    def of(cls, f107: float, f107a: float | None, ap: float) -> "SolarActivity":
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
    indices: SolarActivity,
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
    indices: SolarActivity

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
        indices = SolarActivity.of(f107, f107a, ap)
        if date.tzinfo is not None:
            date = date.astimezone(datetime.UTC)
        altitudes = np.arange(0.0, _TOP_OF_PROFILE + _STEP_OF_PROFILE, _STEP_OF_PROFILE)
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
        return 0.0, _TOP_OF_PROFILE

    @entry_point
    def temperature(self, altitude: Altitude, place: Place | None = None) -> Any:
        return self._nan_outside(altitude, self.kinetic_temperature(altitude))

    @entry_point
    def pressure(self, altitude: Altitude, place: Place | None = None) -> Any:
        """Pressure [Pa], the sum of the species' number densities times kT."""
        return self._nan_outside(altitude, xp.exp(self.log_pressure(altitude)))

    @entry_point
    def molar_mass_ratio(self, altitude: Altitude, place: Place | None = None) -> Any:
        """Mean molar mass over that of the standard's sea-level air [1]."""
        return self._nan_outside(altitude, self.molar_mass(altitude))


_DAY = 86400.0
TROPICAL_YEAR = 365.2425 * _DAY  # Length of a year of the Gregorian calendar, on average [s]

_DAYS_OF_MODEL = 365  # the period of the model's seasons, in days of the year
_NOON = 0.5  # of a day: the time of day at which time is zero
_TURN = 2.0 * np.pi


class _Wave(NamedTuple):
    """A wave cos(n τ + m λ) in time of day τ and longitude λ, and its harmonics of the year."""

    per_day: int
    zonal: int
    harmonics: int


# Found by a Fourier transform of the model; up to 110 km, no other wave has more than 0.2 K.
_WAVES = (
    _Wave(0, 0, 6),
    _Wave(0, 1, 3),
    _Wave(1, 1, 3),
    _Wave(2, 2, 3),
    _Wave(0, 2, 1),
    _Wave(1, 0, 1),
    _Wave(1, 2, 1),
    _Wave(3, 3, 1),
    _Wave(4, 4, 1),
)
# Samples of time of day and longitude lie on a lattice on which these waves, and the next larger
# ones, can be told apart: sample i at the time i/N of a day and the longitude 3i/N of a turn.
_SAMPLES, _LATTICE = 29, 3
_SEASONS = 16
_YEAR = np.datetime64("2023-01-01T00:00:00")  # of any year of 365 days

_TOP = 150e3
_ALTITUDES = np.arange(0.0, _TOP + 1.0, 2e3)
_SPACING = 7.5
_LATITUDES = np.arange(-90.0, 90.1, _SPACING)


def _terms_of(wave: _Wave) -> list[tuple[int, int]]:
    """Numbers of the factors of its terms: of the wave and of the year."""
    number = _WAVES.index(wave)
    waves = [number] if wave == _MEAN else [number, len(_WAVES) + number]
    cosines = range(1, wave.harmonics + 1)
    yearly = [0, *cosines, *(_MEAN.harmonics + harmonic for harmonic in cosines)]
    return [(one, other) for one in waves for other in yearly]


_MEAN = _WAVES[0]
_TERMS = np.array([term for wave in _WAVES for term in _terms_of(wave)])
_PARITIES = np.array([(-1) ** _WAVES[number % len(_WAVES)].zonal for number in _TERMS[:, 0]])
"""Sign of each term half a turn of longitude away, which is where one comes out at a pole."""


def _yearly(season: Any, xp: Any = xp) -> Any:
    """One, then cosines and sines of the harmonics of the year, shape (..., 13)."""
    angle = xp.asarray(season)[..., None] * np.arange(1.0, _MEAN.harmonics + 1)
    return xp.concatenate([xp.ones_like(angle[..., :1]), xp.cos(angle), xp.sin(angle)], axis=-1)


def _basis(season: Any, day: Any, longitude: Any, xp: Any = xp) -> Any:
    """Waves times harmonics of the year, shape (..., terms)."""
    per_day, zonal, _ = np.array(_WAVES, float).T
    phase = xp.asarray(day)[..., None] * per_day + xp.asarray(longitude)[..., None] * zonal
    waves = xp.concatenate([xp.cos(phase), xp.sin(phase)], axis=-1)
    return waves[..., _TERMS[:, 0]] * _yearly(season, xp)[..., _TERMS[:, 1]]


@cache
def _coefficients(indices: SolarActivity) -> np.ndarray:
    """Fitted coefficients, shape (latitudes, altitudes, 3, terms)."""
    terms, values = [], []
    days = np.round(np.arange(_SEASONS) * _DAYS_OF_MODEL / _SEASONS).astype(int)
    for day in days:
        for sample in range(_SAMPLES):
            second = round(sample / _SAMPLES * _DAY)
            longitude = _LATTICE * sample / _SAMPLES * _TURN % _TURN
            date = _YEAR + np.timedelta64(int(day * _DAY) + second, "s")
            found = evaluate(
                date, _LATITUDES, np.array([longitude / RADIANS_PER_DEGREE]), indices, _ALTITUDES
            )
            terms.append(_basis(_TURN * day / _DAYS_OF_MODEL, _TURN * second / _DAY, longitude, np))
            values.append(found[:, 0])
    model = np.array(values)
    model[:, 1] = np.log(model[:, 1])
    fitted = np.linalg.pinv(np.array(terms)) @ model.reshape(len(model), -1)
    return np.moveaxis(fitted.reshape(-1, *model.shape[1:]), (0, 1), (3, 2))


class GlobalNRLMSIS(AbstractAtmosphere):
    """NRLMSIS 2.1 over every place at every time, 0 to 150 km.

    The model is fitted once, in a second or two, and is differentiable in altitude, place and
    time. Solar and geomagnetic activity stay as given. Nothing is downloaded.

    Parameters
    ----------
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

    Notes
    -----
    The fit departs from the model, at random places and times of 30 years, below 110 km by 0.1 K
    and 0.11 % of the pressure (root mean square), at most 1.6 K and 1.2 %; from 110 km to 150 km
    by at most 4 K, 2 % and 0.5 % of the molar mass. Most of it is the season: the model
    changes at midnight UTC, by a day's worth, and starts anew on the first of January. Here the
    season follows the sun through every day, and repeats itself after 365.2425 days.

    References
    ----------
    [Emmert2022]_.
    """

    coefficients: Any
    latitudes: Axis
    altitudes: Axis
    indices: SolarActivity

    def __init__(self, f107: float, ap: float, f107a: float | None = None):
        self.indices = SolarActivity.of(f107, f107a, ap)
        inner = _coefficients(self.indices)
        # one row beyond each pole, where the row before the pole is met from the other side
        south, north = (inner[row] * _PARITIES for row in (1, -2))
        self.coefficients = np.concatenate([south[None], inner, north[None]])
        beyond = np.array([90.0 + _SPACING])
        nodes = np.concatenate([-beyond, _LATITUDES, beyond])
        self.latitudes = Axis(nodes * RADIANS_PER_DEGREE)
        self.altitudes = Axis(_ALTITUDES)

    @property
    def altitude_range(self) -> tuple[float, float]:
        """0 m to 150 km."""
        return 0.0, _TOP

    @property
    def has_tides(self) -> bool:
        return True

    def describe(self) -> str:
        return f"atmosphere: NRLMSIS 2.1 by place and time, {self.indices.describe()}"

    def _fields(self, altitude: Altitude, place: Place | None) -> tuple[Array, Array, Array]:
        if place is None:
            raise ConfigurationError(
                "NRLMSIS of every place and time needs one of them: fly a mission, or give a "
                'place, in a file by sun = "ephemeris" with date, latitude and longitude'
            )
        found = interpolate(
            self.coefficients, (self.latitudes, self.altitudes), (place.latitude, altitude)
        )
        terms = _basis(
            _TURN * place.time / TROPICAL_YEAR, _TURN * (place.time / _DAY + _NOON), place.longitude
        )
        temperature, log_pressure, ratio = xp.moveaxis(
            xp.sum(found * terms[..., None, :], axis=-1), -1, 0
        )
        return temperature, log_pressure, ratio

    @entry_point
    def temperature(self, altitude: Altitude, place: Place | None = None) -> Any:
        return self._nan_outside(altitude, self._fields(altitude, place)[0])

    @entry_point
    def pressure(self, altitude: Altitude, place: Place | None = None) -> Any:
        """Pressure [Pa], the sum of the species' number densities times kT."""
        return self._nan_outside(altitude, xp.exp(self._fields(altitude, place)[1]))

    @entry_point
    def molar_mass_ratio(self, altitude: Altitude, place: Place | None = None) -> Any:
        """Mean molar mass over that of the standard's sea-level air [1]."""
        return self._nan_outside(altitude, self._fields(altitude, place)[2])

    def zonal_means(self, seasons: np.ndarray) -> tuple[np.ndarray, ...]:
        """Zonal and daily means on the nodes of the table; ``seasons``: times."""
        yearly = _yearly(_TURN * seasons / TROPICAL_YEAR, np)
        fields = self.coefficients[1:-1, :, :, : yearly.shape[-1]] @ yearly.T
        latitude = _LATITUDES * RADIANS_PER_DEGREE
        return latitude, _ALTITUDES, *np.moveaxis(fields, (2, 3), (0, 1))
