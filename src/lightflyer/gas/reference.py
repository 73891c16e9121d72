"""Gases that follow published correlations in the limit of low density."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np

from lightflyer.array.namespace import Array, xp
from lightflyer.array.records import AbstractClassVar, ShortRepr
from lightflyer.core import constants
from lightflyer.core.entry_point import entry_point
from lightflyer.core.quantity import Temperature
from lightflyer.core.validity import Looks, Validity
from lightflyer.gas.base import AbstractGas
from lightflyer.gas.chebyshev_fit import ChebyshevFit

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
