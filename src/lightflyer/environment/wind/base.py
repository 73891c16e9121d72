"""Base class of winds."""

import abc
from functools import reduce

import equinox as eqx
import jax.numpy as jnp
import numpy as np

from lightflyer.core.checks import is_traced
from lightflyer.core.errors import ParameterError
from lightflyer.core.quantity import Altitude
from lightflyer.core.types import Numeric
from lightflyer.environment.base import Place, Wind
from lightflyer.program.entry_point import entry_point


class AbstractWind(eqx.Module):
    """Velocity of the gas over ground, by altitude, place and time. Subclasses are final.

    East and north are those of the place's latitude and longitude. At a pole, too, where the
    longitude says which of the directions away from the pole is meant: together they give one
    velocity, whatever the longitude.
    """

    @abc.abstractmethod
    def velocity(self, altitude: Altitude, place: Place) -> Wind:
        """Velocity of the gas.

        Parameters
        ----------
        altitude : array, shape (...)
            Geometric altitude [m].
        place : Place
            Broadcasts with the altitude.

        Returns
        -------
        Wind
            Where the arguments are traced, NaN where a margin is negative.

        Raises
        ------
        ParameterError
            If arguments are concrete and a margin is negative.
        """

    def margins(self, altitude: Altitude, place: Place) -> dict[str, Numeric]:  # noqa: ARG002
        """How far the wind still reaches, for what integrates along a path.

        Parameters
        ----------
        altitude : array, shape (...)
            [m].
        place : Place

        Returns
        -------
        dict of str to array
            By what is beyond the end, in words, the distance to the end: positive where there is
            wind, negative where there is none, in a unit in which ends compare (1 h, 1°, 2 km).
            Empty for a wind without ends, the default.
        """
        return {}

    def _within(self, altitude: Altitude, place: Place, wind: Wind) -> Wind:
        """A wind where there is one: else an error, or NaN where that cannot be known yet."""
        margins = self.margins(altitude, place)
        for beyond, margin in margins.items():
            if not is_traced(margin) and np.any(np.less(margin, 0.0)):
                raise ParameterError(beyond)
        return _where_reached(wind, tuple(margins.values())) if is_traced(margins) else wind

    @abc.abstractmethod
    def describe(self) -> tuple[str, ...]:
        """What is assumed about the wind, in short texts with units."""


@entry_point
def _where_reached(wind: Wind, margins: tuple[Numeric, ...]) -> Wind:
    reached = reduce(jnp.logical_and, [margin >= 0.0 for margin in margins])
    return Wind(*(jnp.where(reached, part, jnp.nan) for part in wind))
