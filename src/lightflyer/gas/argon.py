"""Argon by reference correlations."""

from typing import ClassVar

from lightflyer.foundation.types import Numeric
from lightflyer.gas.lemmon_jacobsen import LemmonJacobsen
from lightflyer.gas.reference import (
    GAS_CONSTANT,
    MONATOMIC_RATIO,
    AbstractReferenceGas,
    Correlations,
    monatomic_heat_capacity,
)

_TRANSPORT = LemmonJacobsen(
    molar_mass=39.948,
    diameter=0.335,
    energy=143.2,
    critical_temperature=150.687,
    of_viscosity=0.8158,
    terms=((-0.4320, 0.77),),
)

_RANGE = (80.0, 1500.0)  # [K]


class Argon(AbstractReferenceGas):
    """Argon by the reference correlations, in the limit of low density.

    Attributes
    ----------
    specific_gas_constant : array
        Molar gas constant over molar mass [J/(kg K)].
    heat_capacity_ratio : array
        [1].

    Notes
    -----
    From 80 K to 1500 K the published formulas are followed to 1e-5. The viscosity is 0.1 % to 0.6 %
    above that of [May2007]_ between 200 K and 400 K, who measured it beside helium's to 0.1 %. By
    the source both are generally right to 2 %.

    References
    ----------
    [LemmonJacobsen2004]_

    Examples
    --------
    >>> from lightflyer.gas import ARGON
    >>> print(f"{ARGON.viscosity(300.0):.4e} Pa s, {ARGON.conductivity(300.0):.4e} W/(m K)")
    2.2724e-05 Pa s, 1.7804e-02 W/(m K)
    """

    name: ClassVar[str] = "argon"
    molecules: ClassVar[str] = "monatomic"
    correlations: ClassVar[Correlations] = Correlations(
        _TRANSPORT.viscosity, _TRANSPORT.conductivity, monatomic_heat_capacity, _RANGE
    )

    specific_gas_constant: Numeric = GAS_CONSTANT / _TRANSPORT.molar_mass
    heat_capacity_ratio: Numeric = MONATOMIC_RATIO


ARGON = Argon()
"""Argon by reference correlations."""
