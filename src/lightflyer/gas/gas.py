"""Gases: transport properties and the lengths and speeds made of them.

A gas is three correlations in temperature and two numbers. Two sets for air are given:
:data:`AIR`, the US Standard Atmosphere's, and :data:`LU2023_AIR`, the paper's, for its
reproduction. A gas of your own is one subclass of :class:`AbstractGas`.
"""

import abc
import math

import equinox as eqx
import jax.numpy as jnp
from jax import Array

from lightflyer.foundation import constants
from lightflyer.foundation.checks import require_positive
from lightflyer.foundation.precision import entry_point
from lightflyer.foundation.types import Numeric


class AbstractGas(eqx.Module):
    """An ideal gas. Every method takes arrays of any shape and is differentiable for T > 0."""

    specific_gas_constant: eqx.AbstractVar[Numeric]
    heat_capacity_ratio: eqx.AbstractVar[Numeric]

    @abc.abstractmethod
    def viscosity(self, temperature: Numeric) -> Array:
        """Dynamic viscosity [Pa s] at ``temperature`` [K]."""

    @abc.abstractmethod
    def conductivity(self, temperature: Numeric) -> Array:
        """Thermal conductivity [W/(m K)] at ``temperature`` [K]."""

    @abc.abstractmethod
    def heat_capacity(self, temperature: Numeric) -> Array:
        """Isobaric specific heat capacity [J/(kg K)] at ``temperature`` [K]."""

    @entry_point
    def density(self, pressure: Numeric, temperature: Numeric) -> Array:
        """Density of the ideal gas [kg/m³] at ``pressure`` [Pa] and ``temperature`` [K]."""
        return pressure / (self.specific_gas_constant * temperature)

    @entry_point
    def mean_speed(self, temperature: Numeric) -> Array:
        r"""Mean molecular speed :math:`\bar v = \sqrt{8RT/\pi}` [m/s]."""
        return jnp.sqrt(8.0 * self.specific_gas_constant * temperature / jnp.pi)


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


@entry_point
def _mean_free_path(pressure: Numeric, temperature: Numeric, gas: AbstractGas) -> Array:
    thermal = jnp.sqrt(jnp.pi * gas.specific_gas_constant * temperature / 2.0)
    return gas.viscosity(temperature) / pressure * thermal


def mean_free_path(pressure: Numeric, temperature: Numeric, gas: AbstractGas = AIR) -> Array:
    r"""Mean free path from viscosity.

    .. math:: \lambda = \frac{\mu}{p}\sqrt{\frac{\pi R T}{2}}

    Parameters
    ----------
    pressure : array, shape (...)
        Gas pressure [Pa].
    temperature : array, shape (...)
        Gas temperature [K].
    gas : AbstractGas
        Default :data:`AIR`.

    Returns
    -------
    array, broadcast shape
        Mean free path [m].

    Raises
    ------
    ParameterError
        If a concrete pressure or temperature is not positive.

    Notes
    -----
    Differentiable for p, T > 0. The US Standard Atmosphere defines another one from a
    collision diameter; see :meth:`US1976.mean_free_path`.

    References
    ----------
    [VincentiKruger1965]_ ch. I.4.

    Examples
    --------
    >>> print(f"{mean_free_path(101325.0, 288.15):.3e} m")
    6.366e-08 m
    """
    require_positive(pressure=pressure, temperature=temperature)
    return _mean_free_path(pressure, temperature, gas)


def knudsen_number(
    pressure: Numeric, temperature: Numeric, radius: Numeric, gas: AbstractGas = AIR
) -> Array:
    r"""Knudsen number of a disk, :math:`\mathrm{Kn} = \lambda/(2r)`.

    Parameters
    ----------
    pressure, temperature : array, shape (...)
        Gas pressure [Pa] and temperature [K].
    radius : array, shape (...)
        Disk radius [m].
    gas : AbstractGas
        Default :data:`AIR`.

    Returns
    -------
    array, broadcast shape
        Knudsen number [1].

    Raises
    ------
    ParameterError
        If a concrete argument is not positive.

    Examples
    --------
    >>> print(f"{knudsen_number(3.446, 215.4, 0.01):.4f}")
    0.0640
    """
    require_positive(radius=radius)
    return mean_free_path(pressure, temperature, gas) / (2.0 * radius)
