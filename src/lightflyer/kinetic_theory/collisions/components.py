"""What is known of a gas of molecules at a node."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from lightflyer.kinetic_theory.collisions.operator import CollisionOperator


@dataclass(frozen=True)
class Components:
    """What is known of the gas at a node: harmonics times powers of the speed."""

    operator: CollisionOperator

    @cached_property
    def translation(self) -> list[tuple[int, int, int]]:
        """Degree l, order m and number a of the power of each component without rotation."""
        sizes = self.operator.moments.translation
        return [
            (degree, order, a)
            for degree, size in enumerate(sizes)
            for order in range(degree + 1)
            for a in range(size)
        ]

    @cached_property
    def rotation(self) -> np.ndarray:
        """Which of these rotational energy has too, by number."""
        if not self.operator.molecule.rotates:
            return np.empty(0, int)
        sizes = self.operator.moments.rotation
        kept = [degree < len(sizes) and a < sizes[degree] for degree, _, a in self.translation]
        return np.flatnonzero(kept)

    @property
    def size(self) -> int:
        """Number of components, rotational ones last."""
        return len(self.translation) + self.rotation.size

    @cached_property
    def mixing(self) -> np.ndarray:
        """From the moments at a node to the sources there, shape (size, size)."""
        return self._spread(self.operator.mixing)

    @cached_property
    def orthonormal(self) -> np.ndarray:
        """From powers to orthonormal functions, shape (size, size)."""
        return self._spread(self.operator.orthonormal)

    @cached_property
    def weights(self) -> np.ndarray:
        """⟨ν φ φ⟩ of the powers, shape (size, size)."""
        return self._spread(self.operator.weights)

    @cached_property
    def names(self) -> list[tuple[int, int, int, bool]]:
        """Degree l, order m, number a of the power, and whether it is of rotation."""
        moved = [(*which, False) for which in self.translation]
        return moved + [(*self.translation[i], True) for i in self.rotation]

    def _spread(self, of_degree: Callable[[int], np.ndarray]) -> np.ndarray:
        """Matrix of all components from one block per degree, the same for all orders m."""
        sizes = self.operator.moments.translation
        blocks = [of_degree(degree) for degree in range(len(sizes))]
        matrix = np.zeros((self.size, self.size))
        for i, (degree, m, a, rotates) in enumerate(self.names):
            for k, (other, order, b, turns) in enumerate(self.names):
                if degree == other and m == order:
                    offset = sizes[degree]
                    matrix[i, k] = blocks[degree][a + offset * rotates, b + offset * turns]
        return matrix


def harmonic_arguments(components: Components) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Arguments of the kernels that say what the components are."""
    degrees = components.operator.moments.degrees
    odd = np.array([m % 2 == 1 for degree in range(degrees) for m in range(degree + 1)])
    norms = np.zeros((degrees, degrees))
    for degree in range(degrees):
        for m in range(degree + 1):
            ratio = math.factorial(degree - m) / math.factorial(degree + m)
            norms[degree, m] = math.sqrt((2 * degree + 1) * (1 if m == 0 else 2) * ratio)
    moments = components.operator.moments
    numbers = [
        (degree * (degree + 1) // 2 + order, moments.powers(degree)[a])
        for degree, order, a, _ in components.names
    ]
    return norms, odd, np.array(numbers).T.copy()


def highest_power(components: Components) -> int:
    """Highest power of the speed in the integrals along rays."""
    moments = components.operator.moments
    return 2 * max(max(moments.powers(degree)) for degree in range(moments.degrees)) + 4
