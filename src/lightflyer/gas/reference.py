"""Gases that follow published correlations in the limit of low density."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Final, NamedTuple

import numpy as np

from lightflyer.array.memory import kept
from lightflyer.array.namespace import Array, xp
from lightflyer.array.records import AbstractClassVar, ShortRepr
from lightflyer.core import constants
from lightflyer.core.entry_point import entry_point
from lightflyer.core.quantity import Temperature
from lightflyer.core.validity import Looks, Validity
from lightflyer.gas.base import AbstractGas
from lightflyer.numerics.polynomials import polynomial


class ChebyshevFit(NamedTuple):
    """Polynomial in T/(T + middle) that follows a formula."""

    # The formulas have up to seven exponentials and powers; a heat balance, which evaluates them in
    # every step, would take a quarter longer.

    coefficients: tuple[float, ...]  # Lowest power first
    coldest: float  # Range of the formula [K]
    hottest: float  # Range of the formula [K]
    middle: float  # [K]
    slope: tuple[float, ...]  # Coefficients of the polynomial's derivative

    @classmethod
    def of(
        cls,
        formula: Callable[[np.ndarray], np.ndarray],
        ends: tuple[float, float],
        middle: float,
        degree: int,
    ) -> "ChebyshevFit":
        """The polynomial through a formula at Chebyshev's points; ``formula``: of temperatures."""
        domain = np.array(ends)
        fit = np.polynomial.Chebyshev.interpolate(
            lambda share: formula(middle * share / (1.0 - share)),
            degree,
            domain=domain / (domain + middle),
        )
        coefficients = fit.convert(kind=np.polynomial.Polynomial).coef
        slope = np.polynomial.polynomial.polyder(coefficients)
        return cls(tuple(coefficients.tolist()), *ends, middle, tuple(slope.tolist()))

    @kept
    def __call__(self, temperature: Temperature) -> Array:
        """Value at temperatures [K]; beyond the range of the formula its value at the end."""
        within = xp.clip(temperature, self.coldest, self.hottest)
        return polynomial(self.coefficients, within / (within + self.middle))

    def exponent(self, temperature: Temperature) -> Array:
        """Local exponent, d ln(value)/d ln(temperature) [1]; zero beyond the range."""
        share = temperature / (temperature + self.middle)
        growth = polynomial(self.slope, share) / polynomial(self.coefficients, share)
        inside = (temperature >= self.coldest) & (temperature <= self.hottest)
        return xp.where(inside, share * (1.0 - share) * growth, 0.0)


# [LemmonJacobsen2004] Eq. (2): viscosity in the limit of zero density, with the logarithm of the
# collision integral in powers of ln(T/T_e).
_VISCOSITY_SCALE = 0.0266958e-6  # [Pa s nm² (mol/(g K))^(1/2)]
_COLLISION = (0.431, -0.4623, 0.08406, 0.005341, -0.00331)
_MICROPASCAL_SECOND, _MILLIWATT = 1e-6, 1e-3


class LemmonJacobsen(NamedTuple):
    r"""Viscosity and thermal conductivity of a dilute gas.

    .. math::
        \mu &= \frac{0.0266958\sqrt{MT}}{\sigma^2\,\Omega(T^*)}, \qquad
        \ln\Omega = \sum_i b_i \ln^i T^*, \qquad T^* = \frac{T}{\epsilon/k} \\
        \kappa &= N_1 \mu + \sum_i N_i (T/T_c)^{n_i}

    with μPa s, g/mol, nm and mW/(m K).


    References
    ----------
    [LemmonJacobsen2004]_
    """

    molar_mass: float  #: :math:`M` [g/mol]
    diameter: float  #: :math:`\sigma` [nm]
    energy: float  #: :math:`\epsilon/k` [K]
    critical_temperature: float  #: :math:`T_c` [K]
    of_viscosity: float  #: :math:`N_1` [mW/(m K) per μPa s]
    #: :math:`N_i` [mW/(m K)] and :math:`n_i` of the other terms
    terms: tuple[tuple[float, float], ...]

    def viscosity(self, temperature: np.ndarray) -> np.ndarray:
        """Dynamic viscosity as published [Pa s]."""
        logarithm = np.log(temperature / self.energy)
        collision = np.exp(np.polynomial.polynomial.polyval(logarithm, _COLLISION))
        root = np.sqrt(self.molar_mass * temperature)
        return _VISCOSITY_SCALE * root / (self.diameter**2 * collision)

    def conductivity(self, temperature: np.ndarray) -> np.ndarray:
        """Thermal conductivity as published [W/(m K)]."""
        total = self.of_viscosity * self.viscosity(temperature) / _MICROPASCAL_SECOND
        for scale, exponent in self.terms:
            total = total + scale * (temperature / self.critical_temperature) ** exponent
        return _MILLIWATT * total


GAS_CONSTANT: Final = 1e3 * constants.BOLTZMANN * constants.AVOGADRO
"""Molar gas constant [J/(kmol K)]."""

BEYOND: Final = (
    "beyond its correlations transport grows as in a gas of hard spheres, heat capacity not at all"
)
"""What gases do outside the range of their correlations."""

MONATOMIC_HEAT_CAPACITY: Final = 2.5  # Isobaric heat capacity of atoms over the gas constant [1]

DIATOMIC_RATIO, MONATOMIC_RATIO = 7.0 / 5.0, 5.0 / 3.0
"""Ratio of heat capacities with and without rotation [1]."""

Formula = Callable[[np.ndarray], np.ndarray]
"""Of temperatures [K]."""


@dataclass(frozen=True)
class Correlations(ShortRepr):
    """Published formulas of one gas, and the polynomials that follow them."""

    viscosity: Formula  #: Of temperatures [K]; [Pa s]
    conductivity: Formula  #: Of temperatures [K]; [W/(m K)]
    heat_capacity: Formula  #: Isobaric, of the ideal gas, over its gas constant [1]
    ends: tuple[float, float]  #: Range of temperatures [K]

    # Transport is followed without the root of T, with which it continues beyond the range. The
    # polynomials are made when they are first used: few gases are, and a start should be fast.
    @cached_property
    def followed_viscosity(self) -> ChebyshevFit:
        """Of the viscosity over the root of the temperature."""
        return self._fit_formula(lambda kelvin: self.viscosity(kelvin) / np.sqrt(kelvin))

    @cached_property
    def followed_conductivity(self) -> ChebyshevFit:
        """Of the conductivity over the root of the temperature."""
        return self._fit_formula(lambda kelvin: self.conductivity(kelvin) / np.sqrt(kelvin))

    @cached_property
    def followed_heat_capacity(self) -> ChebyshevFit:
        """Of the heat capacity over the gas constant."""
        return self._fit_formula(self.heat_capacity)

    def _fit_formula(self, formula: Formula) -> ChebyshevFit:
        return ChebyshevFit.of(formula, self.ends, _MIDDLE, _DEGREE)


_MIDDLE, _DEGREE = 600.0, 12  # [K]; follow every formula here to 1e-5


class AbstractReferenceGas(AbstractGas):
    """A gas whose transport and heat capacity follow published correlations.

    Beyond their range viscosity and conductivity grow with the root of the temperature, as those of
    hard spheres do, and the heat capacity stays as it is at the end; :meth:`diagnostics` says so.

    Attributes
    ----------
    correlations : Correlations
    """

    correlations: AbstractClassVar[Correlations]

    @entry_point
    def viscosity(self, temperature: Temperature) -> Array:
        return xp.sqrt(temperature) * self.correlations.followed_viscosity(temperature)

    @entry_point
    def viscosity_exponent(self, temperature: Temperature) -> Array:
        return 0.5 + self.correlations.followed_viscosity.exponent(temperature)

    @entry_point
    def conductivity(self, temperature: Temperature) -> Array:
        return xp.sqrt(temperature) * self.correlations.followed_conductivity(temperature)

    @entry_point
    def heat_capacity(self, temperature: Temperature) -> Array:
        """Isobaric heat capacity of the ideal gas, vibrations included [J/(kg K)]."""
        return self.specific_gas_constant * self.correlations.followed_heat_capacity(temperature)

    def ranges(self, temperature: Temperature) -> Looks:
        name = f"the temperature of {self.name}"
        yield Validity(name, *self.correlations.ends, BEYOND), temperature


@dataclass(frozen=True)
class IdealHeatCapacity(ShortRepr):
    """Isobaric heat capacity of an ideal gas over its gas constant, as published."""

    #: Of the rigid molecule, in ascending powers of the temperature [K]
    polynomial: tuple[float, ...]
    #: Weights [1] and temperatures [K] of oscillators
    vibrations: tuple[tuple[float, float], ...] = ()

    def __call__(self, temperature: np.ndarray) -> np.ndarray:
        """Heat capacity [1] at temperatures [K], shape (...)."""
        total = np.polynomial.polynomial.polyval(temperature, self.polynomial)
        for weight, characteristic in self.vibrations:
            # .. math:: \left(\frac{u/2}{\sinh(u/2)}\right)^2, \qquad u = \frac\Theta T
            half = 0.5 * characteristic / temperature
            total = total + weight * (half / np.sinh(half)) ** 2
        return np.asarray(total)
