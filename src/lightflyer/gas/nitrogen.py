"""Nitrogen by reference correlations."""

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
    molar_mass=28.01348,
    diameter=0.3656,
    energy=98.94,
    critical_temperature=126.192,
    of_viscosity=1.511,
    terms=((2.117, 1.0), (-3.332, 0.7)),
)

# [Span2000]: heat capacity of the ideal gas over the gas constant: powers of T and the vibration.
_POLYNOMIAL = (3.5, 3.066469e-6, 4.701240e-9, -3.987984e-13)
_VIBRATION, _VIBRATION_TEMPERATURE = 1.012941, 3364.011  # [1], [K]

_RANGE = (70.0, 1500.0)  # [K]


def _heat_capacity(temperature: np.ndarray) -> np.ndarray:
    """Isobaric heat capacity of the ideal gas over its gas constant as published [1]."""
    rigid = np.polynomial.polynomial.polyval(temperature, _POLYNOMIAL)
    return rigid + _VIBRATION * vibration(temperature, _VIBRATION_TEMPERATURE)


class Nitrogen(AbstractReferenceGas):
    """Nitrogen by the reference correlations, in the limit of low density.

    Attributes
    ----------
    specific_gas_constant : array
        Molar gas constant over molar mass [J/(kg K)].
    heat_capacity_ratio : array
        Of translation and rotation, which a wall exchanges [1].

    Notes
    -----
    From 70 K to 1500 K the published formulas are followed to 1e-5. By the source they are
    generally right to 2 %.

    References
    ----------
    [LemmonJacobsen2004]_ and, for the heat capacity, [Span2000]_.

    Examples
    --------
    >>> from lightflyer.gas import NITROGEN
    >>> print(f"{NITROGEN.viscosity(300.0):.4e} Pa s, {NITROGEN.conductivity(300.0):.4e} W/(m K)")
    1.7877e-05 Pa s, 2.5936e-02 W/(m K)
    >>> print(f"{NITROGEN.rotational_collision_number(300.0, 0.74):.1f}")
    5.2
    """

    name: ClassVar[str] = "nitrogen"
    molecules: ClassVar[str] = "diatomic"
    rotation: ClassVar[tuple[tuple[float, Parker], ...]] = ((1.0, relaxation.NITROGEN),)
    correlations: ClassVar[Correlations] = Correlations(
        _TRANSPORT.viscosity, _TRANSPORT.conductivity, _heat_capacity, _RANGE
    )

    specific_gas_constant: Numeric = GAS_CONSTANT / _TRANSPORT.molar_mass
    heat_capacity_ratio: Numeric = DIATOMIC_RATIO


NITROGEN = Nitrogen()
"""Nitrogen by reference correlations."""
