"""The linear disk problem of real molecules: many moments, solved by GMRES without matrices."""

from functools import cached_property

import numpy as np
from scipy.linalg import lu_solve

from lightflyer.kinetic_theory.collisions import arrival
from lightflyer.kinetic_theory.collisions.brackets import maxwellian_nodes
from lightflyer.kinetic_theory.collisions.components import (
    Components,
    harmonic_arguments,
    highest_power,
)
from lightflyer.kinetic_theory.collisions.operator import CollisionOperator
from lightflyer.kinetic_theory.collisions.tables import ray_table
from lightflyer.kinetic_theory.disk.linear import (
    FaceResult,
    LinearSystem,
    Walls,
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
from lightflyer.kinetic_theory.model_gases import DIATOMIC, MONATOMIC
from lightflyer.kinetic_theory.walls import Wall

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

    def solve(self, walls: Walls) -> tuple[np.ndarray, int]:
        """Moments of the upper and the mirrored lower half; returns ``fields``, ``iterations``."""
        cold = Walls(walls.tac, (0.0, 0.0))
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

    def _evaluate(self, fields: np.ndarray, walls: Walls) -> np.ndarray:
        """Moments that follow from given ones and the walls."""
        sources, result = self._sources(fields), np.empty(self.size)
        for face in (0, 1):
            half = self._half(sources, walls, face, self.arriving_fluxes(sources, face))
            arrival.evaluate(self.nodes, False, *self.arguments, half, result[face])
        return result @ self.components.orthonormal.T

    def arriving_fluxes(self, sources: np.ndarray, face: int) -> np.ndarray:
        """Fluxes that arrive at a face, shape (e, 4)."""
        e = self.faces.shape[0]
        fluxes, unused = np.empty((e, arrival.FLUXES)), np.zeros(e)
        half = (sources[face], sources[1 - face], np.zeros(2), unused, unused, 0.0)
        arrival.evaluate(self.faces, True, *self.arguments, half, fluxes)
        return fluxes

    def face_results(self, walls: Walls, fields: np.ndarray) -> list[FaceResult]:
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

    def _half(self, sources: np.ndarray, walls: Walls, face: int, arriving: np.ndarray) -> tuple:
        tac = walls.tac[face]
        velocity = walls.velocity * (1.0 if face == 0 else -1.0)
        diffuse = self.model.diffuse_share(tac)
        temperature = self.model.emitted_temperature(
            tac, walls.temperature[face], velocity, arriving
        )
        density = np.sqrt(np.pi) * (2.0 * arriving[:, 0] + velocity)
        shares = np.array([diffuse, 1.0 - diffuse])
        moved = (4.0 - 2.0 * diffuse) * velocity
        return sources[face], sources[1 - face], shares, density, temperature, moved
