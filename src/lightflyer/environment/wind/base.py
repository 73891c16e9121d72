"""Base class of winds."""

import abc
from functools import reduce
from typing import Any, NamedTuple

import numpy as np

from lightflyer.array.namespace import Numeric, call, xp
from lightflyer.array.records import Module
from lightflyer.core.checks import is_traced, require_data
from lightflyer.core.entry_point import entry_point
from lightflyer.core.quantity import Altitude
from lightflyer.environment.atmosphere.base import AbstractAtmosphere
from lightflyer.environment.base import Place, Wind


class Air(NamedTuple):
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
        self,
        altitude: Altitude,  # noqa: ARG002
        place: Place,  # noqa: ARG002
        atmosphere: AbstractAtmosphere,  # noqa: ARG002
    ) -> Air | None:
        """The air of the wind's data; None where they have none, or only winds are meant.

        ``altitude`` [m]; ``atmosphere``: the air where the data end.
        """
        return None

    def margins(self, altitude: Altitude, place: Place) -> dict[str, Numeric]:  # noqa: ARG002
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
