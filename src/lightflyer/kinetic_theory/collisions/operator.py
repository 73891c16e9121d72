r"""The linearised collision operator of VHS molecules on a few moments, and the slip it makes.

.. math:: L h = K h - \nu(c)\,h, \qquad
    K h \approx \nu \sum_{ij} \phi_i\,\langle\phi_i K\phi_j\rangle\,\langle\nu\phi_j h\rangle,
    \qquad \langle\nu\phi_i\phi_j\rangle = \delta_{ij}

K is compact, so that few functions :math:`\phi` are enough; what a molecule loses on its way,
:math:`\nu(c)`, is kept as it is. Number, momentum and energy are conserved to rounding, as the
functions contain them. Rates are in units of p/μ with the full viscosity, not its first
approximation.

Slip of a gas over a plane wall: what the collision operator alone says, without any disk.

Far from the wall the gas shears or has a temperature gradient along it. The layer at the wall
changes what is left of this by a velocity, the slip. With the length :math:`\ell = \mu\sqrt{2RT}/p`

.. math:: u = \sigma_P\,\ell\,\frac{\partial u}{\partial z}, \qquad
    u = \sigma_T\,\frac{\mu}{\rho T}\,\frac{\partial T}{\partial x}

The wall re-emits all molecules at its own temperature. Molecules of each speed and height of
direction are followed through the layer by collocation; the moments of the operator are unknowns.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.linalg import block_diag, lstsq
from scipy.special import lpmv

from lightflyer.core.errors import ParameterError
from lightflyer.kinetic_theory.collisions.brackets import (
    Molecule,
    gain_bracket,
    loss_bracket,
    maxwellian_nodes,
    weight_bracket,
)
from lightflyer.kinetic_theory.grid.mesh import panel_nodes


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
        for invariant in self._invariants(degree):
            part = invariant @ gain
            whole = part @ invariant
            gain += np.outer(invariant, invariant) * (1.0 + whole)
            gain -= np.outer(invariant, part) + np.outer(part, invariant)
        return np.asarray(gain)

    def _invariants(self, degree: int) -> list[np.ndarray]:
        """Number, momentum or energy on the orthonormal functions of a degree."""
        if degree > 1:
            return []
        size = len(self.weights(degree))
        first = np.eye(size)[0]
        if degree == 1:
            return [first]
        # c² is the second power; a molecule's rotation has its energy as well
        energy = np.linalg.inv(self.orthonormal(0))[1]
        if self.molecule.rotates:
            energy = energy + np.linalg.inv(self.orthonormal(0))[self.moments.translation[0]]
        energy = energy - energy[0] * first
        return [first, energy / np.linalg.norm(energy)]

    def _turning(self, degree: int) -> tuple[int, ...]:
        return self.moments.turning(degree) if self.molecule.rotates else ()

    @property
    def heat_conductivity(self) -> float:
        """Thermal conductivity over viscosity and gas constant, κ/(μR)."""
        functions = {1: -2.5, 3: 1.0}
        return 2.0 * self._response(1, functions) / 3.0

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


_DEPTH = 30.0  # of the layer that is solved [ℓ]
_PANELS, _ORDER, _GROWTH = 22, 5, 1.4
_SPEEDS, _HEIGHTS = 28, 20
_FASTEST = 5.0


@dataclass(frozen=True)
class Slip:
    """Coefficients of viscous slip and thermal creep [1]."""

    viscous: float
    thermal: float


def slip(operator: CollisionOperator) -> Slip:
    """Slip coefficients at a wall of complete diffuse reflection."""
    if operator.molecule.rotates:
        raise ParameterError("slip coefficients are for molecules without rotation")
    layer = _WallLayer(operator)
    shear = layer.far_velocity(2, np.array([2.0]))
    creep = layer.far_velocity(1, np.array([-2.5, 1.0]))
    return Slip(shear, 2.0 * creep)


class _WallLayer:
    """Discrete molecules, their paths, and the functions that vary as c_x along the wall."""

    def __init__(self, operator: CollisionOperator) -> None:
        self.operator = operator
        nodes, weights = np.polynomial.legendre.leggauss(_SPEEDS)
        self.speed = 0.5 * _FASTEST * (nodes + 1.0)
        of_speed = _FASTEST * weights / np.sqrt(np.pi) * self.speed**2 * np.exp(-(self.speed**2))
        nodes, weights = np.polynomial.legendre.leggauss(_HEIGHTS)
        root = 0.5 * (nodes + 1.0)  # many grazing ones, which see most of the layer
        self.height = root**2
        self.weight = np.outer(of_speed, weights * root)  # of either half of the directions
        self.frequency = operator.frequency(self.speed)[:, None]
        self.slots: dict[int, slice] = {}
        functions: list[tuple[int, int]] = []
        for degree in range(1, operator.moments.degrees):
            powers = operator.moments.powers(degree)
            self.slots[degree] = slice(len(functions), len(functions) + len(powers))
            functions += [(degree, p) for p in powers]
        values = np.stack([self._function(*which) for which in functions])
        change = block_diag(*(operator.orthonormal(degree) for degree in self.slots))
        self.functions = np.einsum("ij,jsv->isv", change, values)
        self.parity = np.array([(-1.0) ** (degree + 1) for degree, _ in functions])
        self.mixing = block_diag(*(operator.mixing(degree) for degree in self.slots))
        rate = self.frequency / (self.speed[:, None] * self.height)
        self.paths, self.left = _paths(rate)

    def _function(self, degree: int, power: int) -> np.ndarray:
        """φ of upward molecules over √2 times the azimuth's cosine, shape (speeds, heights)."""
        norm = np.sqrt((2 * degree + 1) / (degree * (degree + 1)))
        return self.speed[:, None] ** power * -norm * lpmv(1, degree, self.height)

    def far_velocity(self, degree: int, polynomial: np.ndarray) -> float:
        """Velocity far away for a gradient that makes c_x or c_x c_z times a polynomial in c²."""
        norm = np.sqrt(6.0) if degree == 1 else np.sqrt(30.0)
        value = np.polynomial.polynomial.polyval(self.speed**2, polynomial)[:, None]
        made = -np.sqrt(2.0) * self._function(degree, degree) * value / norm
        slot = self.slots[degree]
        up, mixing = self.functions[slot], self.mixing[slot, slot]
        right = 2.0 * np.einsum("isv,sv->i", up, made * self.weight)
        moments = np.linalg.lstsq(np.eye(len(right)) - mixing, right, rcond=1e-10)[0]
        gas = made / self.frequency + np.einsum("i,isv->sv", mixing @ moments, up)
        if degree == 1:  # momentum is free, and there is none
            momentum = self._function(1, 1)
            gas = gas - 4.0 / 3.0 * np.sum(momentum * gas * self.weight) * momentum
        emitted = -gas  # by the wall, into a gas that is at rest without it
        m, n = self.parity.size, self.left.shape[-1]
        weighted = self.functions * self.weight * self.frequency
        products = np.einsum("isv,jsv->ijsv", weighted, self.functions).reshape(m * m, -1)
        falling, fallen = self.paths[..., ::-1, ::-1], self.left[..., ::-1]
        # far away molecules turn round, as all gradients are gone there
        turned = fallen[..., :, None] * self.paths[..., -1, None, :]
        rising = (products @ self.paths.reshape(-1, n * n)).reshape(m, m, n, n)
        sinking = (products @ falling.reshape(-1, n * n)).reshape(m, m, n, n)
        back = (products @ turned.reshape(-1, n * n)).reshape(m, m, n, n)
        own, other = self.parity[:, None, None, None], self.parity[:, None, None]
        whole = rising + own * (other * sinking + back)
        matrix = np.einsum("ijxy,jk->xiyk", whole, self.mixing, optimize=True)
        returned = fallen * self.left[..., -1:]
        right = np.einsum("isv,sv,svx->xi", weighted, emitted, self.left)
        right += self.parity * np.einsum("isv,sv,svx->xi", weighted, emitted, returned)
        moments = np.linalg.solve(np.eye(n * m) - matrix.reshape(n * m, n * m), right.ravel())
        # 2 u c_x is 2/√3 of the first power, of which the first function is a multiple
        flow = moments.reshape(n, m)[-1, 0] * self.operator.orthonormal(1)[0, 0]
        return float(0.5 * np.sqrt(3.0) * flow)


def _paths(rate: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """What upward molecules bring to nodes from the sources there, and from the wall."""
    inner = _GROWTH ** np.arange(_PANELS // 2)
    widths = np.concatenate([inner, inner[::-1]])  # the same from both ends
    widths *= _DEPTH / widths.sum()
    nodes = panel_nodes(_ORDER, lower=True, upper=True)
    # values at nodes to derivatives there, but at the first
    powers = np.arange(nodes.size)
    values = nodes[:, None] ** powers
    derived = powers * nodes[:, None] ** np.maximum(powers - 1, 0)
    slopes = np.linalg.solve(values.T, derived.T).T[1:]
    n = _PANELS * (_ORDER - 1) + 1
    paths, left = np.zeros((*rate.shape, n, n)), np.ones((*rate.shape, n))
    for panel, width in enumerate(widths):
        start = panel * (_ORDER - 1)
        here = slice(start + 1, start + _ORDER)
        depth = (width * rate)[..., None, None]
        inverse = np.linalg.inv(slopes[:, 1:] + depth * np.eye(_ORDER - 1))
        passed = -(inverse @ slopes[:, :1])[..., 0]
        paths[..., here, :] = passed[..., None] * paths[..., start : start + 1, :]
        paths[..., here, here] += depth * inverse
        left[..., here] = passed * left[..., start : start + 1]
    return paths, left
