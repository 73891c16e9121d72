r"""Laws of faces in thin gas, as plain functions of plain numbers.

All take arrays that broadcast, in SI units, and are differentiable. The relative temperature
excess of a face is :math:`\theta = (T_h - T_c)/T_c`, which stays exact where face and gas differ by
a millikelvin.
"""

from lightflyer.array.namespace import Array, Numeric, xp


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
    roots = xp.sqrt(1.0 + tac_bottom * excess) + xp.sqrt(1.0 + tac_top * excess)
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
    growth = excess / (xp.sqrt(1.0 + excess) + 1.0)  # √(1 + θ) − 1 without cancellation
    return 0.5 * pressure * area * tac_difference * growth


def in_series(first: Array, second: Array) -> Array:
    """Two conductances in series: zero where either is."""
    return first * second / (first + second)
