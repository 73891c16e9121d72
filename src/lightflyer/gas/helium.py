"""Helium by reference correlations."""

from typing import ClassVar

import numpy as np

from lightflyer.foundation.types import Numeric
from lightflyer.gas.reference import (
    GAS_CONSTANT,
    MONATOMIC_RATIO,
    AbstractReferenceGas,
    Correlations,
    monatomic_heat_capacity,
)

MOLAR_MASS = 4.002602
"""Molar mass [kg/kmol]; [Prohaska2022]_."""

# [McCarty1972] Eqs. (13) and (22): one function of temperature for both.
_VISCOSITY, _CONDUCTIVITY = 196e-7, 153.220256e-3  # [Pa s], [W/(m K)]
_EXPONENT, _INVERSE, _INVERSE_SQUARE, _CONSTANT = 0.71938, 12.451, -295.67, -4.1249

_RANGE = (80.0, 1500.0)  # [K]


def _growth(temperature: np.ndarray) -> np.ndarray:
    inverse = 1.0 / temperature
    exponent = _CONSTANT + inverse * (_INVERSE + _INVERSE_SQUARE * inverse)
    return temperature**_EXPONENT * np.exp(exponent)


def _viscosity(temperature: np.ndarray) -> np.ndarray:
    """Dynamic viscosity as published [Pa s]."""
    return _VISCOSITY * _growth(temperature)


def _conductivity(temperature: np.ndarray) -> np.ndarray:
    """Thermal conductivity as published [W/(m K)]."""
    return _CONDUCTIVITY * _growth(temperature)


class Helium(AbstractReferenceGas):
    r"""Helium in the limit of low density.

    .. math::
        \frac{\mu}{19.6\,\mathrm{\mu Pa\,s}} = \frac{\kappa}{0.15322\,\mathrm{W/(m\,K)}}
            = T^{0.71938}\exp\left(\frac{12.451}T - \frac{295.67}{T^2} - 4.1249\right)

    Attributes
    ----------
    specific_gas_constant : array
        Molar gas constant over molar mass [J/(kg K)].
    heat_capacity_ratio : array
        [1].

    Notes
    -----
    From 80 K to 1500 K the published formulas are followed to 1e-5. The source's begin at 100 K
    and, for the conductivity, at 300 K. Beside quantum scattering in the potential of [Aziz1987]_
    (``studies/gases/helium.py``) viscosity and conductivity are right to 0.2 % from 80 K to 700 K,
    and 0.3 % and 1.1 % too low at 1000 K and 1500 K.

    References
    ----------
    [McCarty1972]_

    Examples
    --------
    >>> from lightflyer.gas import HELIUM
    >>> print(f"{HELIUM.viscosity(300.0):.4e} Pa s, {HELIUM.conductivity(300.0):.4e} W/(m K)")
    1.9926e-05 Pa s, 1.5577e-01 W/(m K)
    """

    name: ClassVar[str] = "helium"
    molecules: ClassVar[str] = "monatomic"
    correlations: ClassVar[Correlations] = Correlations(
        _viscosity, _conductivity, monatomic_heat_capacity, _RANGE
    )

    specific_gas_constant: Numeric = GAS_CONSTANT / MOLAR_MASS
    heat_capacity_ratio: Numeric = MONATOMIC_RATIO


HELIUM = Helium()
"""Helium by reference correlations."""
