"""Base class of atmospheres."""

import abc
from typing import Any

import numpy as np

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.array.records import Module
from lightflyer.core.quantity import Altitude
from lightflyer.environment.base import Place


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
