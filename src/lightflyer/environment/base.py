"""Base classes of environments: state of the surroundings, place, coordinate, atmosphere."""

import abc
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple

import numpy as np

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.array.records import AbstractVar, Module, ShortRepr, short_repr
from lightflyer.core.checks import is_concrete, is_labelled
from lightflyer.core.clock import date_text, seconds_of
from lightflyer.core.errors import ParameterError
from lightflyer.core.quantity import (
    RADIANS_PER_DEGREE,
    Acceleration,
    Altitude,
    Checked,
    Latitude,
    Length,
    Longitude,
    Pressure,
    Quantity,
    Temperature,
    quantity_of,
)
from lightflyer.core.units import scale_and_offset
from lightflyer.environment.planet import Planet
from lightflyer.environment.radiation import Radiation
from lightflyer.gas.base import AbstractGas

_DIGITS = (range(1, 10), (1, 2, 3, 5), (1, 2, 5), (1, 3), (1,))  # of round pressures
_STEPS = (1.0, 2.0, 5.0, 10.0)  # of round altitudes
_ROUNDING = 1e-9
_DEGREES = tuple(quantity_of(kind) or Quantity() for kind in (Latitude, Longitude))


class Wind(NamedTuple):
    """Velocity of the gas over ground."""

    east: Numeric  #: Components [m/s]
    north: Numeric  #: Components [m/s]
    up: Numeric  #: Components [m/s]

    def __repr__(self) -> str:
        return short_repr(self)


class _Place(NamedTuple):
    latitude: Numeric  #: Geodetic, north and east positive [rad]
    longitude: Numeric  #: Geodetic, north and east positive [rad]
    time: Numeric  #: Seconds since 2000-01-01 12:00 UTC [s]


class Place(_Place):
    """Place on a planet and time: what the coordinate of an environment leaves open.

    Raises
    ------
    ParameterError
        If a latitude is beyond π/2, or a longitude two turns away: :meth:`at` takes degrees.
    """

    __slots__ = ()

    def __new__(cls, latitude: Numeric, longitude: Numeric, time: Numeric) -> "Place":
        for name, angle, highest in (
            ("latitude", latitude, 0.5 * np.pi), ("longitude", longitude, 4.0 * np.pi)
        ):  # fmt: skip
            if is_concrete(angle):
                beyond = np.abs(angle) > highest * (1.0 + _ROUNDING)
                if np.any(beyond):
                    raise ParameterError(
                        f"{name} = {np.ravel(angle)[np.ravel(beyond)][0]:g} rad is more than "
                        f"{highest:.4g} rad; Place.at(date, latitude, longitude) takes degrees"
                    )
        return super().__new__(cls, latitude, longitude, time)

    @classmethod
    def _make(cls, parts: Iterable[Any]) -> "Place":  # type: ignore[override]
        return cls(*parts)  # checked, as ``_replace`` comes here

    @classmethod
    def at(cls, date: Any, latitude: Numeric, longitude: Numeric) -> "Place":
        """A place from a date and degrees; ``latitude``, ``longitude`` [deg].

        ``date``: a text, a date of Python, NumPy or pandas, an array or a list of them, or seconds
        since 2000-01-01 12:00 UTC. Without a zone it is UTC.

        Examples
        --------
        >>> print(Place.at("2026-06-21T12:00Z", 45.0, -120.5).describe())
        at 45° N, 120.5° W on 2026-06-21 12:00 UTC
        """
        degrees = {"latitude": latitude, "longitude": longitude}
        for name, quantity in zip(degrees, _DEGREES, strict=True):
            degrees[name] = quantity.number(name, degrees[name])
            quantity.check(name, degrees[name])
        north, east = (RADIANS_PER_DEGREE * value for value in degrees.values())
        time = seconds_of(date)
        shapes = {"date": np.shape(time), "latitude": np.shape(north), "longitude": np.shape(east)}
        try:
            np.broadcast_shapes(*shapes.values())
        except ValueError:
            told = ", ".join(f"{name} of shape {shape}" for name, shape in shapes.items())
            if not any(is_labelled(one) for one in (time, north, east)):
                raise ParameterError(f"{told} do not fit together") from None
        return cls(north, east, time)

    def describe(self) -> str:
        """Where and when in words, of one concrete place."""
        latitude, longitude = (float(np.asarray(angle)) / RADIANS_PER_DEGREE for angle in self[:2])
        return (
            f"at {abs(latitude):.4g}° {'N' if latitude >= 0.0 else 'S'}, "
            f"{abs(longitude):.5g}° {'E' if longitude >= 0.0 else 'W'} on {date_text(self.time)}"
        )


class EnvironmentState(Checked):
    """The surroundings at one place, or at many: fields broadcast."""

    pressure: Pressure  #: Gas pressure [Pa]
    temperature: Temperature  #: Gas temperature far from the flyer [K]
    gravity: Acceleration  #: Acceleration of free fall [m/s²]
    gas: AbstractGas
    radiation: Radiation
    #: Distance from the flyer's centre to cold walls around it [m]; None in the open
    wall_distance: Length | None = None
    #: Distance down to a solid floor and up to a solid lid [m]; None where there is none near. With
    #: either, the walls around are solid too
    floor_distance: Length | None = None
    lid_distance: Length | None = None  #: Of the lid, as ``floor_distance``
    #: Floor's temperature over that of lid and side wall, less one [1]; None where all are alike.
    #: The gas temperature is then that which the gas has at the flyer's place
    floor_excess: Numeric = None
    wind: Wind | None = None  #: None where the gas is at rest


@dataclass(frozen=True)
class Coordinate(ShortRepr):
    """The coordinate along which an environment is described."""

    name: str  #: As in datasets; the unit is SI
    unit: str  #: As in datasets; the unit is SI
    long_name: str  #: As in datasets; the unit is SI
    lowest: float  #: Range in which states exist
    highest: float  #: Range in which states exist
    searched: tuple[float, float]  #: Range worth searching for flight, within the former
    logarithmic: bool  #: Whether tables and axes are spaced by the logarithm
    shown_unit: str  #: Unit in tables, figures and JSON
    #: Names in JSON of the point that needs the least light: of the group and of the irradiance
    easiest_keys: tuple[str, str]
    #: Spacing that resolves an atmosphere's layers; None for a range cut into equal parts
    step: float | None = None
    #: Whether states exist beyond ``lowest`` and ``highest``, which then only say where to look
    open_ended: bool = False

    @property
    def quantity(self) -> Quantity:
        """Unit and possible range."""
        if self.open_ended:
            return quantity_of(Pressure) or Quantity()
        return Quantity(self.unit, self.lowest, self.highest, usual=self.shown_unit)

    def to_axis(self, coordinate: Numeric) -> Any:
        """Place on an axis: the coordinate, or its logarithm."""
        return np.log(coordinate) if self.logarithmic else coordinate

    def from_axis(self, place: Numeric) -> Any:
        """Coordinate of a place on an axis."""
        return np.exp(place) if self.logarithmic else place

    def evenly(self, low: float, high: float, points: int) -> np.ndarray:
        """Coordinates at even places from low to high, shape (points,)."""
        spaced = np.geomspace if self.logarithmic else np.linspace
        return spaced(low, high, points)

    def round_points(self, low: float, high: float, most: int) -> np.ndarray:
        """Round coordinates within a range, about ``most`` of them; its ends where none are."""
        if self.logarithmic:
            decades = np.arange(np.floor(np.log10(low)), np.ceil(np.log10(high)) + 1.0)
            tables = (np.multiply.outer(10.0**decades, digits).ravel() for digits in _DIGITS)
            parts = [found[(found >= low) & (found <= high)] for found in tables]
            found = next((part for part in parts if part.size <= most), parts[-1])
        else:
            factor, _ = scale_and_offset(self.unit, self.shown_unit)
            least = (high - low) * factor / most
            power = 10.0 ** np.floor(np.log10(least))
            step = next(power * digit for digit in _STEPS if power * digit >= least)
            first, last = np.ceil(low * factor / step), np.floor(high * factor / step)
            found = np.arange(first, last + 1.0) * step / factor
        inside = found[(found >= low) & (found <= high)]
        return inside if inside.size else np.array([low, high])


class AbstractEnvironment(Checked):
    """Somewhere a flyer can be, described along one coordinate. Subclasses are final.

    Attributes
    ----------
    radiation : Radiation
        Light and heat radiation; every state has it, or what the environment makes of it.
    """

    dimmable_light: ClassVar[bool] = False
    """True if the light can be turned up and down, as a lamp can and the sun cannot."""

    planet: ClassVar[Planet | None] = None
    """The planet over which places are; None in a chamber."""

    radiation: AbstractVar[Radiation]

    @property
    @abc.abstractmethod
    def coordinate(self) -> Coordinate:
        """Name, unit and range of the coordinate."""

    def assumptions(self) -> tuple[str, ...]:
        """What is assumed about light and heat radiation, in short texts with units."""
        return self.radiation.describe()

    def assumptions_of_air(self) -> tuple[str, ...]:
        """What is assumed about the air besides, in short texts; part of :meth:`assumptions`."""
        return ()

    @abc.abstractmethod
    def state(self, coordinate: Numeric, place: Place | None = None) -> EnvironmentState:
        """Surroundings at a coordinate, shape (...), in the unit of :attr:`coordinate`.

        ``place`` matters where the environment depends on it; by default the environment's own.
        """


class AbstractAtmosphere(Module):
    """Temperature, pressure and composition over altitude, and over place and time where known.

    Methods take altitudes [m] of any shape and a place whose fields broadcast with them. They work
    under JAX's transformations and return NaN outside :attr:`altitude_range`; environments raise
    there where the altitude is concrete. An atmosphere of one place and time, and one that is the
    same everywhere, does not look at the place.
    """

    @property
    @abc.abstractmethod
    def altitude_range(self) -> tuple[float, float]:
        """Lowest and highest geometric altitude described [m]."""

    @abc.abstractmethod
    def temperature(self, altitude: Altitude, place: Place | None = None) -> Any:
        """Kinetic temperature [K]."""

    @abc.abstractmethod
    def pressure(self, altitude: Altitude, place: Place | None = None) -> Any:
        """Pressure [Pa]."""

    @abc.abstractmethod
    def molar_mass_ratio(self, altitude: Altitude, place: Place | None = None) -> Any:
        """Mean molar mass over its value at sea level [1]."""

    @property
    def has_tides(self) -> bool:
        """Whether tides are part of temperature and pressure, so that nothing else adds theirs."""
        return False

    def describe(self) -> str:
        """Which atmosphere it is, in a short text; by default the name of the class."""
        return f"atmosphere: {type(self).__name__}"

    def _nan_outside(self, altitude: Altitude, value: Numeric) -> Array:
        lowest, highest = self.altitude_range
        return xp.where((altitude >= lowest) & (altitude <= highest), value, np.nan)
