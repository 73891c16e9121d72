"""Transport of dilute nitrogen, oxygen, argon and air by one pair of formulas."""

from typing import NamedTuple

import numpy as np

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
