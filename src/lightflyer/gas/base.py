"""Base class of gases, and the lengths and speeds derived from them.

A gas is three correlations in temperature, two numbers and what its molecules are. A gas of your
own is one file with one subclass of :class:`AbstractGas`.
"""

import abc

import equinox as eqx
import jax.numpy as jnp
from jax import Array

from lightflyer.foundation.checks import require_positive
from lightflyer.foundation.precision import entry_point
from lightflyer.foundation.types import Numeric


class AbstractGas(eqx.Module):
    """An ideal gas. Every method takes arrays of any shape and is differentiable for T > 0.

    Attributes
    ----------
    name : str
        What messages call it.
    molecules : str
        ``"monatomic"``, ``"diatomic"`` or ``"polyatomic"``: which internal motion takes part in
        collisions. Force models that depend on it refuse other gases.
    specific_gas_constant : array
        Molar gas constant over molar mass [J/(kg K)].
    heat_capacity_ratio : array
        Isobaric over isochoric heat capacity [1]. A gas in which it depends on temperature has
        none; laws take :meth:`heat_capacity_ratio_at`.
    """

    name: eqx.AbstractClassVar[str]
    molecules: eqx.AbstractClassVar[str]
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

    def heat_capacity_ratio_at(self, temperature: Numeric) -> Numeric:
        """Ratio of heat capacities [1] at ``temperature`` [K]; by default the same at any.

        For free molecules between a gas and a wall take it at the mean of the two temperatures;
        in carbon dioxide between 140 K and 260 K their heat is then right to 0.3 %.
        """
        del temperature
        return self.heat_capacity_ratio

    def assumptions(self) -> tuple[str, ...]:
        """What is assumed about the gas, in short texts.

        Returns
        -------
        tuple of str
            Empty by default.
        """
        return ()

    def caveats(self, temperature: Numeric, pressure: Numeric) -> tuple[str, ...]:
        """Warnings, in words, where the gas is outside the range in which it is known.

        Parameters
        ----------
        temperature, pressure : array, shape (...)
            Of the gas somewhere, concrete [K], [Pa].

        Returns
        -------
        tuple of str
            Empty by default.
        """
        del temperature, pressure
        return ()

    @entry_point
    def density(self, pressure: Numeric, temperature: Numeric) -> Array:
        """Density of the ideal gas [kg/m³] at ``pressure`` [Pa] and ``temperature`` [K]."""
        return pressure / (self.specific_gas_constant * temperature)

    @entry_point
    def mean_speed(self, temperature: Numeric) -> Array:
        r"""Mean molecular speed :math:`\bar v = \sqrt{8RT/\pi}` [m/s]."""
        return jnp.sqrt(8.0 * self.specific_gas_constant * temperature / jnp.pi)


@entry_point
def _mean_free_path(pressure: Numeric, temperature: Numeric, gas: AbstractGas) -> Array:
    thermal = jnp.sqrt(jnp.pi * gas.specific_gas_constant * temperature / 2.0)
    return gas.viscosity(temperature) / pressure * thermal


def mean_free_path(pressure: Numeric, temperature: Numeric, gas: AbstractGas) -> Array:
    r"""Mean free path from viscosity.

    .. math:: \lambda = \frac{\mu}{p}\sqrt{\frac{\pi R T}{2}}

    Parameters
    ----------
    pressure : array, shape (...)
        Gas pressure [Pa].
    temperature : array, shape (...)
        Gas temperature [K].
    gas : AbstractGas

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
    >>> from lightflyer.gas import AIR
    >>> print(f"{mean_free_path(101325.0, 288.15, AIR):.3e} m")
    6.384e-08 m
    """
    require_positive(pressure=pressure, temperature=temperature)
    return _mean_free_path(pressure, temperature, gas)


def knudsen_number(
    pressure: Numeric, temperature: Numeric, radius: Numeric, gas: AbstractGas
) -> Array:
    r"""Knudsen number of a disk, :math:`\mathrm{Kn} = \lambda/(2r)`.

    Parameters
    ----------
    pressure, temperature : array, shape (...)
        Gas pressure [Pa] and temperature [K].
    radius : array, shape (...)
        Disk radius [m].
    gas : AbstractGas

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
    >>> from lightflyer.gas import AIR
    >>> print(f"{knudsen_number(3.446, 215.4, 0.01, AIR):.4f}")
    0.0641
    """
    require_positive(pressure=pressure, temperature=temperature, radius=radius)
    return _knudsen_number(pressure, temperature, radius, gas)


@entry_point
def _knudsen_number(
    pressure: Numeric, temperature: Numeric, radius: Numeric, gas: AbstractGas
) -> Array:
    return _mean_free_path(pressure, temperature, gas) / (2.0 * radius)
