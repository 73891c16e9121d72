"""A wind that is the same everywhere, and the sum of winds."""

import numpy as np

from lightflyer.array.namespace import Numeric, xp
from lightflyer.core.entry_point import entry_point
from lightflyer.core.quantity import (
    Altitude,
    Checked,
    WindSpeed,
    require_record,
)
from lightflyer.core.text import span
from lightflyer.environment.atmosphere.base import AbstractAtmosphere
from lightflyer.environment.base import Place, Wind
from lightflyer.environment.wind.base import AbstractWind, Air


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

    def air(self, altitude: Altitude, place: Place, atmosphere: AbstractAtmosphere) -> Air | None:
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
