r"""Laws of faces in thin gas, as plain functions of plain numbers.

All take arrays that broadcast, in SI units, and are differentiable. The relative temperature
excess of a face is :math:`\theta = (T_h - T_c)/T_c`, which stays exact where face and gas differ by
a millikelvin.
"""

import jax.numpy as jnp
from jax import Array

from lightflyer.core.types import Numeric


def free_molecular_conductance(
    area: Numeric,
    tac: Numeric,
    pressure: Numeric,
    mean_speed: Numeric,
    heat_capacity_ratio: Numeric,
) -> Array:
    r"""Free-molecular heat loss per relative temperature excess [W]; [Lu2023]_ Eq. (4)."""
    # .. math:: \frac{Q_\mathrm{fm}}{\theta} =
    #     \frac18\,\frac{\gamma+1}{\gamma-1}\,\bar v\,A\,\alpha\,p
    internal_modes = (heat_capacity_ratio + 1.0) / (heat_capacity_ratio - 1.0)
    return 0.125 * internal_modes * mean_speed * area * tac * pressure


def accommodated_force(
    area: Numeric, tac_top: Numeric, tac_bottom: Numeric, pressure: Numeric, excess: Numeric
) -> Array:
    r"""Free-molecular force where molecules leave each face at one accommodated temperature [N]."""
    # .. math:: F = \frac{pA}{2}\left[\sqrt{1+\alpha_b\theta} - \sqrt{1+\alpha_t\theta}\right]
    #
    # Source: [Lu2023]_ Eq. (19), without its small-difference approximation.
    roots = jnp.sqrt(1.0 + tac_bottom * excess) + jnp.sqrt(1.0 + tac_top * excess)
    # the difference of the roots, written without cancellation
    return 0.5 * pressure * area * (tac_bottom - tac_top) * excess / roots


def linear_force(
    area: Numeric, tac_difference: Numeric, pressure: Numeric, excess: Numeric
) -> Array:
    r"""Free-molecular force to first order in the temperature difference [N]."""
    # .. math:: F = A\,p\,\Delta\alpha\,\frac{\theta}{4}
    #
    # Source: [Lu2023]_ Eq. (19).
    return 0.25 * area * pressure * tac_difference * excess


def maxwell_force(
    area: Numeric, tac_difference: Numeric, pressure: Numeric, excess: Numeric
) -> Array:
    r"""Free-molecular force at Maxwell walls [N]; upward ; exact for any temperature difference."""
    # A wall re-emits the share :math:`\alpha` of the molecules at its own temperature and reflects
    # the rest.
    #
    # .. math:: F = \frac{pA}{2}\,\Delta\alpha\left[\sqrt{1+\theta}-1\right]
    growth = excess / (jnp.sqrt(1.0 + excess) + 1.0)  # √(1 + θ) − 1 without cancellation
    return 0.5 * pressure * area * tac_difference * growth


def normal_accommodation(
    tac: Numeric, tangential: Numeric, rotational: Numeric | None = None
) -> Array:
    r"""Accommodation of the energy of normal motion at a wall of Cercignani and Lampis [1]."""
    # .. math:: \alpha_n = 2\alpha - \sigma_t(2-\sigma_t) + (\alpha - \alpha_r)
    #
    # The wall turns a Maxwellian of the gas's temperature :math:`T_c` that arrives into one with
    # :math:`T_c + \alpha_n\theta T_c` for the normal and :math:`T_c + \sigma_t(2-\sigma_t)\theta
    # T_c` for the tangential velocity. Normal and tangential motion and the rotation of diatomic
    # molecules carry as much energy to it each; rotation is taken to accommodate as the whole does
    # where it is not given. Its free-molecular force is :func:`accommodated_force` with
    # :math:`\alpha_n`.
    #
    # Source: [CercignaniLampis1971]_, [Lord1991]_ with rotation.
    normal = 2.0 * tac - tangential * (2.0 - tangential)
    return jnp.asarray(normal if rotational is None else normal + tac - rotational)


def in_series(first: Array, second: Array) -> Array:
    """Two conductances in series: zero where either is."""
    return first * second / (first + second)
