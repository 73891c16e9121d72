r"""The linear disk problem of real molecules: many moments, solved by GMRES without matrices.

Speed integrals along a ray of molecules whose collision frequency depends on their speed.

.. math::
    J_p(s) = \int_0^\infty c^p\,\nu^2\,e^{-c^2-\nu s/c}\,dc, \qquad
    I_p(s) = \int_0^\infty c^p\,\nu\,e^{-c^2-\nu s/c}\,dc, \qquad
    \frac{dI_{p+1}}{ds} = -J_p

with ν(c) in units of p/μ and s in those of its mean free path. They are tabulated as cubic splines
in :math:`\sqrt s`, as the integrals of the model equation are.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.linalg import lu_solve

from lightflyer.kinetic_theory.collisions import arrival
from lightflyer.kinetic_theory.collisions.brackets import Molecule, maxwellian_nodes
from lightflyer.kinetic_theory.collisions.operator import (
    FEWER_MOMENTS,
    MOMENTS,
    CollisionOperator,
    Moments,
)
from lightflyer.kinetic_theory.disk.cases import (
    COARSE,
    MEDIUM,
    Case,
    DiskOutcome,
    Resolution,
    totals,
)
from lightflyer.kinetic_theory.disk.linear import (
    FaceResult,
    FaceWalls,
    LinearSystem,
    result_of_arriving,
    solve_by_gmres,
)
from lightflyer.kinetic_theory.disk.operators import (
    Operators,
    Quadrature,
    assemble,
    face_points,
    kernel_arguments,
    node_points,
)
from lightflyer.kinetic_theory.grid.mesh import Mesh
from lightflyer.kinetic_theory.grid.rays import LARGEST_DEPTH
from lightflyer.kinetic_theory.model_gases import DIATOMIC, MONATOMIC
from lightflyer.kinetic_theory.walls import Wall

_INTERVALS = 1200
_LOGARITHM_OF_SPEED = np.linspace(-14.0, 2.0, 700)


def ray_table(operator: CollisionOperator, highest: int) -> tuple[np.ndarray, float]:
    """Spline coefficients of both integrals; returns ``coefficients``, ``intervals_per_unit``."""
    root = np.linspace(0.0, np.sqrt(LARGEST_DEPTH) * 1.001, _INTERVALS + 1)
    speed = np.exp(_LOGARITHM_OF_SPEED)
    frequency = operator.frequency(speed)
    step = _LOGARITHM_OF_SPEED[1] - _LOGARITHM_OF_SPEED[0]
    left = np.exp(-np.square(root)[:, None] * frequency / speed)
    weight = step * frequency * np.exp(-np.square(speed))
    powers = speed[:, None] ** (np.arange(highest + 1) + 1)
    squared = left @ (powers * (weight * frequency)[:, None])
    simple = left @ (powers * weight[:, None])
    splines = CubicSpline(root, np.concatenate([squared, simple], axis=1))
    # SciPy's order is power, interval, integral
    table = np.ascontiguousarray(np.transpose(splines.c, (1, 0, 2)))
    return table, float(_INTERVALS / root[-1])


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


_TOLERANCE = 1e-7  # of moments; the force is as good to 1e-5


class MolecularProblem:
    """Linear problem of a gas of molecules on a mesh, for any disk in it."""

    # The model equation, which has few fields and is factorised, preconditions it.

    def __init__(
        self,
        mesh: Mesh,
        rarefaction: float,
        quadrature: Quadrature,
        operator: CollisionOperator,
        mean_tac: float,
        wall: Wall = "maxwell",
        operators: Operators | None = None,
    ) -> None:
        self.mesh, self.rarefaction, self.wall = mesh, rarefaction, wall
        self.components = Components(operator)
        setup, panels = kernel_arguments(mesh, rarefaction, quadrature)
        table, scale = ray_table(operator, highest_power(self.components))
        norms, odd, numbers = harmonic_arguments(self.components)
        moved = len(self.components.translation)
        at_start = table[0, 3, table.shape[2] // 2 :].copy()
        self.arguments = (
            rarefaction,
            (*setup[:4], table, scale, norms, odd, numbers, moved, at_start),
            panels,
        )
        if operators is None:
            operators = assemble(mesh, rarefaction, quadrature)
        gas = DIATOMIC if operator.molecule.rotates else MONATOMIC
        self.model = LinearSystem(operators, gas, mean_tac, wall=wall)
        self.nodes, self.faces = node_points(mesh), face_points(mesh)

    @property
    def size(self) -> tuple[int, int, int]:
        """Shape of the fields: half, node, moment."""
        return 2, self.mesh.size, self.components.size

    def solve(self, walls: FaceWalls) -> tuple[np.ndarray, int]:
        """Moments of the upper and the mirrored lower half; returns ``fields``, ``iterations``."""
        cold = FaceWalls(walls.tac, (0.0, 0.0))
        zero = np.zeros(self.size)

        def apply(vector: np.ndarray) -> np.ndarray:
            fields = vector.reshape(self.size)
            return self._precondition(fields - self._evaluate(fields, cold)).ravel()

        start = self._precondition(self._evaluate(zero, walls)).ravel()
        solution, iterations = solve_by_gmres(apply, start, _TOLERANCE)
        return solution.reshape(self.size), iterations

    def _precondition(self, residual: np.ndarray) -> np.ndarray:
        upper, lower = gas = self.gas_fields(residual)
        even, odd = (
            lu_solve(factor, part.ravel(), check_finite=False).reshape(upper.shape)
            for factor, part in zip(
                self.model.factors, (0.5 * (upper + lower), 0.5 * (upper - lower)), strict=True
            )
        )
        return residual + (np.stack([even + odd, even - odd]) - gas) @ self._expansion.T

    def _sources(self, fields: np.ndarray) -> np.ndarray:
        """Sources by powers of the speed, from moments of orthonormal functions."""
        components = self.components
        return np.ascontiguousarray(fields @ components.mixing.T @ components.orthonormal)

    def _evaluate(self, fields: np.ndarray, walls: FaceWalls) -> np.ndarray:
        """Moments that follow from given ones and the walls."""
        sources, result = self._sources(fields), np.empty(self.size)
        for face in (0, 1):
            arriving = self.arriving_fluxes(sources, face)
            tac = walls.tac[face]
            velocity = walls.velocity * (1.0 if face == 0 else -1.0)
            diffuse = self.model.diffuse_share(tac)
            temperature = self.model.emitted_temperature(
                tac, walls.temperature[face], velocity, arriving
            )
            density = np.sqrt(np.pi) * (2.0 * arriving[:, 0] + velocity)
            shares = np.array([diffuse, 1.0 - diffuse])
            moved = (4.0 - 2.0 * diffuse) * velocity
            half = sources[face], sources[1 - face], shares, density, temperature, moved
            arrival.evaluate(self.nodes, False, *self.arguments, half, result[face])
        return result @ self.components.orthonormal.T

    def arriving_fluxes(self, sources: np.ndarray, face: int) -> np.ndarray:
        """Fluxes that arrive at a face, shape (e, 4)."""
        e = self.faces.shape[0]
        fluxes, unused = np.empty((e, arrival.FLUXES)), np.zeros(e)
        half = (sources[face], sources[1 - face], np.zeros(2), unused, unused, 0.0)
        arrival.evaluate(self.faces, True, *self.arguments, half, fluxes)
        return fluxes

    def face_results(self, walls: FaceWalls, fields: np.ndarray) -> list[FaceResult]:
        """Pressure on the top and bottom face and heat flux out of them."""
        sources = self._sources(fields)
        return [
            result_of_arriving(self.model, walls, self.arriving_fluxes(sources, face), face)
            for face in (0, 1)
        ]

    def gas_fields(self, fields: np.ndarray) -> np.ndarray:
        """What moments say of the gas, shape (2, n, 6 or 9); ``fields`` (2, n, fields)."""
        return fields @ self._readings.T

    @cached_property
    def _readings(self) -> np.ndarray:
        """Gas fields of each orthonormal function, shape (6 or 9, fields)."""
        speed, weight = maxwellian_nodes()
        root = np.sqrt(3.0)  # c_z = c Y/√3
        wanted = [
            (0, 0, False, 2.0 / 3.0 * speed**2),
            (1, 1, False, speed / root),
            (1, 0, False, speed / root),
            (0, 0, False, 2.0 / 3.0 * (speed**2 - 1.5)),
            (1, 1, False, speed * (speed**2 - 2.5) / root),
            (1, 0, False, speed * (speed**2 - 2.5) / root),
            (0, 0, True, np.ones_like(speed)),
            (1, 1, True, speed / root),
            (1, 0, True, speed / root),
        ]
        rotates = self.components.rotation.size > 0
        moments = self.components.operator.moments
        readings = np.zeros((9 if rotates else 6, self.components.size))
        for row, (degree, order, turning, value) in zip(readings, wanted, strict=False):
            for i, (*which, a, turns) in enumerate(self.components.names):
                if (*which, turns) == (degree, order, turning):
                    row[i] = np.sum(weight * value * speed ** moments.powers(degree)[a])
        return readings @ self.components.orthonormal.T

    @cached_property
    def _expansion(self) -> np.ndarray:
        """Orthonormal functions of the gas of the model equation, shape (fields, 6 or 9)."""
        components = self.components
        few = [
            index
            for index, (degree, _, a, turns) in enumerate(components.names)
            if degree < 2 and a < (1 if turns else 2)  # the powers of the model's fields
        ]
        functions = components.orthonormal @ components.weights[:, few]
        return functions @ np.linalg.inv(self._readings @ functions)


_COARSER = Resolution(3, 0.7, Quadrature(3, 3, 3))

_THIN_DEPTH = 1.5  # Rarefaction δ below which the coarse mesh is right to 6·10⁻⁴ in force


def solve_at_two_levels(case: Case, molecule: Molecule) -> tuple[DiskOutcome, DiskOutcome]:
    """Solve a linear case, and once more with a coarser mesh and fewer moments for the error."""
    fine, coarse = (COARSE, _COARSER) if case.rarefaction < _THIN_DEPTH else (MEDIUM, COARSE)
    coarser = solve_molecules(case, coarse, molecule, moments=FEWER_MOMENTS)
    return solve_molecules(case, fine, molecule), coarser


def solve_molecules(
    case: Case,
    resolution: Resolution,
    molecule: Molecule,
    *,
    moments: Moments = MOMENTS,
    operators: Operators | None = None,
) -> DiskOutcome:
    """Solve a linear case for molecules on one mesh."""
    mesh = resolution.mesh(case.rarefaction, case.boundary)
    problem = MolecularProblem(
        mesh,
        case.rarefaction,
        resolution.quadrature,
        CollisionOperator(molecule, moments),
        0.5 * sum(case.tac),
        case.wall,
        operators,
    )
    walls = FaceWalls(case.tac, case.perturbation)
    fields, iterations = problem.solve(walls)
    force, heat = totals(mesh, problem.face_results(walls, fields))
    return DiskOutcome(force, heat, problem.gas_fields(fields), iterations, mesh)
