"""What a flyer's surroundings are, and what every environment must give."""

import abc
from typing import Any

import equinox as eqx
import jax.numpy as jnp
from jax import Array

from lightflyer.environment.radiation import Radiation
from lightflyer.foundation.types import Numeric
from lightflyer.gas.gas import AbstractGas


class EnvironmentState(eqx.Module):
    """The surroundings at one place, or at many: fields broadcast.

    Attributes
    ----------
    pressure : array, shape (...)
        Gas pressure [Pa].
    temperature : array, shape (...)
        Gas temperature far from the flyer [K].
    gravity : array, shape (...)
        Acceleration of free fall [m/s²].
    gas : AbstractGas
    radiation : Radiation
    wall_distance : array or None
        Distance from the flyer's centre to cold walls around it [m]; None in the open.
    """

    pressure: Numeric
    temperature: Numeric
    gravity: Numeric
    gas: AbstractGas
    radiation: Radiation
    wall_distance: Numeric = None


class AbstractEnvironment(eqx.Module):
    """Somewhere a flyer can be, described along one coordinate.

    Subclasses are immutable and final. On a planet the coordinate is the altitude [m]; in a
    chamber it is the pressure [Pa].
    """

    radiation: eqx.AbstractVar[Radiation]

    @abc.abstractmethod
    def state(self, coordinate: Numeric) -> EnvironmentState:
        """Surroundings at ``coordinate``, an array of any shape."""

    @property
    @abc.abstractmethod
    def coordinate_range(self) -> tuple[float, float]:
        """Lowest and highest coordinate that the environment describes."""


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
