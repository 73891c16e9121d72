"""Base class of winds."""

import abc
from typing import Any

import equinox as eqx
import numpy as np

from lightflyer.environment.base import Place, Wind
from lightflyer.foundation.types import Numeric


class AbstractWind(eqx.Module):
    """Velocity of the gas over ground, by altitude, place and time. Subclasses are final.

    East and north are those of the place's latitude and longitude. At a pole, too, where the
    longitude says which of the directions away from the pole is meant: together they give one
    velocity, whatever the longitude.
    """

    @abc.abstractmethod
    def velocity(self, altitude: Numeric, place: Place) -> Wind:
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
            NaN outside :meth:`margins` where the arguments are traced.

        Raises
        ------
        ParameterError
            If concrete arguments are outside :meth:`margins`.
        """

    def margins(self, altitude: Numeric, place: Place) -> dict[str, Numeric]:  # noqa: ARG002
        """How far inside its range the wind is, for what integrates along a path.

        Parameters
        ----------
        altitude : array, shape (...)
            [m].
        place : Place

        Returns
        -------
        dict of str to array
            By what ends there, in words, the distance to the end, as a share of the range or so:
            positive inside, negative outside. Empty for a wind without ends, the default.
        """
        return {}

    @abc.abstractmethod
    def describe(self) -> tuple[str, ...]:
        """What is assumed about the wind, in short texts with units."""


def span(values: Any) -> str:
    """A number, or the range of an array, in words.

    Parameters
    ----------
    values : array

    Returns
    -------
    str
    """
    low, high = np.min(values), np.max(values)
    return f"{low:.4g}" if low == high else f"{low:.4g} to {high:.4g}"
