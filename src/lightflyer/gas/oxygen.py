"""Oxygen by reference correlations."""

from typing import ClassVar

import numpy as np

from lightflyer.foundation.types import Numeric
from lightflyer.gas import relaxation
from lightflyer.gas.lemmon_jacobsen import LemmonJacobsen
from lightflyer.gas.reference import (
    DIATOMIC_RATIO,
    GAS_CONSTANT,
    AbstractReferenceGas,
    Correlations,
    vibration,
)
from lightflyer.gas.relaxation import Parker

_TRANSPORT = LemmonJacobsen(
    molar_mass=31.9988,
    diameter=0.3428,
    energy=118.5,
    critical_temperature=154.581,
    of_viscosity=1.036,
    terms=((6.283, 0.9), (-4.262, 0.6)),
)

# [SchmidtWagner1985], whose ideal gas CoolProp and others write as a sum of oscillators: heat
# capacity over the gas constant.
_RIGID = 3.51808732
_OSCILLATORS = (
    (1.02323928, 2246.32440),
    (0.784357918, 11259.9763),
    (0.00337183363, 1201.26209),
    (-0.0170864084, 69.0089445),
    (0.0463751562, 5328.05445),
)  # weights, temperatures [K]

_RANGE = (70.0, 1500.0)  # [K]


def _heat_capacity(temperature: np.ndarray) -> np.ndarray:
    """Isobaric heat capacity of the ideal gas over its gas constant as published [1]."""
    total = np.full_like(temperature, _RIGID)
    for weight, characteristic in _OSCILLATORS:
        total = total + weight * vibration(temperature, characteristic)
    return total


class Oxygen(AbstractReferenceGas):
    """Oxygen by the reference correlations, in the limit of low density.

    Attributes
    ----------
    specific_gas_constant : array
        Molar gas constant over molar mass [J/(kg K)].
    heat_capacity_ratio : array
        Of translation and rotation, which a wall exchanges [1].

    Notes
    -----
    From 70 K to 1500 K the published formulas are followed to 1e-5. By the source they are
    generally right to 5 %, liquid included.

    References
    ----------
    [LemmonJacobsen2004]_ and, for the heat capacity, [SchmidtWagner1985]_.

    Examples
    --------
    >>> from lightflyer.gas import OXYGEN
    >>> print(f"{OXYGEN.viscosity(300.0):.4e} Pa s, {OXYGEN.conductivity(300.0):.4e} W/(m K)")
    2.0631e-05 Pa s, 2.6440e-02 W/(m K)
    """

    name: ClassVar[str] = "oxygen"
    molecules: ClassVar[str] = "diatomic"
    rotation: ClassVar[tuple[tuple[float, Parker], ...]] = ((1.0, relaxation.OXYGEN),)
    correlations: ClassVar[Correlations] = Correlations(
        _TRANSPORT.viscosity, _TRANSPORT.conductivity, _heat_capacity, _RANGE
    )

    specific_gas_constant: Numeric = GAS_CONSTANT / _TRANSPORT.molar_mass
    heat_capacity_ratio: Numeric = DIATOMIC_RATIO


OXYGEN = Oxygen()
"""Oxygen by reference correlations."""
