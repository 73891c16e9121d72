"""Numbers on which drag depends: speed ratio, rarefaction, Reynolds number."""

import jax.numpy as jnp
from jax import Array

from lightflyer.foundation.types import Numeric
from lightflyer.gas.base import AbstractGas


def molecular_speed(temperature: Numeric, gas: AbstractGas) -> Array:
    r"""Most probable speed of molecules, :math:`\sqrt{2RT}`.

    Parameters
    ----------
    temperature : array, shape (...)
        [K].
    gas : AbstractGas

    Returns
    -------
    array, shape (...)
        [m/s].
    """
    return jnp.sqrt(2.0 * gas.specific_gas_constant * jnp.asarray(temperature))


def rarefaction(
    pressure: Numeric, temperature: Numeric, radius: Numeric, gas: AbstractGas
) -> Array:
    r"""Rarefaction parameter, :math:`\delta = p\,r/(\mu\sqrt{2RT}) = \sqrt\pi/(4\,\mathrm{Kn})`.

    Parameters
    ----------
    pressure, temperature : array, shape (...)
        Of the gas far away [Pa], [K].
    radius : array, shape (...)
        [m].
    gas : AbstractGas

    Returns
    -------
    array, broadcast shape
        [1].
    """
    return pressure * radius / (gas.viscosity(temperature) * molecular_speed(temperature, gas))


def reynolds_number(speed_ratio: Numeric, rarefaction: Numeric) -> Array:
    r"""Reynolds number by the diameter, :math:`2\rho U r/\mu = 4\,|s|\,\delta`.

    Parameters
    ----------
    speed_ratio, rarefaction : array, shape (...)
        :math:`U/\sqrt{2RT}` and :math:`\delta` [1].

    Returns
    -------
    array, broadcast shape
        [1].
    """
    return 4.0 * jnp.abs(jnp.asarray(speed_ratio)) * rarefaction
