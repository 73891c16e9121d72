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
    r"""Free-molecular heat loss per relative temperature excess.

    .. math:: \frac{Q_\mathrm{fm}}{\theta} =
        \frac18\,\frac{\gamma+1}{\gamma-1}\,\bar v\,A\,\alpha\,p

    Parameters
    ----------
    area : array, shape (...)
        Area in contact with the gas; both faces of a film count [m²].
    tac : array, shape (...)
        Thermal accommodation coefficient, the mean of several faces [1].
    pressure : array, shape (...)
        [Pa].
    mean_speed : array, shape (...)
        :math:`\bar v = \sqrt{8RT_c/\pi}` [m/s].
    heat_capacity_ratio : array, shape (...)
        :math:`\gamma` [1].

    Returns
    -------
    array, broadcast shape
        [W]; exact for any temperature difference.

    References
    ----------
    [Lu2023]_ Eq. (4).
    """
    internal_modes = (heat_capacity_ratio + 1.0) / (heat_capacity_ratio - 1.0)
    return 0.125 * internal_modes * mean_speed * area * tac * pressure


def accommodated_force(
    area: Numeric, tac_top: Numeric, tac_bottom: Numeric, pressure: Numeric, excess: Numeric
) -> Array:
    r"""Free-molecular force where molecules leave each face at one accommodated temperature.

    .. math:: F = \frac{pA}{2}\left[\sqrt{1+\alpha_b\theta} - \sqrt{1+\alpha_t\theta}\right]

    Parameters
    ----------
    area : array, shape (...)
        Area of one face [m²].
    tac_top, tac_bottom : array, shape (...)
        Thermal accommodation coefficients [1].
    pressure : array, shape (...)
        [Pa].
    excess : array, shape (...)
        Relative temperature excess [1].

    Returns
    -------
    array, broadcast shape
        Upward [N].

    References
    ----------
    [Lu2023]_ Eq. (19), without its small-difference approximation.
    """
    roots = jnp.sqrt(1.0 + tac_bottom * excess) + jnp.sqrt(1.0 + tac_top * excess)
    # the difference of the roots, written without cancellation
    return 0.5 * pressure * area * (tac_bottom - tac_top) * excess / roots


def linear_force(
    area: Numeric, tac_difference: Numeric, pressure: Numeric, excess: Numeric
) -> Array:
    r"""Free-molecular force to first order in the temperature difference.

    .. math:: F = A\,p\,\Delta\alpha\,\frac{\theta}{4}

    Parameters
    ----------
    area : array, shape (...)
        Area of one face [m²].
    tac_difference : array, shape (...)
        Bottom minus top [1].
    pressure : array, shape (...)
        [Pa].
    excess : array, shape (...)
        Relative temperature excess [1].

    Returns
    -------
    array, broadcast shape
        Upward [N]; 20 % too large at an excess of 0.57 and 40 % at 1.2.

    References
    ----------
    [Lu2023]_ Eq. (19).
    """
    return 0.25 * area * pressure * tac_difference * excess


def maxwell_force(
    area: Numeric, tac_difference: Numeric, pressure: Numeric, excess: Numeric
) -> Array:
    r"""Free-molecular force at Maxwell walls.

    A wall re-emits the share :math:`\alpha` of the molecules at its own temperature and reflects
    the rest.

    .. math:: F = \frac{pA}{2}\,\Delta\alpha\left[\sqrt{1+\theta}-1\right]

    Parameters
    ----------
    area : array, shape (...)
        Area of one face [m²].
    tac_difference : array, shape (...)
        Bottom minus top [1].
    pressure : array, shape (...)
        [Pa].
    excess : array, shape (...)
        Relative temperature excess [1].

    Returns
    -------
    array, broadcast shape
        Upward [N]; exact for any temperature difference.
    """
    growth = excess / (jnp.sqrt(1.0 + excess) + 1.0)  # √(1 + θ) − 1 without cancellation
    return 0.5 * pressure * area * tac_difference * growth


def normal_accommodation(tac: Numeric, tangential: Numeric) -> Array:
    r"""Accommodation of the energy of normal motion at a wall of Cercignani and Lampis.

    .. math:: \alpha_n = 2\alpha - \sigma_t(2-\sigma_t)

    The wall turns a Maxwellian of the gas's temperature :math:`T_c` that arrives into one with
    :math:`T_c + \alpha_n\theta T_c` for the normal and
    :math:`T_c + \sigma_t(2-\sigma_t)\theta T_c` for the tangential velocity. Normal and tangential
    motion carry as much energy to it, and rotation is taken to accommodate as both together do.
    Its free-molecular force is :func:`accommodated_force` with :math:`\alpha_n`.

    Parameters
    ----------
    tac : array, shape (...)
        Thermal accommodation coefficient :math:`\alpha`, that of all energy [1].
    tangential : array, shape (...)
        Accommodation coefficient of tangential momentum :math:`\sigma_t` [1].

    Returns
    -------
    array, broadcast shape
        [1]; outside 0 to 1 no such wall exists.

    References
    ----------
    [CercignaniLampis1971]_, [Lord1991]_ with rotation.
    """
    return jnp.asarray(2.0 * tac - tangential * (2.0 - tangential))


def in_series(first: Array, second: Array) -> Array:
    """Two conductances in series: zero where either is.

    Parameters
    ----------
    first, second : array, shape (...)
        Of one unit; not both zero.

    Returns
    -------
    array, broadcast shape
    """
    return first * second / (first + second)
