"""Gases of variable hard spheres with rotation."""

import math
from dataclasses import dataclass
from typing import NamedTuple

# (32/5π) μ/(ρ v̄), which mean free paths of direct simulations often are, over the package's
# (μ/p) √(πRT/2)
HARD_SPHERE_PATH = 64.0 / (5.0 * math.pi * 4.0)


class Molecule(NamedTuple):
    """What collisions need to know of a gas, for compiled loops.

    Attributes
    ----------
    cross_section : float
        Of a pair, times its relative speed g to the power 2ω − 1.
    exponent : float
        Of g² in cross-section times g, 1 − ω.
    exchange : float
        Probability that a molecule's rotation exchanges energy in a collision, 1/Z; 0 without
        rotation.
    split : float
        Exponent of Larsen and Borgnakke's distribution, 5/2 − ω.
    """

    cross_section: float
    exponent: float
    exchange: float
    split: float


@dataclass(frozen=True)
class Gas:
    """Molecules whose cross-section falls with g^(2ω − 1), and scatter to all sides alike.

    Attributes
    ----------
    viscosity_exponent : float
        ω of μ ∝ T^ω.
    collision_number : float
        Z: each molecule of a colliding pair exchanges rotational energy with probability 1/Z;
        infinite without rotation.
    """

    viscosity_exponent: float
    collision_number: float = math.inf

    @property
    def rotational_freedoms(self) -> int:
        """Rotational degrees of freedom, j."""
        return 2 if math.isfinite(self.collision_number) else 0

    @property
    def viscosity_correction(self) -> float:
        """Viscosity over its first approximation, by the second one.

        [ChapmanCowling1970]_ eq. 10.31,4, where the exponent of force is 1 + 2/(ω − 1/2). Hard
        spheres: 1.0149, by all approximations 1.0160.
        """
        omega = self.viscosity_exponent
        return 1.0 + 3.0 * (1.0 - omega) ** 2 / (52.0 - 3.0 * omega)

    def molecule(self, knudsen: float) -> Molecule:
        r"""The molecule whose gas has a viscosity.

        Parameters
        ----------
        knudsen : float
            λ/(2r) with λ = (μ/p) √(πRT_c/2), far away.

        Returns
        -------
        Molecule

        Notes
        -----
        .. math:: \mu = \frac{15\sqrt{\pi m k T}\,(4kT/m)^{\omega-1/2}}{8\,\Gamma(9/2-\omega)\,
            \sigma_T g^{2\omega-1}}

        in its first approximation, [Bird1994]_ eq. 3.62.
        """
        omega = self.viscosity_exponent
        viscosity = 2.0 * knudsen / math.sqrt(math.pi)  # λ = μ√π, as p = RT_c = 1/2
        first = viscosity / self.viscosity_correction
        strength = 15.0 * math.sqrt(0.5 * math.pi) * 2.0 ** (omega - 0.5)
        return Molecule(
            cross_section=strength / (8.0 * math.gamma(4.5 - omega) * first),
            exponent=1.0 - omega,
            exchange=1.0 / self.collision_number,
            split=2.5 - omega,
        )


GASES = {
    "hard spheres": Gas(0.5),
    "helium": Gas(0.66),
    "argon": Gas(0.81),
    "nitrogen": Gas(0.74, 5.0),
    "carbon dioxide": Gas(0.93, 2.5),
}
"""Exponents of [Bird1994]_ table A1; Z are round numbers."""
