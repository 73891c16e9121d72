"""Nitrogen, oxygen, argon and helium: numbers with their sources; and all gases by name.

Another gas is one more such class, listed in :data:`PURE_GASES`.
"""

from typing import ClassVar, NamedTuple

import numpy as np

from lightflyer.array.namespace import Numeric
from lightflyer.gas.air import AIR, LU2023_AIR, US1976_AIR
from lightflyer.gas.base import AbstractGas
from lightflyer.gas.carbon_dioxide import CARBON_DIOXIDE, FROZEN_CARBON_DIOXIDE
from lightflyer.gas.molecules import NITROGEN_ROTATION, OXYGEN_ROTATION, Parker
from lightflyer.gas.reference import (
    DIATOMIC_RATIO,
    GAS_CONSTANT,
    MONATOMIC_HEAT_CAPACITY,
    MONATOMIC_RATIO,
    AbstractReferenceGas,
    Correlations,
    IdealHeatCapacity,
    LemmonJacobsen,
)

_ATOMS = IdealHeatCapacity((MONATOMIC_HEAT_CAPACITY,))


class Nitrogen(AbstractReferenceGas):
    """Nitrogen by reference correlations, in the limit of low density.

    Notes
    -----
    By the source generally right to 2 %.

    References
    ----------
    [LemmonJacobsen2004]_ and, for the heat capacity, [Span2000]_.

    Examples
    --------
    >>> print(f"{NITROGEN.viscosity(300.0):.4e} Pa s, {NITROGEN.conductivity(300.0):.4e} W/(m K)")
    1.7877e-05 Pa s, 2.5936e-02 W/(m K)
    >>> print(f"{NITROGEN.rotational_collision_number(300.0, 0.74):.1f}")
    5.2
    """

    name: ClassVar[str] = "nitrogen"
    molecules: ClassVar[str] = "diatomic"
    rotation: ClassVar[tuple[tuple[float, Parker], ...]] = ((1.0, NITROGEN_ROTATION),)
    transport: ClassVar[LemmonJacobsen] = LemmonJacobsen(
        molar_mass=28.01348,
        diameter=0.3656,
        energy=98.94,
        critical_temperature=126.192,
        of_viscosity=1.511,
        terms=((2.117, 1.0), (-3.332, 0.7)),
    )
    correlations: ClassVar[Correlations] = Correlations(
        transport.viscosity,
        transport.conductivity,
        IdealHeatCapacity(
            polynomial=(3.5, 3.066469e-6, 4.701240e-9, -3.987984e-13),
            vibrations=((1.012941, 3364.011),),
        ),
        ends=(70.0, 1500.0),
    )

    specific_gas_constant: Numeric = GAS_CONSTANT / transport.molar_mass
    heat_capacity_ratio: Numeric = DIATOMIC_RATIO


NITROGEN = Nitrogen()
"""Nitrogen by reference correlations."""


class Oxygen(AbstractReferenceGas):
    """Oxygen by reference correlations, in the limit of low density.

    Notes
    -----
    By the source generally right to 5 %, liquid included. CoolProp and others write the heat
    capacity as this sum of oscillators.

    References
    ----------
    [LemmonJacobsen2004]_ and, for the heat capacity, [SchmidtWagner1985]_.

    Examples
    --------
    >>> print(f"{OXYGEN.viscosity(300.0):.4e} Pa s, {OXYGEN.conductivity(300.0):.4e} W/(m K)")
    2.0631e-05 Pa s, 2.6440e-02 W/(m K)
    """

    name: ClassVar[str] = "oxygen"
    molecules: ClassVar[str] = "diatomic"
    rotation: ClassVar[tuple[tuple[float, Parker], ...]] = ((1.0, OXYGEN_ROTATION),)
    transport: ClassVar[LemmonJacobsen] = LemmonJacobsen(
        molar_mass=31.9988,
        diameter=0.3428,
        energy=118.5,
        critical_temperature=154.581,
        of_viscosity=1.036,
        terms=((6.283, 0.9), (-4.262, 0.6)),
    )
    correlations: ClassVar[Correlations] = Correlations(
        transport.viscosity,
        transport.conductivity,
        IdealHeatCapacity(
            polynomial=(3.51808732,),
            vibrations=(
                (1.02323928, 2246.32440),
                (0.784357918, 11259.9763),
                (0.00337183363, 1201.26209),
                (-0.0170864084, 69.0089445),
                (0.0463751562, 5328.05445),
            ),
        ),
        ends=(70.0, 1500.0),
    )

    specific_gas_constant: Numeric = GAS_CONSTANT / transport.molar_mass
    heat_capacity_ratio: Numeric = DIATOMIC_RATIO


OXYGEN = Oxygen()
"""Oxygen by reference correlations."""


class Argon(AbstractReferenceGas):
    """Argon by reference correlations, in the limit of low density.

    Notes
    -----
    By the source generally right to 2 %. The viscosity is 0.1 % to 0.6 % above that of [May2007]_
    between 200 K and 400 K, who measured it beside helium's to 0.1 %.

    References
    ----------
    [LemmonJacobsen2004]_

    Examples
    --------
    >>> print(f"{ARGON.viscosity(300.0):.4e} Pa s, {ARGON.conductivity(300.0):.4e} W/(m K)")
    2.2724e-05 Pa s, 1.7804e-02 W/(m K)
    """

    name: ClassVar[str] = "argon"
    molecules: ClassVar[str] = "monatomic"
    transport: ClassVar[LemmonJacobsen] = LemmonJacobsen(
        molar_mass=39.948,
        diameter=0.335,
        energy=143.2,
        critical_temperature=150.687,
        of_viscosity=0.8158,
        terms=((-0.4320, 0.77),),
    )
    correlations: ClassVar[Correlations] = Correlations(
        transport.viscosity, transport.conductivity, _ATOMS, ends=(80.0, 1500.0)
    )

    specific_gas_constant: Numeric = GAS_CONSTANT / transport.molar_mass
    heat_capacity_ratio: Numeric = MONATOMIC_RATIO


ARGON = Argon()
"""Argon by reference correlations."""


class McCarty(NamedTuple):
    r"""Viscosity and conductivity by one function of temperature."""

    # .. math:: \frac\mu{\mu_1} = \frac\kappa{\kappa_1} = T^n \exp(A + B/T + C/T^2)
    #
    # Source: [McCarty1972]_ Eqs. (13) and (22).

    molar_mass: float  # [kg/kmol]
    of_viscosity: float  # :math:`\mu_1` [Pa s], :math:`\kappa_1` [W/(m K)]
    of_conductivity: float
    exponent: float  # :math:`n` [1]
    terms: tuple[float, float, float]  # :math:`A` [1], :math:`B` [K], :math:`C` [K²]

    def viscosity(self, temperature: np.ndarray) -> np.ndarray:
        """Dynamic viscosity as published [Pa s] at temperatures [K]."""
        return self.of_viscosity * self._growth(temperature)

    def conductivity(self, temperature: np.ndarray) -> np.ndarray:
        """Thermal conductivity as published [W/(m K)] at temperatures [K]."""
        return self.of_conductivity * self._growth(temperature)

    def _growth(self, temperature: np.ndarray) -> np.ndarray:
        constant, first, second = self.terms
        inverse = 1.0 / temperature
        return temperature**self.exponent * np.exp(constant + inverse * (first + second * inverse))


class Helium(AbstractReferenceGas):
    """Helium by reference correlations, in the limit of low density.

    Notes
    -----
    The source begins at 100 K and, for the conductivity, at 300 K. Beside quantum scattering in the
    potential of [Aziz1987]_ (``studies/gases/helium.py``) viscosity and conductivity are right to
    0.2 % from 80 K to 700 K, and 0.3 % and 1.1 % too low at 1000 K and 1500 K.

    References
    ----------
    [McCarty1972]_ and, for the molar mass, [Prohaska2022]_.

    Examples
    --------
    >>> print(f"{HELIUM.viscosity(300.0):.4e} Pa s, {HELIUM.conductivity(300.0):.4e} W/(m K)")
    1.9926e-05 Pa s, 1.5577e-01 W/(m K)
    """

    name: ClassVar[str] = "helium"
    molecules: ClassVar[str] = "monatomic"
    transport: ClassVar[McCarty] = McCarty(
        molar_mass=4.002602,
        of_viscosity=196e-7,
        of_conductivity=153.220256e-3,
        exponent=0.71938,
        terms=(-4.1249, 12.451, -295.67),
    )
    correlations: ClassVar[Correlations] = Correlations(
        transport.viscosity, transport.conductivity, _ATOMS, ends=(80.0, 1500.0)
    )

    specific_gas_constant: Numeric = GAS_CONSTANT / transport.molar_mass
    heat_capacity_ratio: Numeric = MONATOMIC_RATIO


HELIUM = Helium()
"""Helium by reference correlations."""

PURE_GASES = (NITROGEN, OXYGEN, ARGON, HELIUM)  # Those of this module


AIRS: dict[str, AbstractGas] = {gas.name: gas for gas in (AIR, US1976_AIR, LU2023_AIR)}
"""Those of the Earth."""

CARBON_DIOXIDES: dict[str, AbstractGas] = {
    gas.name: gas for gas in (CARBON_DIOXIDE, FROZEN_CARBON_DIOXIDE)
}
"""Those of Mars."""

GASES: dict[str, AbstractGas] = {**AIRS, **{gas.name: gas for gas in PURE_GASES}, **CARBON_DIOXIDES}
"""All, as a chamber may hold them; a plug-in adds its own."""
