r"""Drag of bodies in gas so thin that molecules meet the body and not each other.

At a Maxwell wall a share :math:`\alpha` of the molecules leaves at the temperature of the wall, the
rest is reflected specularly. All results are drag coefficients of thin gas,

.. math:: G = \frac{F}{p\,A\,s}, \qquad s = \frac{U}{\sqrt{2RT}},

with the area :math:`A` seen along the motion. They stay finite at zero speed and are even in it.
"""

import math

import numpy as np

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.core.entry_point import entry_point
from lightflyer.numerics.special import erf

_SQRT_PI = math.sqrt(math.pi)
_TERMS = 20
_SERIES_TO = 1.0  # speed ratio below which the sphere's closed form is summed as a series


def _error_function_over(s: Array) -> Array:
    """erf(s)/s, smooth through zero."""
    small = xp.abs(s) < 1e-4  # the next term of the series is s⁴/10
    safe = xp.where(small, 1.0, s)
    return xp.where(small, 2.0 / _SQRT_PI * (1.0 - s**2 / 3.0), erf(safe) / safe)


@entry_point
def broadside_disk(speed_ratio: Numeric, tac: Numeric, root_ratio: Numeric) -> Array:
    """Thin disk that moves along its axis [1]; ``speed_ratio``: :math:`s`, of either sign."""
    # .. math::
    #     G = (2-\alpha)\left[
    #     \frac{2}{\sqrt\pi}e^{-s^2} + (1 + 2s^2)\frac{\mathrm{erf}\,s}{s}\right]
    #         + \alpha\sqrt\pi\,\sqrt{T_w/T}
    #
    # The odd part of the force in the speed. What is left is the force at rest and, for unlike
    # faces, a part that grows as :math:`s^2`, at most :math:`0.14\,|\alpha_b-\alpha_t|\,s` of the
    # drag.
    #
    # Source: [Bird1994]_ ch. 7.
    s = xp.asarray(speed_ratio)
    arriving = 2.0 / _SQRT_PI * xp.exp(-(s**2)) + (1.0 + 2.0 * s**2) * _error_function_over(s)
    return (2.0 - tac) * arriving + tac * _SQRT_PI * root_ratio


@entry_point
def edgewise_disk(tac: Numeric) -> Array:
    """Thin disk that moves in its own plane [1]."""
    # .. math:: G = \frac{2\alpha}{\sqrt\pi}
    return 2.0 / _SQRT_PI * xp.asarray(tac)


@entry_point
def sphere(speed_ratio: Numeric, tac: Numeric, root_ratio: Numeric) -> Array:
    """Sphere of one temperature [1]; ``speed_ratio``: :math:`s`, of either sign."""
    # .. math::
    #     G = \frac{2s^2+1}{\sqrt\pi\,s^2}e^{-s^2} + \frac{4s^4+4s^2-1}{2s^3}\,\mathrm{erf}\,s
    #         + \frac{2\sqrt\pi}{3}\,\alpha\sqrt{T_w/T}
    #
    # Source: [Bird1994]_ ch. 7; at small speed that of [Epstein1924]_.
    s = xp.abs(xp.asarray(speed_ratio))
    slow = s < _SERIES_TO
    square = xp.where(slow, s, 0.0) ** 2
    series = xp.zeros_like(square)
    for coefficient in _SPHERE_SERIES[::-1]:
        series = series * square + coefficient
    fast = xp.where(slow, 1.0, s)
    closed = (2.0 * fast**2 + 1.0) / (_SQRT_PI * fast**2) * xp.exp(-(fast**2)) + (
        4.0 * fast**4 + 4.0 * fast**2 - 1.0
    ) / (2.0 * fast**3) * erf(fast)
    arriving = xp.where(slow, series, closed)
    return arriving + 2.0 * _SQRT_PI / 3.0 * tac * root_ratio


def _sphere_series() -> np.ndarray:
    """Coefficients, in powers of s², of what arrives at a sphere: closed form without 1/s²."""
    found = np.empty(_TERMS)
    for n in range(_TERMS):
        sign, factorial, following = (-1.0) ** n, math.factorial(n), math.factorial(n + 1)
        exponential = 2.0 / factorial - 1.0 / following
        error = 4.0 / (factorial * (2 * n + 1)) + 1.0 / (following * (2 * n + 3))
        if n:
            error = error - (4.0 / (math.factorial(n - 1) * (2 * n - 1)))
        found[n] = sign * (exponential + error) / _SQRT_PI
    return found


_SPHERE_SERIES = _sphere_series()
