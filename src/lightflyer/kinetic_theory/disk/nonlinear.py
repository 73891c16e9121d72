"""Non-linear problem: two hot faces, solved by preconditioned Anderson acceleration.

The preconditioner contains all that is stiff, so that the number of steps hardly depends on the
Knudsen number. In thin gas it is the linear problem's factors, in dense gas those of the equation
linearised about the temperatures of the hot gas.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import lu_solve

from lightflyer.kinetic_theory.disk import nonlinear_kernel
from lightflyer.kinetic_theory.disk.fixed_point import Problem, iterate
from lightflyer.kinetic_theory.disk.linear import FaceResult, LinearSystem
from lightflyer.kinetic_theory.disk.operators import (
    BaseState,
    Quadrature,
    assemble,
    face_points,
    kernel_arguments,
    node_points,
)
from lightflyer.kinetic_theory.walls import Wall

_SQRT_PI = np.sqrt(np.pi)


@dataclass(frozen=True)
class HotDisk:
    """Two faces, top and bottom: TAC and temperature over the gas's far away."""

    # Of the molecules that arrive at a face, the share ``open_fraction`` passes the disk.

    tac: tuple[float, float]
    temperature: tuple[float, float]
    open_fraction: float = 0.0
    wall: Wall = "maxwell"

    def diffuse_share(self, face: int) -> float:
        """Share of the molecules meeting a face that leaves it diffusely [1]."""
        return self.tac[face] if self.wall == "maxwell" else 1.0

    @property
    def uncollided_temperature(self) -> tuple[float, float]:
        """Temperature of the diffuse molecules where those that arrive have met no others."""
        if self.wall == "maxwell":
            return self.temperature
        top, bottom = (
            1.0 + tac * (temperature - 1.0)
            for tac, temperature in zip(self.tac, self.temperature, strict=True)
        )
        return top, bottom


def diffuse_emission(
    arriving: np.ndarray, tac: float, temperature: np.ndarray | float, wall: Wall, rotates: bool
) -> tuple[np.ndarray, np.ndarray]:
    """Density and temperature of the molecules that leave a wall diffusely, as many as arrive."""
    flux = 1.0 + 2.0 * _SQRT_PI * arriving[:, 0]
    emitted = np.broadcast_to(np.asarray(temperature, float), flux.shape)
    if wall == "accommodated":
        energy = arriving[:, 2] - 2.0 * arriving[:, 0]
        if rotates:
            energy = energy + arriving[:, 3] - arriving[:, 0]
        excess = 2.0 * _SQRT_PI / (3.0 if rotates else 2.0) * energy / flux
        emitted = 1.0 + tac * (emitted - 1.0) + (1.0 - tac) * excess
    return flux / np.sqrt(emitted), np.ascontiguousarray(emitted)


class NonlinearProblem:
    """Non-linear problem on the mesh of a linear system."""

    def __init__(self, system: LinearSystem, rarefaction: float, quadrature: Quadrature) -> None:
        self.system, self.rarefaction = system, rarefaction
        gas, mesh = system.gas, system.operators.mesh
        setup, panels = kernel_arguments(mesh, rarefaction, quadrature)
        self.arguments = (rarefaction, setup, panels, panels)
        self.quadrature = quadrature
        self.gas = gas.of_kernel
        self.nodes, self.faces = node_points(mesh), face_points(mesh)
        self.factors = system.factors

    def _half(
        self,
        fields: np.ndarray,
        face: int,
        disk: HotDisk,
        emitted: tuple[np.ndarray, np.ndarray],
    ) -> tuple:
        solid, diffuse = 1.0 - disk.open_fraction, disk.diffuse_share(face)
        shares = np.array([solid * diffuse, solid * (1.0 - diffuse), disk.open_fraction])
        density, temperature = emitted
        nothing = np.zeros((2, 0))
        return fields[face], fields[1 - face], density, shares, temperature, nothing, nothing

    def arriving_fluxes(self, fields: np.ndarray, face: int, disk: HotDisk) -> np.ndarray:
        """Fluxes that arrive at a face, less those of the gas at rest, shape (e, 5)."""
        fluxes, unused = np.empty((self.faces.shape[0], 5)), np.ones(self.faces.shape[0])
        half = self._half(fields, face, disk, (unused, unused))
        nonlinear_kernel.evaluate(self.faces, True, *self.arguments, self.gas, half, fluxes)
        return fluxes

    def emission(
        self, arriving: np.ndarray, face: int, disk: HotDisk
    ) -> tuple[np.ndarray, np.ndarray]:
        """Density and temperature of the diffuse molecules: as many leave as arrive, shape (e,)."""
        temperature, rotates = disk.temperature[face], self.system.gas.has_rotation
        return diffuse_emission(arriving, disk.tac[face], temperature, disk.wall, rotates)

    def evaluate(self, fields: np.ndarray, disk: HotDisk) -> np.ndarray:
        """Fields that follow from given fields, shape (2, n, fields)."""
        result = np.empty_like(fields)
        for face in (0, 1):
            emitted = self.emission(self.arriving_fluxes(fields, face, disk), face, disk)
            half = self._half(fields, face, disk, emitted)
            nonlinear_kernel.evaluate(
                self.nodes, False, *self.arguments, self.gas, half, result[face]
            )
            result[face] += self.system.uniform_correction(fields[face])
        return result

    def precondition_about(self, fields: np.ndarray, disk: HotDisk) -> None:
        """Precondition by the equation linearised about the temperatures of given fields."""
        operators = self.system.operators
        gas = self.system.gas
        base = BaseState(
            excess=0.5 * (fields[0, :, 3] + fields[1, :, 3]),
            face=0.5 * sum(disk.uncollided_temperature),
            frequency_exponent=-1.0 - gas.viscosity_exponent,
        )
        about = assemble(operators.mesh, self.rarefaction, self.quadrature, base)
        diagonal = np.arange(operators.mesh.size)
        about.own[diagonal, diagonal] += operators.corrections
        system = LinearSystem(about, gas, self.system.mean_tac, disk.open_fraction, disk.wall)
        self.factors = system.factors

    def solve(
        self,
        disk: HotDisk,
        start: np.ndarray,
        tolerance: float,
    ) -> tuple[np.ndarray, int]:
        """Iterate to a fixed point; returns ``fields`` (2, n, fields), ``iterations``."""
        problem = Problem(
            lambda fields: self.evaluate(fields, disk) - fields,
            self._precondition,
            lambda fields: self.precondition_about(fields, disk),
            damp,
        )
        fields, step, iterations = iterate(problem, start, tolerance, self.rarefaction)
        return fields + step, iterations

    def _precondition(self, residual: np.ndarray) -> np.ndarray:
        parts = 0.5 * (residual[0] + residual[1]), 0.5 * (residual[0] - residual[1])
        even, odd = (
            lu_solve(factor, part.ravel(), check_finite=False).reshape(part.shape)
            for factor, part in zip(self.factors, parts, strict=True)
        )
        return np.stack([even + odd, even - odd])

    def face_result(self, fields: np.ndarray, face: int, disk: HotDisk) -> FaceResult:
        """Normal pressure on a face and heat flux out of it, less those of the gas at rest."""
        diffuse = disk.diffuse_share(face)
        arriving = self.arriving_fluxes(fields, face, disk)
        density, temperature = self.emission(arriving, face, disk)
        pressure = diffuse * (density * temperature - 1.0) / 4.0 + (2.0 - diffuse) * arriving[:, 1]
        emitted = (density * temperature**1.5 - 1.0) / _SQRT_PI
        heat = diffuse * (emitted - arriving[:, 2])
        if self.system.gas.has_rotation:
            heat = heat + diffuse * (0.5 * emitted - arriving[:, 3])
        solid = 1.0 - disk.open_fraction
        return FaceResult(2.0 * solid * pressure, solid * heat)


def damp(old: np.ndarray, new: np.ndarray) -> np.ndarray:
    """Fields on the way to new ones, where pressure and temperature at most halve."""
    share = 1.0
    for field in (0, 3):
        value, change = 1.0 + old[..., field], new[..., field] - old[..., field]
        share = min(share, 0.5 / max(0.5, float((-change / value).max())))
    return old + share * (new - old)
