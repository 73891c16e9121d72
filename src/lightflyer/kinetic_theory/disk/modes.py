r"""Modes of what a face scatters: products of polynomials that it only makes smaller.

At a wall of [CercignaniLampis1971]_ the normal and the tangential velocity are scattered each on
its own, and Laguerre's polynomials :math:`L_m(c_n^2)` and the functions
:math:`c_t^j\cos(j\varphi)\,L_k^{(j)}(c_t^2)` are eigenfunctions: molecules that arrive with one of
them leave with the same, times :math:`(1-\alpha_n)^m` and :math:`(1-\sigma_t)^{j+2k}`. They are
orthonormal over the molecules that meet the wall. So the wall is known by a number per mode, and
the solver by how much of each mode arrives where one leaves.
"""

from dataclasses import dataclass

import numpy as np
from scipy.special import binom, gammaln, poch


@dataclass(frozen=True)
class Mode:
    """One eigenfunction, by its degree in the normal velocity and two in the tangential one."""

    normal: int  # m
    harmonic: int  # j
    radial: int  # k

    @property
    def degree(self) -> int:
        """Highest power of the speed."""
        return 2 * (self.normal + self.radial) + self.harmonic

    def eigenvalue(self, normal: float, tangential: float) -> float:
        """Share that is left of it at a wall of given α_n and σ_t."""
        kept = (1.0 - normal) ** self.normal
        return float(kept * (1.0 - tangential) ** (self.harmonic + 2 * self.radial))

    def coefficients(self, size: int) -> np.ndarray:
        """Coefficients of powers of c_n² and c_t², shape (size, size)."""
        m, j, k = self.normal, self.harmonic, self.radial
        table = np.zeros((size, size))
        scale = 1.0 if j == 0 else np.sqrt(2.0 * np.exp(gammaln(k + 1) - gammaln(k + j + 1)))
        table[: m + 1, : k + 1] = scale * np.outer(_laguerre(m, 0), _laguerre(k, j))
        return table

    @property
    def momentum(self) -> float:
        r"""Normal momentum, :math:`\langle c_n\varphi\rangle`."""
        if self.harmonic or self.radial:
            return 0.0
        share = poch(-0.5, self.normal) / np.exp(gammaln(self.normal + 1.0))
        return float(0.5 * np.sqrt(np.pi) * share)


def _laguerre(degree: int, order: int) -> np.ndarray:
    """Coefficients of Laguerre's polynomial, the lowest power first."""
    powers = np.arange(degree + 1)
    signs = np.where(powers % 2, -1.0, 1.0)
    return np.asarray(signs * binom(degree + order, degree - powers) / np.exp(gammaln(powers + 1)))


NUMBER, NORMAL_ENERGY, TANGENTIAL_ENERGY = Mode(0, 0, 0), Mode(1, 0, 0), Mode(0, 0, 1)


def modes_up_to(degree: int, normal: int) -> tuple[Mode, ...]:
    """Modes of a total degree, and those of the normal velocity alone up to an m."""
    found = [
        Mode(m, j, k)
        for m in range(degree // 2 + 1)
        for k in range(degree // 2 + 1)
        for j in range(degree + 1)
        if 2 * (m + k) + j <= degree
    ]
    found += [Mode(m, 0, 0) for m in range(degree // 2 + 1, normal + 1)]
    return tuple(sorted(found, key=lambda mode: (mode.degree, mode.normal, mode.harmonic)))
