"""Air: as in the US Standard Atmosphere 1976, and as in the paper."""

import math
from typing import ClassVar

import jax.numpy as jnp
from jax import Array

from lightflyer.foundation import constants
from lightflyer.foundation.precision import entry_point
from lightflyer.foundation.types import Numeric
from lightflyer.gas.base import AbstractGas


def _power(base: Numeric, exponent: float, unit: float = 1.0) -> Array:
    """``(base / unit) ** exponent`` for positive bases.

    Written so that the compiler shares one logarithm among the powers of a temperature and the
    derivative reuses the value: powers are most of what a heat balance costs.
    """
    return jnp.exp(exponent * (jnp.log(base) - math.log(unit)))


class Air(AbstractGas):
    r"""Air with the transport properties of the US Standard Atmosphere 1976.

    .. math::
        \mu = \frac{\beta T^{3/2}}{T + S}, \qquad
        \kappa = \frac{2.64638\cdot10^{-3}\, T^{3/2}}{T + 245.4\cdot10^{-12/T}}, \qquad
        c_p = \frac{\gamma}{\gamma-1} R

    Attributes
    ----------
    specific_gas_constant : array
        Molar gas constant over molar mass [J/(kg K)]. An atmosphere whose composition changes
        with altitude replaces it.
    heat_capacity_ratio : array
        :math:`\gamma` [1].

    References
    ----------
    [USSA1976]_ Eqs. (51) and (53).
    """

    name: ClassVar[str] = "air"
    molecules: ClassVar[str] = "diatomic"

    specific_gas_constant: Numeric = constants.GAS_CONSTANT_US1976 / constants.MOLAR_MASS_AIR
    heat_capacity_ratio: Numeric = 1.4

    @entry_point
    def viscosity(self, temperature: Numeric) -> Array:
        """Dynamic viscosity [Pa s]; the standard gives it for 100 K to 1900 K."""
        beta, sutherland = 1.458e-6, 110.4
        return beta * temperature * jnp.sqrt(temperature) / (temperature + sutherland)

    @entry_point
    def conductivity(self, temperature: Numeric) -> Array:
        """Thermal conductivity [W/(m K)]; the standard gives it for 100 K to 1900 K."""
        scale, offset, decades = 2.64638e-3, 245.4, 12.0
        correction = offset * jnp.exp(-decades * jnp.log(10.0) / temperature)
        return scale * temperature * jnp.sqrt(temperature) / (temperature + correction)

    @entry_point
    def heat_capacity(self, temperature: Numeric) -> Array:
        """Isobaric heat capacity of a perfect diatomic gas [J/(kg K)]."""
        ratio = self.heat_capacity_ratio
        return ratio / (ratio - 1.0) * self.specific_gas_constant + jnp.zeros_like(temperature)


class Lu2023Air(AbstractGas):
    r"""Air with the correlations of the paper, for its reproduction.

    .. math::
        \mu = 1.716\cdot10^{-5} (T/273)^{2/3}, \qquad \kappa = 2.38\cdot10^{-4}\, T^{0.8218}

    and a cubic for :math:`c_p`, whose printed quadratic coefficient is off by ten (see the
    errata).

    References
    ----------
    [Lu2023]_ Eqs. (11)-(13).
    """

    name: ClassVar[str] = "lu2023-air"
    molecules: ClassVar[str] = "diatomic"

    specific_gas_constant: Numeric = constants.GAS_CONSTANT_LU2023
    heat_capacity_ratio: Numeric = 1.4

    @entry_point
    def viscosity(self, temperature: Numeric) -> Array:
        """Dynamic viscosity [Pa s], [Lu2023]_ Eq. (11)."""
        reference, reference_temperature, exponent = 1.716e-5, 273.0, 2.0 / 3.0
        return reference * _power(temperature, exponent, reference_temperature)

    @entry_point
    def conductivity(self, temperature: Numeric) -> Array:
        """Thermal conductivity [W/(m K)], [Lu2023]_ Eq. (12)."""
        scale, exponent = 2.38e-4, 0.8218
        return scale * _power(temperature, exponent)

    @entry_point
    def heat_capacity(self, temperature: Numeric) -> Array:
        """Isobaric heat capacity [J/(kg K)], [Lu2023]_ Eq. (13), corrected."""
        c0, c1, c2, c3 = 28.11, 1.967e-3, 4.802e-6, -1.966e-9  # J/(mol K), powers of T
        grams_per_kilogram, molar_mass = 1000.0, 28.97
        molar = c0 + temperature * (c1 + temperature * (c2 + temperature * c3))
        return molar * grams_per_kilogram / molar_mass


AIR = Air()
"""Air as in the US Standard Atmosphere 1976: the package's default gas."""

LU2023_AIR = Lu2023Air()
"""Air as in the paper."""

GASES: dict[str, AbstractGas] = {gas.name: gas for gas in (AIR, LU2023_AIR)}
"""Gases by the name they have in a flyer file."""
