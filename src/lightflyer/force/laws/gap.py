"""Heat through the gas in a narrow gap between two walls, from free molecules to the continuum."""

from jax import Array

from lightflyer.core.types import Numeric
from lightflyer.force.laws.faces import free_molecular_conductance, in_series


def accommodation_between(first: Numeric, second: Numeric) -> Array:
    r"""Accommodation coefficient that two facing walls have together.

    .. math:: \frac1\alpha = \frac1{\alpha_1} + \frac1{\alpha_2} - 1

    Parameters
    ----------
    first, second : array, shape (...)
        Thermal accommodation coefficients [1].

    Returns
    -------
    array, broadcast shape
        [1].

    References
    ----------
    [Springer1971]_; the same as for radiation between grey walls.
    """
    return first * second / (first + second - first * second)


def gap_conductance(
    area: Numeric,
    gap: Numeric,
    tac: Numeric,
    *,
    pressure: Numeric,
    temperature: Numeric,
    mean_speed: Numeric,
    heat_capacity_ratio: Numeric,
    conductivity: Numeric,
) -> Array:
    r"""Heat through a gas-filled gap per relative temperature difference of its walls.

    .. math:: \frac{Q}{\theta} = A\,T\left(\frac{h}{\kappa} + \frac1{G}\right)^{-1}, \qquad
        G = \frac18\,\frac{\gamma+1}{\gamma-1}\,\frac{\bar v\,p\,\alpha}{T}

    which is conduction with a temperature jump at both walls,
    :math:`\kappa/(h + 2\zeta\lambda)` with
    :math:`\zeta = \frac{2-\alpha_w}{\alpha_w}\,\frac{2\gamma}{(\gamma+1)\mathrm{Pr}}` for two
    walls of :math:`\alpha_w`, and exact where the gap is much narrower than the mean free path.

    Parameters
    ----------
    area : array, shape (...)
        Of each wall [m²].
    gap : array, shape (...)
        Distance of the walls [m].
    tac : array, shape (...)
        Of both walls together, :func:`accommodation_between` [1].
    pressure, temperature : array, shape (...)
        Of the gas [Pa], [K].
    mean_speed : array, shape (...)
        Of the molecules at that temperature [m/s].
    heat_capacity_ratio : array, shape (...)
        [1].
    conductivity : array, shape (...)
        Of the gas at that temperature [W/(m K)].

    Returns
    -------
    array, broadcast shape
        [W].

    References
    ----------
    [Springer1971]_
    """
    free = free_molecular_conductance(area, tac, pressure, mean_speed, heat_capacity_ratio)
    return in_series(free, area * conductivity * temperature / gap)
