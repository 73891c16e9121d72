r"""Collision brackets of VHS molecules between powers of the speed times spherical harmonics.

Speeds are in √(2RT₀), means are over a gas at rest. A pair of molecules collides at a rate
proportional to :math:`g^\gamma`, :math:`\gamma = 2 - 2\omega`, and scatters into all directions
alike. The functions are

.. math:: \phi_{l,p,k} = c^p\,Y_l(\hat{\mathbf c})\,(\varepsilon - 1)^k

with :math:`\langle Y_l^2\rangle = 1` on the sphere, and k = 1 for what rotational energy
:math:`\varepsilon` carries (two degrees of freedom, in units of :math:`k_B T_0`). Powers are all
integers from 0, not :math:`l + 2a` as in a polynomial of the velocity: molecules that leave a wall
know their direction at any speed, and with :math:`c^{l+2a}` the force in thin gas converges slowly.

In the velocity of the pair's centre, G, and its relative velocity, g, isotropic scattering replaces
a function by its mean over the directions of g. The mean is homogeneous in both speeds: what is
left of elastic collisions is an integral over the angle t of :math:`\tan t = g/(2G)`.
"""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.special import gamma as gamma_function
from scipy.special import hyp1f1, roots_jacobi, roots_laguerre, roots_legendre

_ANGLES = 48  # Gauss nodes on either side of t = π/4, where a function's mean has a kink
_ACROSS = 60  # of a mean over directions
_RADII, _LARGEST = 24, 6.5  # of collisions with exchange of rotational energy
_ENERGIES = 6


@dataclass(frozen=True)
class Molecule:
    r"""A molecule with isotropic scattering at a cross-section :math:`\propto g^{1-2\omega}`."""

    viscosity_exponent: float  # ω of μ ∝ T^ω: 0.5 for hard spheres, 1 for Maxwell molecules
    # Probability 1/Z that a molecule's rotation takes part in a collision, by Larsen and
    # Borgnakke's rule, for each of the two; 0 for molecules without rotation
    exchange: float = 0.0
    rotates: bool = False  # Whether molecules have two rotational degrees of freedom

    @property
    def speed_power(self) -> float:
        """Power γ of the relative speed in the rate of collisions."""
        return 2.0 - 2.0 * self.viscosity_exponent

    def frequency(self, speed: np.ndarray) -> np.ndarray:
        """Mean of :math:`|c - c_1|^γ` over a gas at rest, shape as ``speed`` [√(2RT₀)]."""
        power = self.speed_power
        mean = gamma_function(1.5 + 0.5 * power) / gamma_function(1.5)
        return np.asarray(mean * hyp1f1(-0.5 * power, 1.5, -np.square(speed)))


Powers = tuple[int, ...]


def maxwellian_nodes() -> tuple[np.ndarray, np.ndarray]:
    """Speeds and weights of means over a gas at rest."""
    nodes, weights = np.polynomial.legendre.leggauss(200)
    speed = 4.5 * (nodes + 1.0)
    return speed, 4.5 * weights * 4.0 / np.sqrt(np.pi) * speed**2 * np.exp(-(speed**2))


def weight_bracket(molecule: Molecule, powers: Powers) -> np.ndarray:
    """⟨g^γ φ_p φ_q⟩ of one molecule: products weighted by frequency, shape (powers, powers)."""
    speed, weight = maxwellian_nodes()
    values = speed ** np.array(powers)[:, None]
    return np.asarray((values * weight * molecule.frequency(speed)) @ values.T)


def loss_bracket(molecule: Molecule, degree: int, powers: Powers) -> np.ndarray:
    """⟨g^γ φ_p(c) φ_q(c₁)⟩, what the loss of the partner takes, shape (powers, powers)."""
    # c = R cos t, c₁ = R sin t; both are alike, so that half of the angles are enough
    t, of_t = _half_of_angles()
    nodes, weights = roots_legendre(_ACROSS)
    u, of_u = 0.5 * (nodes + 1.0), 0.5 * weights
    x = 1.0 - 2.0 * u**2  # collinear speeds may be equal, where g vanishes
    rate = (1.0 - np.sin(2.0 * t)[:, None] * x) ** (0.5 * molecule.speed_power)
    angular = (rate * _legendre(degree, x)) @ (2.0 * u * of_u)
    found = np.zeros((len(powers), len(powers)))
    for i, p in enumerate(powers):
        for k, q in enumerate(powers):
            both = np.cos(t) ** (2 + p) * np.sin(t) ** (2 + q)
            both += np.sin(t) ** (2 + p) * np.cos(t) ** (2 + q)
            scale = 0.5 * gamma_function(0.5 * (6 + p + q + molecule.speed_power))
            found[i, k] = 16.0 / np.pi * scale * np.sum(of_t * both * angular)
    return found


def gain_bracket(
    molecule: Molecule, degree: int, powers: Powers, turning: Powers = ()
) -> np.ndarray:
    """⟨g^γ φ (φ' + φ₁')⟩ of a molecule before and both after a collision, shape (m, m)."""
    angle, weight = _angles()
    means, gamma = angular_mean(degree, powers, angle), molecule.speed_power
    # 2 G = R cos t, g = R sin t; weights are exp(−R²/2)
    shape = weight * np.cos(angle) ** 2 * np.sin(angle) ** (2.0 + gamma)
    exponent = 0.5 * (6.0 + gamma + np.add.outer(powers, powers))
    scale = (2.0 / np.pi) * 0.5 * 2.0**exponent * gamma_function(exponent)
    elastic = scale * ((means * shape) @ means.T)
    size, turned = len(powers), len(turning)
    found = np.zeros((size + turned, size + turned))
    if not molecule.rotates:
        found[:, :] = 2.0 * elastic
        return found
    # without exchange, rotational energy stays with its molecule
    none = (1.0 - molecule.exchange) ** 2
    found[:size, :size] = 2.0 * none * elastic
    found[size:, size:] = none * elastic[:turned, :turned]
    if molecule.exchange:
        chance, after = molecule.exchange, _Means(degree, powers)
        one = _one_exchange(_Collisions(molecule, 16, _RADII, _ENERGIES), after)
        both = _two_exchanges(_Collisions(molecule, 8, 12, 4), after)
        inelastic = chance * (1.0 - chance) * one + chance**2 * both
        slots = [(k, i) for k, count in enumerate((size, turned)) for i in range(count)]
        k, i = np.transpose(slots)
        found += inelastic[k[:, None], i[:, None], k, i]
    return found


def _legendre(degree: int, x: np.ndarray) -> np.ndarray:
    return np.polynomial.legendre.legval(x, np.eye(degree + 1)[degree])


def _half_of_angles(number: int = _ANGLES) -> tuple[np.ndarray, np.ndarray]:
    """Angles from 0 to π/4, dense at the latter, and weights."""
    nodes, weights = roots_legendre(number)
    u = 0.5 * (nodes + 1.0)
    return 0.25 * np.pi * (1.0 - u**2), 0.25 * np.pi * u * weights


def _angles(number: int = _ANGLES) -> tuple[np.ndarray, np.ndarray]:
    """Angles from 0 to π/2 and weights."""
    t, weight = _half_of_angles(number)
    return np.concatenate([t, 0.5 * np.pi - t]), np.tile(weight, 2)


def angular_mean(degree: int, powers: Powers, angle: np.ndarray) -> np.ndarray:
    """Means of the functions over the directions of g, over Y(Ĝ) and a power of R."""
    # The centre's speed is R cos(t)/2 and the relative speed R sin(t): each function's speed lies
    # between R |cos t − sin t|/2 and R (cos t + sin t)/2.
    centre, relative = 0.5 * np.cos(angle), 0.5 * np.sin(angle)
    low, high = np.abs(centre - relative), centre + relative
    nodes, weights = roots_legendre(_ACROSS)
    u = 0.5 * (nodes[:, None] + 1.0)
    speed = low + (high - low) * u**2
    cosine = (centre**2 - relative**2 + speed**2) / (2.0 * centre * speed)
    # dx = c dc/(centre · relative), and half of it is the mean
    measure = 0.5 * weights[:, None] * (high - low) * 2.0 * u * speed / (centre * relative)
    angular = 0.5 * measure * _legendre(degree, np.clip(cosine, -1.0, 1.0))
    return np.stack([np.sum(angular * speed**p, axis=0) for p in powers])


class _Means:
    """Angular means at any speeds of centre and pair."""

    def __init__(self, degree: int, powers: Powers) -> None:
        root = np.linspace(0.0, 1.0, 150)
        below = 0.25 * np.pi * (1.0 - root[::-1] ** 2)
        below[0] = 1e-6
        above = 0.5 * np.pi - below[::-1]
        self.powers = np.array(powers)
        self.halves = [
            CubicSpline(t, angular_mean(degree, powers, t), axis=1)
            for t in (below, np.concatenate([above[:1] + 1e-12, above[1:]]))
        ]

    def __call__(self, centre: np.ndarray, relative: np.ndarray) -> np.ndarray:
        angle = np.arctan2(relative, 2.0 * centre)
        shape = np.where(angle < 0.25 * np.pi, self.halves[0](angle), self.halves[1](angle))
        radius = np.hypot(relative, 2.0 * centre)
        return np.asarray(shape * radius ** self.powers.reshape((-1,) + (1,) * radius.ndim))


class _Collisions:
    """Quadrature over pairs, rotational energy before, and its share of the total after."""

    def __init__(self, molecule: Molecule, angles: int, radii: int, energies: int) -> None:
        angle, of_angle = _angles(angles)
        nodes, weights = roots_legendre(radii)
        radius = 0.5 * _LARGEST * np.sqrt(2.0) * (nodes + 1.0)
        of_radius = 0.5 * _LARGEST * np.sqrt(2.0) * weights * radius**5 * np.exp(-0.5 * radius**2)
        self.centre = 0.5 * np.outer(radius, np.cos(angle)).ravel()
        self.relative = np.outer(radius, np.sin(angle)).ravel()
        of_angle = (2.0 / np.pi) * of_angle * np.cos(angle) ** 2 * np.sin(angle) ** 2
        self.weight = np.outer(of_radius, of_angle).ravel() * self.relative**molecule.speed_power
        self.energy, self.of_energy = roots_laguerre(energies)
        # the share's density is (1 − f)^(3/2−ω) on [0, 1]
        nodes, weights = roots_jacobi(energies, 1.5 - molecule.viscosity_exponent, 0.0)
        self.share, self.of_share = 0.5 * (nodes + 1.0), weights / weights.sum()


def _one_exchange(c: _Collisions, means: _Means) -> np.ndarray:
    """Brackets where one of the two exchanges energy: the molecule itself, or its partner."""
    before = means(c.centre, c.relative)
    total = 0.5 * c.relative[:, None, None] ** 2 + c.energy[:, None]
    left = np.sqrt(2.0 * (1.0 - c.share) * total)
    after = means(np.broadcast_to(c.centre[:, None, None], left.shape), left)
    weight = c.weight[:, None, None] * c.of_energy[:, None] * c.of_share
    turned, unturned = c.share * total - 1.0, c.energy[:, None] - 1.0
    size = before.shape[0]
    found = np.zeros((2, size, 2, size))

    def bracket(factor: np.ndarray | float) -> np.ndarray:
        return np.einsum("ap,bpef,pef->ab", before, after, weight * factor, optimize=True)

    # the molecule exchanges: of its partner's rotation nothing is correlated with it
    for k, carried in enumerate((1.0, unturned)):
        found[k, :, 0] += 2.0 * bracket(carried)
        found[k, :, 1] += bracket(carried * turned)
    # its partner does: its own rotation stays, the partner's follows from the speed alone
    found[0, :, 0] += 2.0 * bracket(1.0)
    found[0, :, 1] += bracket(turned)
    found[1, :, 1] += bracket(1.0)
    return found


def _two_exchanges(c: _Collisions, means: _Means) -> np.ndarray:
    """Brackets where both exchange energy, one after the other, in either order."""
    before = means(c.centre, c.relative)
    first_total = 0.5 * c.relative[:, None, None] ** 2 + c.energy[:, None]
    first = (c.share * first_total)[..., None, None]
    second_total = ((1.0 - c.share) * first_total)[..., None, None] + c.energy[:, None]
    second = c.share * second_total
    left = np.sqrt(2.0 * (1.0 - c.share) * second_total)
    after = means(np.broadcast_to(c.centre[:, None, None, None, None], left.shape), left)
    weight = c.weight[:, None, None, None, None] * (
        (c.of_energy[:, None] * c.of_share)[..., None, None] * (c.of_energy[:, None] * c.of_share)
    )
    energies = c.energy[:, None, None, None] - 1.0, c.energy[:, None] - 1.0
    size = before.shape[0]
    found = np.zeros((2, size, 2, size))
    for energy in energies:  # that of the first to exchange, or of the second
        for k, carried in enumerate((1.0, energy)):
            for m, kept in enumerate((2.0, first + second - 2.0)):
                found[k, :, m] += 0.5 * np.einsum(
                    "ap,bpefgh,pefgh->ab", before, after, weight * carried * kept, optimize=True
                )
    return found
