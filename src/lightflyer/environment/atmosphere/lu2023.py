"""The paper's atmosphere: a polynomial, for the reproduction of its figures."""

import math
from collections.abc import Sequence
from fractions import Fraction
from typing import Any

from lightflyer.array.namespace import xp
from lightflyer.core import constants
from lightflyer.core.entry_point import entry_point
from lightflyer.core.quantity import Altitude
from lightflyer.environment.atmosphere.base import AbstractAtmosphere
from lightflyer.environment.base import Place
from lightflyer.numerics.horner import polynomial

# Inverse temperature [1/K] as a polynomial in altitude [km], lowest power first. The paper
# prints three digits of each, which is useless above 20 km; these come with the code of
# [Celenza2020].
_INVERSE_TEMPERATURE = (
    3.47312785053852e-3,
    9.91066193190049e-5,
    -2.28247698757490e-5,
    8.15422681932410e-6,
    -1.14955512755429e-6,
    8.52520967699876e-8,
    -3.86235307877923e-9,
    1.14960632799406e-10,
    -2.33217472878003e-12,
    3.27061799378819e-14,
    -3.15169237730408e-16,
    2.02100883624221e-18,
    -7.94159585089666e-21,
    1.49047601370574e-23,
    4.02322550536528e-27,
    -4.59195520629687e-29,
)
_METRES_PER_KILOMETRE = 1000.0
_TOP = 120e3  # the polynomial has a pole at about 125 km
_MIDDLE = 60  # km, from which altitudes are counted: from the ground, nine digits are left of 16


def _from_middle(coefficients: Sequence[Fraction]) -> tuple[float, ...]:
    """Coefficients of the same polynomial in (altitude / middle) − 1; computed without rounding."""
    powers = range(len(coefficients))
    return tuple(
        float(sum(math.comb(power, kept) * coefficients[power] * _MIDDLE**power
                  for power in powers[kept:]))
        for kept in powers
    )  # fmt: skip


_EXACT = [*map(Fraction, _INVERSE_TEMPERATURE)]
_CENTRED = _from_middle(_EXACT)
_INTEGRAL = _from_middle([Fraction(0), *(one / (power + 1) for power, one in enumerate(_EXACT))])


def _place(altitude: Altitude) -> Any:
    return altitude / (_MIDDLE * _METRES_PER_KILOMETRE) - 1.0


class Lu2023Atmosphere(AbstractAtmosphere):
    r"""Polynomial atmosphere of the paper, 0 to 120 km.

    .. math::
        T_c^{-1}(h) = \sum_k a_k h^k, \qquad
        p(h) = p_0 \exp\!\left(-\frac{g}{R}\int_0^h T_c^{-1}\,\mathrm dh\right)

    with the paper's g = 9.8 m/s² and R = 287.05 J/(kg K).

    References
    ----------
    [Lu2023]_ Eqs. (21) and (22), with the factor 1000 that (22) needs; coefficients from
    [Celenza2020]_.

    Examples
    --------
    >>> atmosphere = Lu2023Atmosphere()
    >>> print(f"{atmosphere.temperature(70e3):.4f} K, {atmosphere.pressure(70e3):.5f} Pa")
    220.0640 K, 4.71544 Pa
    """

    @property
    def altitude_range(self) -> tuple[float, float]:
        """0 m to 120 km."""
        return 0.0, _TOP

    def describe(self) -> str:
        return "atmosphere: the polynomial of Lu and others (2023), the same everywhere and always"

    @entry_point
    def temperature(self, altitude: Altitude, place: Place | None = None) -> Any:  # noqa: ARG002
        return self._nan_outside(altitude, 1.0 / polynomial(_CENTRED, _place(altitude)))

    @entry_point
    def pressure(self, altitude: Altitude, place: Place | None = None) -> Any:  # noqa: ARG002
        integral = _METRES_PER_KILOMETRE * polynomial(_INTEGRAL, _place(altitude))
        exponent = constants.GRAVITY_LU2023 / constants.GAS_CONSTANT_LU2023 * integral
        return self._nan_outside(altitude, constants.SEA_LEVEL_PRESSURE * xp.exp(-exponent))

    @entry_point
    def molar_mass_ratio(self, altitude: Altitude, place: Place | None = None) -> Any:  # noqa: ARG002
        """One: the paper's gas does not change with altitude."""
        return xp.ones_like(altitude)
