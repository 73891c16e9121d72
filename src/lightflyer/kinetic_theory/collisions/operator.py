r"""The linearised collision operator of VHS molecules on a few moments.

.. math:: L h = K h - \nu(c)\,h, \qquad
    K h \approx \nu \sum_{ij} \phi_i\,\langle\phi_i K\phi_j\rangle\,\langle\nu\phi_j h\rangle,
    \qquad \langle\nu\phi_i\phi_j\rangle = \delta_{ij}

K is compact, so that few functions :math:`\phi` are enough; what a molecule loses on its way,
:math:`\nu(c)`, is kept as it is. Number, momentum and energy are conserved to rounding, as the
functions contain them. Rates are in units of p/μ with the full viscosity, not its first
approximation.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.linalg import block_diag, lstsq

from lightflyer.kinetic_theory.collisions.brackets import (
    Molecule,
    gain_bracket,
    loss_bracket,
    maxwellian_nodes,
    weight_bracket,
)


def powers(degree: int, number: int) -> tuple[int, ...]:
    """The first powers of the speed of a degree: what collisions conserve or change least first."""
    first = [p for p in (degree, degree + 2, degree + 1) if p < 4] if degree < 3 else []
    return tuple([*first, *(p for p in range(number + 3) if p not in first)][:number])


@dataclass(frozen=True)
class Moments:
    """Functions on which the gain of collisions is projected."""

    # Number of powers of the speed with each degree l of spherical harmonics
    translation: tuple[int, ...] = (6, 6, 5, 5, 4, 4, 3)
    # The same for functions that rotational energy carries
    rotation: tuple[int, ...] = (4, 4, 3, 2)

    def powers(self, degree: int) -> tuple[int, ...]:
        """Powers of the speed with a degree."""
        return powers(degree, self.translation[degree])

    def turning(self, degree: int) -> tuple[int, ...]:
        """Those that rotational energy carries too."""
        number = self.rotation[degree] if degree < len(self.rotation) else 0
        return powers(degree, number)

    @property
    def degrees(self) -> int:
        """Number of degrees l."""
        return len(self.translation)


MOMENTS = Moments()  # Enough for 10⁻³ in force; see the documentation
FEWER_MOMENTS = Moments((6, 6, 5, 4, 3), (4, 4, 3))  # Fewer, to tell the error


@dataclass(frozen=True)
class CollisionOperator:
    """Linearised collision operator of a molecule."""

    molecule: Molecule
    moments: Moments = MOMENTS
    scaled: bool = True  # Whether rates are in units of p/μ, and not of mean :math:`g^γ`

    def frequency(self, speed: np.ndarray) -> np.ndarray:
        """Collision frequency [p/μ] at a speed [√(2RT₀)]."""
        return self._scale * self.molecule.frequency(speed)

    def weights(self, degree: int) -> np.ndarray:
        """⟨ν φ φ⟩ of the powers with a degree, shape (m, m), translation first [p/μ]."""
        whole = weight_bracket(self.molecule, self.moments.powers(degree))
        turning = len(self._turning(degree))
        return self._scale * block_diag(whole, whole[:turning, :turning])

    def orthonormal(self, degree: int) -> np.ndarray:
        """From powers of c² to functions that are orthonormal in ⟨ν φ φ⟩, shape (m, m)."""
        # It is lower triangular: the first functions are the same for any number of them.
        return np.linalg.inv(np.linalg.cholesky(self.weights(degree)))

    def mixing(self, degree: int) -> np.ndarray:
        """⟨φ K φ⟩ of the orthonormal functions of a degree, shape (m, m) [1]."""
        # Number, momentum and energy are conserved to rounding, which no quadrature would do.
        change = self.orthonormal(degree)
        gain = change @ self._gain(degree) @ change.T
        gain = 0.5 * (gain + gain.T)
        # number, momentum or energy on the orthonormal functions
        invariants = [np.eye(len(gain))[0]] if degree < 2 else []
        if degree == 0:
            # c² is the second power; a molecule's rotation has its energy as well
            of_powers = np.linalg.inv(change)
            energy = of_powers[1]
            if self.molecule.rotates:
                energy = energy + of_powers[self.moments.translation[0]]
            energy = energy - energy[0] * invariants[0]
            invariants.append(energy / np.linalg.norm(energy))
        for invariant in invariants:
            part = invariant @ gain
            whole = part @ invariant
            gain += np.outer(invariant, invariant) * (1.0 + whole)
            gain -= np.outer(invariant, part) + np.outer(part, invariant)
        return np.asarray(gain)

    def _turning(self, degree: int) -> tuple[int, ...]:
        return self.moments.turning(degree) if self.molecule.rotates else ()

    def _gain(self, degree: int) -> np.ndarray:
        """⟨φ K φ⟩ of the powers with a degree [p/μ]."""
        moments = self.moments.powers(degree)
        gain = gain_bracket(self.molecule, degree, moments, self._turning(degree))
        size = len(moments)
        gain[:size, :size] -= loss_bracket(self.molecule, degree, moments)
        return self._scale * gain

    @cached_property
    def _scale(self) -> float:
        """Frequency per mean of g^γ at which the viscosity is one."""
        if not self.scaled:
            return 1.0
        return replace(self, scaled=False)._response(2, {2: 1.0}) / 3.75

    def _response(self, degree: int, function: dict[int, float]) -> float:
        """Minus the bracket of a function, by its powers, with what L makes it from."""
        # Of degree 1 rotational energy carries the function ε − 1 as well.
        speed, weight = maxwellian_nodes()
        frequency = self.frequency(speed)
        values = [sum(factor * speed**p for p, factor in function.items())]
        if self._turning(degree) and degree == 1:
            values.append(speed)
        right = []
        for value, kinds in zip(
            values, (self.moments.powers(degree), self._turning(degree)), strict=False
        ):
            right += [float(np.sum(weight * value * speed**p)) for p in kinds]
        b = self.orthonormal(degree)
        right += [0.0] * (len(b) - len(right))
        b = b @ np.array(right)
        gain = self.mixing(degree)
        # momentum is conserved: the answer is free by it, and the bracket is not changed
        moments = lstsq(np.eye(b.size) - gain, b, cond=1e-10)[0]
        direct = sum(float(np.sum(weight * value**2 / frequency)) for value in values)
        return direct + float(b @ gain @ moments)
