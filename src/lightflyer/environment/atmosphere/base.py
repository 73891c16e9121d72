"""Base class of atmospheres."""

import abc
from typing import Any

import equinox as eqx
import jax.numpy as jnp
from jax import Array

from lightflyer.foundation.types import Numeric


class AbstractAtmosphere(eqx.Module):
    """Temperature, pressure and composition over altitude.

    Methods take altitudes [m] of any shape, work under JAX's transformations and return NaN
    outside :attr:`altitude_range`; environments raise there where the altitude is concrete.
    """

    @property
    @abc.abstractmethod
    def altitude_range(self) -> tuple[float, float]:
        """Lowest and highest geometric altitude described [m]."""

    @abc.abstractmethod
    def temperature(self, altitude: Numeric) -> Any:
        """Kinetic temperature [K]."""

    @abc.abstractmethod
    def pressure(self, altitude: Numeric) -> Any:
        """Pressure [Pa]."""

    @abc.abstractmethod
    def molar_mass_ratio(self, altitude: Numeric) -> Any:
        """Mean molar mass over its value at sea level [1]."""

    def _nan_outside(self, altitude: Numeric, value: Numeric) -> Array:
        lowest, highest = self.altitude_range
        return jnp.where((altitude >= lowest) & (altitude <= highest), value, jnp.nan)
