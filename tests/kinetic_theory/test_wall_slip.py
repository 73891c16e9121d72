r"""Slip of a gas over a plane wall: what the collision operator alone says, without any disk.

Far from the wall the gas shears or has a temperature gradient along it. The layer at the wall
changes what is left of this by a velocity, the slip. With the length :math:`\ell = \mu\sqrt{2RT}/p`

.. math:: u = \sigma_P\,\ell\,\frac{\partial u}{\partial z}, \qquad
    u = \sigma_T\,\frac{\mu}{\rho T}\,\frac{\partial T}{\partial x}

The wall re-emits all molecules at its own temperature. Molecules of each speed and height of
direction are followed through the layer by collocation; the moments of the operator are unknowns.
"""

import numpy as np
import pytest
from scipy.linalg import block_diag
from scipy.special import lpmv

pytest.importorskip("numba")

from lightflyer.kinetic_theory.collisions.brackets import Molecule
from lightflyer.kinetic_theory.collisions.operator import CollisionOperator, Moments
from lightflyer.kinetic_theory.grid.mesh import panel_nodes

DEPTH = 30.0  # of the layer that is solved [ℓ]
PANELS, ORDER, GROWTH = 22, 5, 1.4
SPEEDS, HEIGHTS = 28, 20
FASTEST = 5.0


class WallLayer:
    """Discrete molecules, their paths, and the functions that vary as c_x along the wall."""

    def __init__(self, operator: CollisionOperator) -> None:
        self.operator = operator
        nodes, weights = np.polynomial.legendre.leggauss(SPEEDS)
        self.speed = 0.5 * FASTEST * (nodes + 1.0)
        of_speed = FASTEST * weights / np.sqrt(np.pi) * self.speed**2 * np.exp(-(self.speed**2))
        nodes, weights = np.polynomial.legendre.leggauss(HEIGHTS)
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
        values = np.stack([self.function(*which) for which in functions])
        change = block_diag(*(operator.orthonormal(degree) for degree in self.slots))
        self.functions = np.einsum("ij,jsv->isv", change, values)
        self.parity = np.array([(-1.0) ** (degree + 1) for degree, _ in functions])
        self.mixing = block_diag(*(operator.mixing(degree) for degree in self.slots))
        rate = self.frequency / (self.speed[:, None] * self.height)
        self.paths, self.left = paths(rate)

    def function(self, degree: int, power: int) -> np.ndarray:
        """φ of upward molecules over √2 times the azimuth's cosine, shape (speeds, heights)."""
        norm = np.sqrt((2 * degree + 1) / (degree * (degree + 1)))
        return self.speed[:, None] ** power * -norm * lpmv(1, degree, self.height)

    def far_velocity(self, degree: int, polynomial: np.ndarray) -> float:
        """Velocity far away for a gradient that makes c_x or c_x c_z times a polynomial in c²."""
        norm = np.sqrt(6.0) if degree == 1 else np.sqrt(30.0)
        value = np.polynomial.polynomial.polyval(self.speed**2, polynomial)[:, None]
        made = -np.sqrt(2.0) * self.function(degree, degree) * value / norm
        slot = self.slots[degree]
        up, mixing = self.functions[slot], self.mixing[slot, slot]
        right = 2.0 * np.einsum("isv,sv->i", up, made * self.weight)
        moments = np.linalg.lstsq(np.eye(len(right)) - mixing, right, rcond=1e-10)[0]
        gas = made / self.frequency + np.einsum("i,isv->sv", mixing @ moments, up)
        if degree == 1:  # momentum is free, and there is none
            momentum = self.function(1, 1)
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


def paths(rate: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """What upward molecules bring to nodes from the sources there, and from the wall."""
    inner = GROWTH ** np.arange(PANELS // 2)
    widths = np.concatenate([inner, inner[::-1]])  # the same from both ends
    widths *= DEPTH / widths.sum()
    nodes = panel_nodes(ORDER, lower=True, upper=True)
    # values at nodes to derivatives there, but at the first
    powers = np.arange(nodes.size)
    values = nodes[:, None] ** powers
    derived = powers * nodes[:, None] ** np.maximum(powers - 1, 0)
    slopes = np.linalg.solve(values.T, derived.T).T[1:]
    n = PANELS * (ORDER - 1) + 1
    paths, left = np.zeros((*rate.shape, n, n)), np.ones((*rate.shape, n))
    for panel, width in enumerate(widths):
        start = panel * (ORDER - 1)
        here = slice(start + 1, start + ORDER)
        depth = (width * rate)[..., None, None]
        inverse = np.linalg.inv(slopes[:, 1:] + depth * np.eye(ORDER - 1))
        passed = -(inverse @ slopes[:, :1])[..., 0]
        paths[..., here, :] = passed[..., None] * paths[..., start : start + 1, :]
        paths[..., here, here] += depth * inverse
        left[..., here] = passed * left[..., start : start + 1]
    return paths, left


@pytest.mark.parametrize(
    ("exponent", "viscous", "thermal"),
    # hard spheres: Ohwada, Sone & Aoki 1989, Siewert 2003
    [(0.5, 0.9873, 1.018), (0.74, 1.0015, 1.091)],
)
def test_slip_at_a_plane_wall_is_the_published_one(exponent, viscous, thermal):
    layer = WallLayer(CollisionOperator(Molecule(exponent), Moments((6, 6, 5, 4))))
    shear = layer.far_velocity(2, np.array([2.0]))
    creep = 2.0 * layer.far_velocity(1, np.array([-2.5, 1.0]))
    assert shear == pytest.approx(viscous, rel=2e-3)
    assert creep == pytest.approx(thermal, rel=2e-3)
