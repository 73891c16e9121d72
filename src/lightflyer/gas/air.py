"""Air: by reference correlations, as in the US Standard Atmosphere 1976, and as in the paper."""

import math
from typing import ClassVar

import numpy as np

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.core import constants
from lightflyer.core.entry_point import entry_point
from lightflyer.core.quantity import Temperature
from lightflyer.gas.base import AbstractGas
from lightflyer.gas.molecules import NITROGEN_ROTATION, OXYGEN_ROTATION, Parker
from lightflyer.gas.reference import (
    DIATOMIC_RATIO,
    AbstractReferenceGas,
    Correlations,
    IdealHeatCapacity,
    LemmonJacobsen,
)


def _power(base: Numeric, exponent: float, unit: float = 1.0) -> Array:
    """``(base / unit) ** exponent`` for positive bases."""
    # Written so that the compiler shares one logarithm among the powers of a temperature and the
    # derivative reuses the value: powers are most of what a heat balance costs.
    return xp.exp(exponent * (xp.log(base) - math.log(unit)))


_TRANSPORT = LemmonJacobsen(
    molar_mass=28.9586,
    diameter=0.360,
    energy=103.3,
    critical_temperature=132.6312,
    of_viscosity=1.308,
    terms=((1.405, 1.1), (-1.036, 0.3)),
)

# [Lemmon2000]: heat capacity of ideal air over the gas constant: powers of T, a root, vibrations of
# nitrogen and oxygen, and higher states.
_SMOOTH = IdealHeatCapacity(
    polynomial=(3.490888032, 2.395525583e-6, 7.172111248e-9, -3.115413101e-13),
    vibrations=((0.791309509, 3364.011), (0.212236768, 2242.45)),
)
_ROOT = 0.223806688  # of T^-1.5
_HIGHER, _HIGHER_TEMPERATURE, _HIGHER_RATIO = 0.197938904, 11580.4, 2.0 / 3.0

_RANGE = (60.0, 2000.0)  # of both sources [K]
_NITROGEN, _OXYGEN = 0.78084, 0.20948  # mole fractions [USSA1976]


def _heat_capacity(temperature: np.ndarray) -> np.ndarray:
    """Isobaric heat capacity of ideal air over its gas constant as published [1]."""
    total = _SMOOTH(temperature) + _ROOT / temperature**1.5
    ratio = _HIGHER_TEMPERATURE / temperature
    share = _HIGHER_RATIO * np.exp(-ratio)
    return total + _HIGHER * ratio**2 * share / (1.0 + share) ** 2


class AbstractAir(AbstractGas):
    """Air, by whatever correlations: what models made for air alone are for."""

    molecules: ClassVar[str] = "diatomic"
    rotation: ClassVar[tuple[tuple[float, Parker], ...]] = (
        (_NITROGEN, NITROGEN_ROTATION),
        (_OXYGEN, OXYGEN_ROTATION),
    )


class Air(AbstractAir, AbstractReferenceGas):
    r"""Air by the reference correlations, in the limit of low density.

    Viscosity and conductivity are :class:`~lightflyer.gas.reference.LemmonJacobsen`'s, the
    heat capacity is that of the ideal gas with its vibrations.

    Attributes
    ----------
    specific_gas_constant : array
        Molar gas constant over molar mass [J/(kg K)]. An atmosphere whose composition changes
        with altitude replaces it; the correlations stay those of air at sea level.
    heat_capacity_ratio : array
        :math:`\gamma` [1] of the motion that collisions with a wall share: translation and
        rotation, without the vibrations that :meth:`heat_capacity` contains. The free-molecular
        laws take this one, the continuum's limits :meth:`heat_capacity`.

    Notes
    -----
    The sources hold from 60 K to 2000 K; there the published formulas are followed to 1e-5. Beyond,
    viscosity and conductivity grow with the root of the temperature, as those of hard spheres do,
    and the heat capacity stays as it is at the end; :meth:`diagnostics` says so.

    The rotation of its nitrogen and its oxygen relaxes at the mean of their rates.

    References
    ----------
    [LemmonJacobsen2004]_ and, for the heat capacity, [Lemmon2000]_.

    Examples
    --------
    >>> print(f"{AIR.viscosity(300.0):.4e} Pa s, {AIR.conductivity(300.0):.4e} W/(m K)")
    1.8523e-05 Pa s, 2.6353e-02 W/(m K)
    """

    name: ClassVar[str] = "air"
    correlations: ClassVar[Correlations] = Correlations(
        _TRANSPORT.viscosity, _TRANSPORT.conductivity, _heat_capacity, _RANGE
    )

    specific_gas_constant: Numeric = constants.GAS_CONSTANT_US1976 / constants.MOLAR_MASS_AIR
    heat_capacity_ratio: Numeric = DIATOMIC_RATIO


_SUTHERLAND = 110.4  # [K], of the standard
_LU2023_EXPONENT = 2.0 / 3.0  # of the viscosity


class US1976Air(AbstractAir):
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

    Notes
    -----
    Against :class:`Air` the viscosity is 4 % too low at 1000 K, the heat capacity 2.4 % at 500 K.

    References
    ----------
    [USSA1976]_ Eqs. (51) and (53).
    """

    name: ClassVar[str] = "us1976-air"

    specific_gas_constant: Numeric = constants.GAS_CONSTANT_US1976 / constants.MOLAR_MASS_AIR
    heat_capacity_ratio: Numeric = DIATOMIC_RATIO

    @entry_point
    def viscosity(self, temperature: Temperature) -> Array:
        """Dynamic viscosity [Pa s]; the standard gives it for 100 K to 1900 K."""
        beta = 1.458e-6
        return beta * temperature * xp.sqrt(temperature) / (temperature + _SUTHERLAND)

    @entry_point
    def viscosity_exponent(self, temperature: Temperature) -> Array:
        return 1.5 - temperature / (temperature + _SUTHERLAND)

    @entry_point
    def conductivity(self, temperature: Temperature) -> Array:
        """Thermal conductivity [W/(m K)]; the standard gives it for 100 K to 1900 K."""
        scale, offset, decades = 2.64638e-3, 245.4, 12.0
        correction = offset * xp.exp(-decades * xp.log(10.0) / temperature)
        return scale * temperature * xp.sqrt(temperature) / (temperature + correction)

    @entry_point
    def heat_capacity(self, temperature: Temperature) -> Array:
        """Isobaric heat capacity of a perfect diatomic gas [J/(kg K)]."""
        ratio = self.heat_capacity_ratio
        return ratio / (ratio - 1.0) * self.specific_gas_constant + xp.zeros_like(temperature)


class Lu2023Air(AbstractAir):
    r"""Air with the correlations of the paper, for its reproduction.

    .. math::
        \mu = 1.716\cdot10^{-5} (T/273)^{2/3}, \qquad \kappa = 2.38\cdot10^{-4}\, T^{0.8218}

    and a cubic for :math:`c_p`, whose printed quadratic coefficient is off by ten (see the
    errata).

    References
    ----------
    [Lu2023]_ Eqs. (11)-(13).
    """

    name: ClassVar[str] = "lu2023-air"

    specific_gas_constant: Numeric = constants.GAS_CONSTANT_LU2023
    heat_capacity_ratio: Numeric = DIATOMIC_RATIO

    @entry_point
    def viscosity(self, temperature: Temperature) -> Array:
        """Dynamic viscosity [Pa s], [Lu2023]_ Eq. (11)."""
        reference, reference_temperature = 1.716e-5, 273.0
        return reference * _power(temperature, _LU2023_EXPONENT, reference_temperature)

    @entry_point
    def viscosity_exponent(self, temperature: Temperature) -> Array:
        return _LU2023_EXPONENT + xp.zeros_like(temperature)

    @entry_point
    def conductivity(self, temperature: Temperature) -> Array:
        """Thermal conductivity [W/(m K)], [Lu2023]_ Eq. (12)."""
        scale, exponent = 2.38e-4, 0.8218
        return scale * _power(temperature, exponent)

    @entry_point
    def heat_capacity(self, temperature: Temperature) -> Array:
        """Isobaric heat capacity [J/(kg K)], [Lu2023]_ Eq. (13), corrected."""
        c0, c1, c2, c3 = 28.11, 1.967e-3, 4.802e-6, -1.966e-9  # J/(mol K), powers of T
        grams_per_kilogram, molar_mass = 1000.0, 28.97
        molar = c0 + temperature * (c1 + temperature * (c2 + temperature * c3))
        return molar * grams_per_kilogram / molar_mass


AIR = Air()
"""Air by reference correlations: the package's default gas."""

US1976_AIR = US1976Air()
"""Air as in the US Standard Atmosphere 1976."""

LU2023_AIR = Lu2023Air()
"""Air as in the paper."""
