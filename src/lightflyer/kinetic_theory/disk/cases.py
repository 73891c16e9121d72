"""Cases of the disk problem and their solution on one mesh, and the fields around the disk."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from lightflyer.core.errors import ConvergenceError
from lightflyer.kinetic_theory.disk.linear import FaceResult, FaceWalls, LinearSystem, face_result
from lightflyer.kinetic_theory.disk.nonlinear import HotDisk, NonlinearProblem
from lightflyer.kinetic_theory.disk.operators import Quadrature, assemble, kernel_arguments
from lightflyer.kinetic_theory.disk.scattering import Scattering, ScatteringSystem, assemble_modes
from lightflyer.kinetic_theory.grid.interpolation import bases_at, interpolate, nodes_in_eta
from lightflyer.kinetic_theory.grid.kernels import kernel
from lightflyer.kinetic_theory.grid.mesh import Mesh, build_mesh
from lightflyer.kinetic_theory.grid.rays import spheroidal
from lightflyer.kinetic_theory.model_gases import GasModel
from lightflyer.kinetic_theory.walls import (
    CERCIGNANI_LAMPIS,
    Accommodation,
    FreeMolecularDisk,
    Wall,
)

if TYPE_CHECKING:
    from lightflyer.kinetic_theory.collisions.brackets import Molecule

SMALLEST_ERROR = {"force_ratio": 1e-4, "heat_ratio": 5e-5}
"""Least error that is stated, where two meshes happen to agree better."""


@dataclass(frozen=True)
class Resolution:
    """Nodes per panel, refinement of the panels and numbers of Gauss nodes."""

    order: int
    refinement: float
    quadrature: Quadrature

    def mesh(self, rarefaction: float, boundary: float) -> Mesh:
        return build_mesh(
            rarefaction, boundary=boundary, order=self.order, refinement=self.refinement
        )


# relative errors in force at Kn 1, 0.1 and 0.03: 1e-5, 1e-5, 6e-4; 2e-5, 2e-4, 2e-3; and 1e-4,
# 4e-3, 2e-4, by comparison with six nodes, twice the panels and 8, 8, 6 in the quadratures
FINE = Resolution(5, 1.0, Quadrature(6, 6, 5))
MEDIUM = Resolution(5, 0.7, Quadrature(4, 4, 4))
COARSE = Resolution(4, 0.7, Quadrature(3, 3, 3))

TOLERANCE = 1e-6  # Of the non-linear equation, relative
_THIN = 0.3
"""Knudsen number above which the medium mesh is accurate to 2·10⁻⁴: the fine one is not needed."""


def meshes(knudsen: float, *, linear: bool) -> tuple[Resolution, Resolution]:
    """The mesh of a result, and the coarser one for its error."""
    return (FINE, MEDIUM) if linear and knudsen < _THIN else (MEDIUM, COARSE)


@dataclass(frozen=True)
class Case:
    """A disk in a gas; pairs are top, bottom."""

    rarefaction: float  # δ = √π/(4 Kn)
    tac: tuple[float, float]
    # Perturbations in the linear problem; T_h/T_c in the non-linear one
    temperature: tuple[float, float]
    linear: bool
    gas: GasModel
    boundary: float  # Half-width of the cylindrical reservoir [disk radii], infinite in open space
    open_fraction: float = 0.0  # Share of the molecules arriving at a face that pass the disk
    wall: Wall = "maxwell"
    # Faces of Cercignani and Lampis, in place of ``wall``
    scattering: tuple[Accommodation, Accommodation] | None = None
    # What collides by the real operator, in place of the gas's model equation
    molecule: "Molecule | None" = None

    @property
    def wall_name(self) -> str:
        """Walls, by the name that they are given."""
        return CERCIGNANI_LAMPIS if self.scattering else self.wall

    @property
    def perturbation(self) -> tuple[float, float]:
        """Relative temperature difference of each face to the gas, T_h/T_c − 1."""
        top, bottom = self.temperature
        return (top, bottom) if self.linear else (top - 1.0, bottom - 1.0)

    def free_molecular(self) -> FreeMolecularDisk:
        """Force and heat without collisions."""
        return FreeMolecularDisk(
            self.tac,
            self.temperature,
            self.linear,
            self.gas.has_rotation,
            self.open_fraction,
            "accommodated" if self.scattering else self.wall,
            self.scattering and (self.scattering[0].normal, self.scattering[1].normal),
        )


@dataclass(frozen=True)
class DiskOutcome:
    """A solved case on one mesh."""

    force: float  # Upwards [p·A]
    heat: tuple[float, float]  # Out of each face [p √(2RT_c) A]
    # shape (2, n, 6 or 9); at the nodes of the upper and the mirrored lower half
    fields: np.ndarray
    iterations: int
    mesh: Mesh


def solve_case(
    case: Case, resolution: Resolution, *, start: np.ndarray | None = None
) -> DiskOutcome:
    """Solve a case on one mesh."""
    mesh = resolution.mesh(case.rarefaction, case.boundary)
    operators = assemble(mesh, case.rarefaction, resolution.quadrature)
    if case.scattering is not None and case.linear:
        rows = assemble_modes(operators, case.rarefaction, resolution.quadrature)
        scatterer = ScatteringSystem(operators, rows, case.gas, case.open_fraction)
        top, bottom = (
            Scattering(*face, temperature)
            for face, temperature in zip(case.scattering, case.temperature, strict=True)
        )
        fields, faces = scatterer.solve(top, bottom)
        return _outcome(mesh, fields, faces, 1)
    mean = 0.5 * sum(case.tac)
    system = LinearSystem(operators, case.gas, mean, case.open_fraction, case.wall)
    walls = FaceWalls(case.tac, case.perturbation, open_fraction=case.open_fraction)
    if case.linear:
        fields, iterations = system.solve(walls)
        faces = [face_result(system, walls, fields[face], face) for face in (0, 1)]
    else:
        problem = NonlinearProblem(system, case.rarefaction, resolution.quadrature)
        disk = HotDisk(case.tac, case.temperature, case.open_fraction, case.wall, case.scattering)
        if start is None:
            start = system.solve(walls)[0]
        fields, iterations = problem.solve(disk, start, TOLERANCE)
        faces = [problem.face_result(fields, face, disk) for face in (0, 1)]
    return _outcome(mesh, fields, faces, iterations)


def _outcome(
    mesh: Mesh, fields: np.ndarray, faces: list[FaceResult], iterations: int
) -> DiskOutcome:
    force, heat = totals(mesh, faces)
    if not np.isfinite(force):
        raise ConvergenceError("the kinetic equation gave no finite force")
    return DiskOutcome(force, heat, fields, iterations, mesh)


def totals(mesh: Mesh, faces: list[FaceResult]) -> tuple[float, tuple[float, float]]:
    """Force on a disk and heat out of its faces, from those of a unit area."""
    weights = mesh.face_weights
    force = float(weights @ (faces[1].pressure - faces[0].pressure))
    return force, (float(weights @ faces[0].heat), float(weights @ faces[1].heat))


_NAMES = (
    "pressure",
    "velocity_radial",
    "velocity_axial",
    "temperature",
    "heat_flux_radial",
    "heat_flux_axial",
    "rotational_temperature",
)


@kernel
def _sample(points, halves, upper, lower, values):
    order, eta_size = upper[3].shape[2], nodes_in_eta(upper)
    xi_basis, eta_basis = np.empty(order), np.empty(order)
    for p in range(points.shape[0]):
        xi, eta = spheroidal(points[p, 0] ** 2, points[p, 1])
        mesh, fields = (upper, halves[0]) if points[p, 1] >= 0.0 else (lower, halves[1])
        i, j = bases_at(max(xi, 1e-12), eta, mesh, xi_basis, eta_basis)
        interpolate(fields, i, j, eta_size, xi_basis, eta_basis, values[p])
        scale = np.sqrt(max(0.0, 1.0 - eta * eta))
        values[p, 1] *= scale
        values[p, 4] *= scale
        if points[p, 1] < 0.0:  # the lower half is kept mirrored
            values[p, 2] *= -1.0
            values[p, 5] *= -1.0


def sample(outcome: DiskOutcome, radius: Any, height: Any) -> dict[str, np.ndarray]:
    """Fields at points, by the solver's own interpolation; ``radius``, ``height`` [disk radii]."""
    meshes = outcome.mesh, outcome.mesh
    return sample_halves(meshes, outcome.fields, np.asarray(radius), np.asarray(height))


def sample_halves(
    meshes: tuple[Mesh, Mesh], halves: np.ndarray, radius: np.ndarray, height: np.ndarray
) -> dict[str, np.ndarray]:
    """Fields at points in halves that need not be alike; ``halves`` (2, n, 6 or 9)."""
    radius, height = np.broadcast_arrays(radius, height)
    points = np.stack([radius.ravel(), height.ravel()], axis=1)
    upper, lower = (kernel_arguments(mesh, 1.0, COARSE.quadrature)[1] for mesh in meshes)
    values = np.empty((points.shape[0], halves.shape[-1]))
    _sample(points, halves, upper, lower, values)
    beyond = (radius > meshes[0].boundary) | (height > meshes[0].ceiling)
    beyond |= height < -meshes[1].ceiling
    values[beyond.ravel()] = np.nan
    names = _NAMES[: 7 if values.shape[1] > 6 else 6]
    return {name: values[:, k].reshape(radius.shape) for k, name in enumerate(names)}
