"""Base class of winds, a wind that is the same everywhere, and the sum of winds."""

import abc
from functools import reduce
from typing import Any, NamedTuple

import numpy as np

from lightflyer.array.namespace import Numeric, call, xp
from lightflyer.array.records import Module
from lightflyer.core.checks import is_traced, require_data
from lightflyer.core.entry_point import entry_point
from lightflyer.core.quantity import Altitude, Checked, WindSpeed, require_record
from lightflyer.core.text import span
from lightflyer.environment.base import AbstractAtmosphere, Place, Wind


class AirBesideWind(NamedTuple):
    """What a wind's data know of the air itself."""

    temperature: Numeric  # [K]
    pressure: Numeric  # [Pa]


class AbstractWind(Module):
    """Velocity of the gas over ground, by altitude, place and time. Subclasses are final.

    East and north are those of the place's latitude and longitude. At a pole, too, where the
    longitude says which of the directions away from the pole is meant: together they give one
    velocity, whatever the longitude.
    """

    @property
    def has_tides(self) -> bool:
        """Whether tides are part of the wind, so that nothing else adds theirs."""
        return False

    @abc.abstractmethod
    def velocity(self, altitude: Altitude, place: Place) -> Wind:
        """Velocity of the gas at a geometric altitude [m].

        Where a margin is negative, concrete arguments raise :class:`ParameterError`, traced ones
        give NaN.
        """

    def air(
        self, altitude: Altitude, place: Place, atmosphere: AbstractAtmosphere
    ) -> AirBesideWind | None:
        """The air of the wind's data; None where they have none, or only winds are meant.

        ``altitude`` [m]; ``atmosphere``: the air where the data end.
        """
        return None

    def margins(self, altitude: Altitude, place: Place) -> dict[str, Numeric]:
        """How far the wind still reaches, for what integrates along a path; ``altitude`` [m].

        By what is beyond the end, in words, the distance to it: negative where there is no wind, in
        a unit in which ends compare (1 h, 1°, 2 km).
        """
        return {}

    def _require_margins(self, altitude: Altitude, place: Place, wind: Wind) -> Wind:
        """A wind where there is one: else an error, or NaN within a public function."""
        margins = self.margins(altitude, place)
        require_data(margins)
        inner = bool(margins) and (call.depth or is_traced(margins))
        return _blank_unreached(wind, tuple(margins.values())) if inner else wind

    @abc.abstractmethod
    def describe(self) -> tuple[str, ...]:
        """What is assumed about the wind, in short texts with units."""


@entry_point
def _blank_unreached(wind: Wind, margins: tuple[Numeric, ...]) -> Wind:
    reached = reduce(xp.logical_and, [margin >= 0.0 for margin in margins])
    return Wind(*(xp.where(reached, part, np.nan) for part in wind))


def next_to(middle: Numeric, longitude: Numeric) -> Any:
    """The turn of a longitude that is next to another [rad]."""
    return middle + (longitude - middle + np.pi) % (2.0 * np.pi) - np.pi


def near_poles(latitude: np.ndarray) -> tuple[bool, bool]:
    """Whether parallels reach the south and the north pole to within their spacing."""
    near = 0.5 * np.pi - 1.01 * float(np.diff(latitude).max(initial=0.0))
    return bool(latitude[0] < -near), bool(latitude[-1] > near)


class UniformWind(Checked, AbstractWind):
    """A wind of the same east, north and up everywhere and always.

    At a pole a wind towards the east or north has no direction; there it turns with the longitude
    of the place.

    Attributes
    ----------
    east, north, up : array
        Velocity of the gas over ground [m/s]; by default the gas is at rest.

    Examples
    --------
    >>> wind = UniformWind(east="-60 m/s", up=0.05)
    >>> print(wind.describe()[0])
    wind: -60 m/s east, 0.05 m/s up, everywhere
    """

    east: WindSpeed = 0.0
    north: WindSpeed = 0.0
    up: WindSpeed = 0.0

    def velocity(self, altitude: Altitude, place: Place) -> Wind:
        return _uniform((self.east, self.north, self.up), (altitude, *place))

    def describe(self) -> tuple[str, ...]:
        parts = {"east": self.east, "north": self.north, "up": self.up}
        told = [f"{span(part)} m/s {name}" for name, part in parts.items() if np.any(part)]
        return (f"wind: {', '.join(told)}, everywhere" if told else "wind: none",)


class SumOfWinds(AbstractWind):
    """Several winds on top of each other, such as a gradient wind and a wind upwards.

    Parameters
    ----------
    *winds : AbstractWind

    Examples
    --------
    >>> wind = SumOfWinds(UniformWind(east=-60.0), UniformWind(up=0.05))
    >>> print(wind.velocity(70e3, Place(0.5, 0.0, 0.0)).up)
    0.05
    """

    winds: tuple[AbstractWind, ...]

    def __init__(self, *winds: AbstractWind):
        for wind in winds:
            require_record("a wind", (AbstractWind,), wind)
        self.winds = winds

    def velocity(self, altitude: Altitude, place: Place) -> Wind:
        return _sum(tuple(wind.velocity(altitude, place) for wind in self.winds))

    def air(
        self, altitude: Altitude, place: Place, atmosphere: AbstractAtmosphere
    ) -> AirBesideWind | None:
        found = (wind.air(altitude, place, atmosphere) for wind in self.winds)
        return next((air for air in found if air is not None), None)

    def margins(self, altitude: Altitude, place: Place) -> dict[str, Numeric]:
        return {
            name: margin
            for wind in self.winds
            for name, margin in wind.margins(altitude, place).items()
        }

    @property
    def has_tides(self) -> bool:
        return any(wind.has_tides for wind in self.winds)

    def describe(self) -> tuple[str, ...]:
        return tuple(text for wind in self.winds for text in wind.describe())


@entry_point
def _uniform(parts: tuple[Numeric, ...], where: tuple[Numeric, ...]) -> Wind:
    shape = xp.broadcast_shapes(*(xp.shape(value) for value in (*parts, *where)))
    return Wind(*(xp.broadcast_to(part, shape) for part in parts))


@entry_point
def _sum(winds: tuple[Wind, ...]) -> Wind:
    return Wind(*(sum(parts) for parts in zip(*winds, strict=True)))
