"""Carbon dioxide by reference correlations that hold in the cold of Mars."""

from typing import ClassVar

import numpy as np

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.core.entry_point import entry_point
from lightflyer.core.errors import ParameterError
from lightflyer.core.quantity import Temperature
from lightflyer.core.validity import Looks, Validity
from lightflyer.gas.base import AbstractGas
from lightflyer.gas.reference import BEYOND, GAS_CONSTANT, ChebyshevFit, IdealHeatCapacity

MOLAR_MASS = 44.0098  # Molar mass [kg/kmol]; [SpanWagner1996]_

# [LaeseckeMuzny2017] Eq. (4): viscosity in the limit of zero density, 100 K to 2000 K.
_VISCOSITY_SCALE = 1.0055e-3  # [Pa s / K^(1/2)]
_VISCOSITY = (
    1749.354893188350,
    -369.069300007128,
    5423856.34887691,
    -2.21283852168356,
    -269503.247933569,
    73145.021531826,
    5.34368649509278,
)

# [Huber2016] Eq. (3): conductivity in the limit of zero density.
_CONDUCTIVITY = (0.0151874307, 0.0280674040, 0.0228564190, -0.00741624210)  # [m K/mW]
_REDUCING_TEMPERATURE = 304.1282  # [K]
_MILLIWATT = 1e-3
_COLDEST_CONDUCTIVITY = 150.0  # of the computed values that the source's fit rests on [K]

# [SpanWagner1996] table 27: heat capacity of the ideal gas over the gas constant: of the rigid
# molecule, and weights and reduced temperatures of its vibrations.
_RIGID = 3.5
_VIBRATIONS = (
    (1.99427042, 3.15163),
    (0.62105248, 6.11190),
    (0.41195293, 6.77708),
    (1.04028922, 11.32384),
    (0.08327678, 27.08792),
)

COLDEST, HOTTEST = 100.0, 1100.0
"""Range of the correlations [K]: of the viscosity, and of conductivity and heat capacity."""

_MIDDLE, _DEGREE = 300.0, 12


def reference_viscosity(temperature: np.ndarray) -> np.ndarray:
    """Viscosity of dilute carbon dioxide as published [Pa s]; [LaeseckeMuzny2017]_ Eq. (4)."""
    a0, a1, a2, a3, a4, a5, a6 = _VISCOSITY
    cube_root, root = np.cbrt(temperature), np.sqrt(temperature)
    resistance = a0 + a1 * np.sqrt(cube_root) + a2 * np.exp(a3 * cube_root) + a6 * root
    resistance = resistance + (a4 + a5 * cube_root) * np.exp(-cube_root)
    return _VISCOSITY_SCALE * root / resistance


# Isobaric heat capacity of the ideal gas over its gas constant [1]; [SpanWagner1996] Eq. (6.3)
reference_heat_capacity = IdealHeatCapacity(
    (_RIGID,), tuple((weight, reduced * _REDUCING_TEMPERATURE) for weight, reduced in _VIBRATIONS)
)


def reference_conductivity(temperature: np.ndarray) -> np.ndarray:
    r"""Thermal conductivity of dilute carbon dioxide [W/(m K)]; [Huber2016]_ Eq. (3)."""
    # As published from 150 K. Below, where the published fit has no data and turns up, the Eucken
    # factor :math:`\kappa/(\mu c_v)` of 150 K is kept: between 150 K and 200 K it changes by 1 %.
    published = _published_conductivity(np.maximum(temperature, _COLDEST_CONDUCTIVITY))
    eucken = _viscous_conductivity(temperature) / _viscous_conductivity(
        np.maximum(temperature, _COLDEST_CONDUCTIVITY)
    )
    return published * eucken


def _published_conductivity(temperature: np.ndarray) -> np.ndarray:
    reduced = temperature / _REDUCING_TEMPERATURE
    resistance = np.polynomial.polynomial.polyval(1.0 / reduced, _CONDUCTIVITY)
    return _MILLIWATT * np.sqrt(reduced) / resistance


def _viscous_conductivity(temperature: np.ndarray) -> np.ndarray:
    """Conductivity over gas constant and Eucken factor [kg/(m s)]."""
    return reference_viscosity(temperature) * (reference_heat_capacity(temperature) - 1.0)


_ENDS = (COLDEST, HOTTEST)
# without the root of T, with which it continues beyond the range
_VISCOSITY_FIT = ChebyshevFit.of(
    lambda kelvin: reference_viscosity(kelvin) / np.sqrt(kelvin), _ENDS, _MIDDLE, _DEGREE
)
_HEAT_CAPACITY_FIT = ChebyshevFit.of(reference_heat_capacity, _ENDS, _MIDDLE, _DEGREE)
_EUCKEN_FIT = ChebyshevFit.of(
    lambda kelvin: _published_conductivity(kelvin) / _viscous_conductivity(kelvin),
    (_COLDEST_CONDUCTIVITY, HOTTEST),
    _MIDDLE,
    _DEGREE,
)  # times the gas constant of carbon dioxide [J/(kg K)]


_KNOWN = Validity("the temperature of carbon dioxide", COLDEST, HOTTEST, BEYOND)


class _Correlated(AbstractGas):
    """What both gases share: transport, heat capacity, and where they are known."""

    molecules: ClassVar[str] = "polyatomic"

    @entry_point
    def viscosity(self, temperature: Temperature) -> Array:
        return xp.sqrt(temperature) * _VISCOSITY_FIT(temperature)

    @entry_point
    def viscosity_exponent(self, temperature: Temperature) -> Array:
        return 0.5 + _VISCOSITY_FIT.exponent(temperature)

    @entry_point
    def conductivity(self, temperature: Temperature) -> Array:
        viscous = self.viscosity(temperature) * (_HEAT_CAPACITY_FIT(temperature) - 1.0)
        return _EUCKEN_FIT(temperature) * viscous

    @entry_point
    def heat_capacity(self, temperature: Temperature) -> Array:
        """Isobaric heat capacity of the ideal gas, vibrations included [J/(kg K)]."""
        return self.specific_gas_constant * _HEAT_CAPACITY_FIT(temperature)

    def ranges(self, temperature: Temperature) -> Looks:
        yield _KNOWN, temperature


class CarbonDioxide(_Correlated):  # type: ignore[misc]  # the ratio below is no field
    r"""Carbon dioxide by the reference correlations, in the limit of low density.

    Attributes
    ----------
    specific_gas_constant : array
        Molar gas constant over molar mass [J/(kg K)]. A mixture such as the air of Mars replaces
        it; the correlations stay those of pure carbon dioxide.

    Notes
    -----
    The published formulas are followed to 1e-5 from 100 K to 1100 K; conductivity rests on
    published values from 150 K, see :func:`reference_conductivity`. Beyond, viscosity and
    conductivity grow with the root of the temperature, as those of hard spheres do, and the heat
    capacity stays as it is at the end; :meth:`diagnostics` says so.

    Vibration adds 0.07 of the gas constant to the heat capacity at 130 K and 0.98 at 300 K, so
    that the ratio of heat capacities is a function of temperature and no number:
    :meth:`heat_capacity_ratio_at` instead of a field. Here a wall exchanges vibration as it does
    translation and rotation. How much of it one collision with a wall exchanges is hardly known;
    :class:`FrozenCarbonDioxide`, of which a wall exchanges none, is the other bound.

    References
    ----------
    [LaeseckeMuzny2017]_ (viscosity), [Huber2016]_ (conductivity), [SpanWagner1996]_ (heat
    capacity).

    Examples
    --------
    >>> gas = CARBON_DIOXIDE
    >>> print(f"{gas.viscosity(200.0):.4e} Pa s, {gas.conductivity(200.0):.4e} W/(m K)")
    1.0142e-05 Pa s, 9.5807e-03 W/(m K)
    >>> print(f"{gas.heat_capacity_ratio_at(200.0):.4f}")
    1.3457
    """

    name: ClassVar[str] = "co2"

    def assumptions(self) -> tuple[str, ...]:
        return ("gas: walls exchange all of the vibration of co2 (with gas co2-frozen: none)",)

    specific_gas_constant: Numeric = GAS_CONSTANT / MOLAR_MASS

    @property  # type: ignore[misc]  # in place of a field
    def heat_capacity_ratio(self) -> Numeric:
        """Raises: it is no one number; see :meth:`heat_capacity_ratio_at`."""
        raise ParameterError(
            f"the heat capacity ratio of {self.name} depends on temperature: take "
            "heat_capacity_ratio_at(temperature)"
        )

    @entry_point
    def heat_capacity_ratio_at(self, temperature: Temperature) -> Array:
        """Isobaric over isochoric heat capacity [1] at ``temperature`` [K]."""
        over_constant = _HEAT_CAPACITY_FIT(temperature)
        return over_constant / (over_constant - 1.0)


class FrozenCarbonDioxide(_Correlated):
    """Carbon dioxide whose molecules leave a wall with the vibration that they came with.

    Free molecules then carry heat as a gas of rigid rods does; viscosity, conductivity and heat
    capacity are those of :class:`CarbonDioxide`.

    Attributes
    ----------
    specific_gas_constant : array
        [J/(kg K)].
    heat_capacity_ratio : array
        Of translation and rotation, which a wall exchanges [1].
    """

    name: ClassVar[str] = "co2-frozen"

    def assumptions(self) -> tuple[str, ...]:
        return ("gas: walls exchange none of the vibration of co2 (with gas co2: all)",)

    specific_gas_constant: Numeric = GAS_CONSTANT / MOLAR_MASS
    heat_capacity_ratio: Numeric = _RIGID / (_RIGID - 1.0)


CARBON_DIOXIDE = CarbonDioxide()  # type: ignore[call-arg]
"""Carbon dioxide by reference correlations."""

FROZEN_CARBON_DIOXIDE = FrozenCarbonDioxide()
"""The same, whose vibration a wall does not exchange."""
