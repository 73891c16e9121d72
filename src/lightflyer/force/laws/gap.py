"""Heat through the gas in a narrow gap between two walls, from free molecules to the continuum."""

from lightflyer.array.namespace import Array, Numeric
from lightflyer.force.laws.faces import free_molecular_conductance, in_series


def accommodation_between(first: Numeric, second: Numeric) -> Array:
    r"""Accommodation coefficient that two facing walls have together [1]."""
    # .. math:: \frac1\alpha = \frac1{\alpha_1} + \frac1{\alpha_2} - 1
    #
    # Source: [Springer1971]_; the same as for radiation between grey walls.
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
    r"""Heat through a gas-filled gap per relative temperature difference of its walls [W]."""
    # .. math:: \frac{Q}{\theta} = A\,T\left(\frac{h}{\kappa} + \frac1{G}\right)^{-1}, \qquad
    #     G = \frac18\,\frac{\gamma+1}{\gamma-1}\,\frac{\bar v\,p\,\alpha}{T}
    #
    # which is conduction with a temperature jump at both walls, :math:`\kappa/(h + 2\zeta\lambda)`
    # with :math:`\zeta = \frac{2-\alpha_w}{\alpha_w}\,\frac{2\gamma}{(\gamma+1)\mathrm{Pr}}` for
    # two walls of :math:`\alpha_w`, and exact where the gap is much narrower than the mean free
    # path.
    #
    # Source: [Springer1971]_.
    free = free_molecular_conductance(area, tac, pressure, mean_speed, heat_capacity_ratio)
    return in_series(free, area * conductivity * temperature / gap)
