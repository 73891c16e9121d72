"""Non-linear problem: two hot faces, solved by preconditioned Anderson acceleration.

The preconditioner contains all that is stiff, so that the number of steps hardly depends on the
Knudsen number. In thin gas it is the linear problem's factors, in dense gas those of the equation
linearised about the temperatures of the hot gas.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.linalg import lu_solve

from lightflyer.core.errors import ConvergenceError
from lightflyer.core.progress import report
from lightflyer.kinetic_theory.disk import nonlinear_kernel
from lightflyer.kinetic_theory.disk.linear import FaceResult, LinearSystem
from lightflyer.kinetic_theory.disk.operators import (
    BaseState,
    Quadrature,
    assemble,
    face_points,
    kernel_arguments,
    node_points,
)
from lightflyer.kinetic_theory.walls import Accommodation, Wall

_MOST_ITERATIONS = 60
_MEMORY = 12
_RENEWED = 0.03  # residual below which the preconditioner is renewed, once
_THIN_GAS = 1.0  # δ up to which the linear problem's factors precondition as well


class FixedPoint(NamedTuple):
    """A state of the gas is looked for of which nothing is missing."""

    # What follows from a state, less that state; of its shape
    missing: Callable[[np.ndarray], np.ndarray]
    # From what is missing, the step that would leave nothing missing in the linear problem
    precondition: Callable[[np.ndarray], np.ndarray]
    renew: Callable[[np.ndarray], None]  # Precondition by the equation linearised about a state
    # From a state and a new one, one on the way where what must stay positive at most halves
    damped: Callable[[np.ndarray, np.ndarray], np.ndarray]


def iterate(
    problem: FixedPoint, start: np.ndarray, tolerance: float, rarefaction: float
) -> tuple[np.ndarray, np.ndarray, int]:
    """Iterate until nothing is missing; returns ``state``, ``step``, ``iterations``."""
    renewable = rarefaction > _THIN_GAS
    if renewable:
        problem.renew(start)
    state, residual = start.copy(), np.inf
    steps: list[np.ndarray] = []
    states: list[np.ndarray] = []
    for iteration in range(1, _MOST_ITERATIONS + 1):
        missing = problem.missing(state)
        step = problem.precondition(missing)
        residual = float(np.abs(step).max())
        report(f"solving the non-linear equation, residual {residual:.1e}")
        if residual < tolerance:
            return state, step, iteration
        if not np.isfinite(residual):
            raise ConvergenceError("the non-linear kinetic equation diverged")
        if renewable and residual < _RENEWED:
            # the temperatures are now accurate enough to precondition about
            renewable = False
            problem.renew(state)
            step, steps, states = problem.precondition(missing), [], []
        steps.append(step.ravel())
        states.append(state.ravel())
        del steps[:-_MEMORY], states[:-_MEMORY]
        state = problem.damped(state, _anderson(states, steps).reshape(state.shape))
    raise ConvergenceError(
        f"the non-linear kinetic equation did not converge in {_MOST_ITERATIONS} iterations: "
        f"last residual {residual:.1e}"
    )


def _anderson(states: list[np.ndarray], steps: list[np.ndarray]) -> np.ndarray:
    """Next state by Anderson mixing of the last states and their steps."""
    if len(steps) == 1:
        return states[-1] + steps[-1]
    differences = np.stack([steps[-1] - step for step in steps[:-1]], axis=1)
    weights = np.linalg.lstsq(differences, steps[-1], rcond=1e-12)[0]
    state, step = states[-1].copy(), steps[-1].copy()
    for k, weight in enumerate(weights):
        state -= weight * (states[-1] - states[k])
        step -= weight * (steps[-1] - steps[k])
    return state + step


_SQRT_PI = np.sqrt(np.pi)

# Number, normal momentum, energy, rotational energy and energy of normal motion that a slow stream
# takes from those that arrive at a face which it leaves, per its speed
_STREAM_FLUXES = np.array([0.5, 1.0 / _SQRT_PI, 1.25, 0.5, 0.0, 0.75])


@dataclass(frozen=True)
class HotDisk:
    """Two faces, top and bottom: TAC and temperature over the gas's far away."""

    # Of the molecules that arrive at a face, the share ``open_fraction`` passes the disk.

    tac: tuple[float, float]
    temperature: tuple[float, float]
    open_fraction: float = 0.0
    wall: Wall = "maxwell"
    # Faces of Cercignani and Lampis, in place of ``tac``
    scattering: tuple[Accommodation, Accommodation] | None = None
    # Of the gas far away: slow velocity upwards [√(2RT_c)], and excess of temperature there over
    # the cosine to the axis
    stream: tuple[float, float] = (0.0, 0.0)

    def away(self, face: int) -> np.ndarray:
        """The stream as seen from a face: its speed away from it, and its warmth."""
        return np.array(self.stream) * (1.0 if face == 0 else -1.0)

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
    arriving: np.ndarray,
    face: float | Accommodation,
    temperature: np.ndarray | float,
    wall: Wall,
    rotates: bool,
) -> np.ndarray:
    """What leaves a wall diffusely, as many molecules as arrive, shape (4, e)."""
    # Density, and temperatures of normal motion, tangential motion and rotation. ``face`` is a TAC,
    # or what accommodates the three each on its own. Their distributions are taken to be
    # Maxwell's, as they are where those of the molecules that arrive are.
    flux = 1.0 + 2.0 * _SQRT_PI * arriving[:, 0]
    emitted = np.empty((4, flux.size))
    emitted[1:] = temperature
    if wall != "maxwell":
        number, _, energy, turning, _, normal = arriving.T
        kinds = np.stack([normal, energy - normal, turning if rotates else number])
        arrived = 1.0 + 2.0 * _SQRT_PI * (kinds - number) / flux
        if isinstance(face, Accommodation):
            shares = np.array(face.of_energy)[:, None]
        else:
            shares, arrived = np.array(face), arrived[: 3 if rotates else 2].mean(axis=0)
        emitted[1:] = shares * emitted[1:] + (1.0 - shares) * arrived
    emitted[0] = flux / np.sqrt(emitted[1])
    return emitted


def result_of(
    arriving: np.ndarray, emitted: np.ndarray, diffuse: float, rotates: bool
) -> FaceResult:
    """Normal pressure on a face and heat flux out of it, less those of the gas at rest."""
    density, normal, tangential, turning = emitted
    flux = density * np.sqrt(normal)
    pressure = diffuse * (density * normal - 1.0) / 4.0 + (2.0 - diffuse) * arriving[:, 1]
    heat = diffuse * ((0.5 * flux * (normal + tangential) - 1.0) / _SQRT_PI - arriving[:, 2])
    if rotates:
        heat += diffuse * (0.5 * (flux * turning - 1.0) / _SQRT_PI - arriving[:, 3])
    return FaceResult(2.0 * pressure, heat)


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

    def _half(self, fields: np.ndarray, face: int, disk: HotDisk, emitted: np.ndarray) -> tuple:
        solid, diffuse = 1.0 - disk.open_fraction, disk.diffuse_share(face)
        shares = np.array([solid * diffuse, solid * (1.0 - diffuse), disk.open_fraction])
        nothing = np.zeros((2, 0))
        return fields[face], fields[1 - face], emitted, shares, nothing, nothing, disk.away(face)

    def arriving_fluxes(self, fields: np.ndarray, face: int, disk: HotDisk) -> np.ndarray:
        """Fluxes that arrive at a face, less those of the gas at rest, shape (e, 6)."""
        fluxes, unused = np.empty((self.faces.shape[0], 6)), np.ones((4, self.faces.shape[0]))
        half = self._half(fields, face, disk, unused)
        nonlinear_kernel.evaluate(self.faces, True, *self.arguments, self.gas, half, fluxes)
        fluxes -= disk.away(face)[0] * _STREAM_FLUXES
        return fluxes

    def emission(self, arriving: np.ndarray, face: int, disk: HotDisk) -> np.ndarray:
        """What leaves a face diffusely, shape (4, e), as :func:`diffuse_emission`."""
        temperature, rotates = disk.temperature[face], self.system.gas.has_rotation
        accommodated = (disk.scattering or disk.tac)[face]
        return diffuse_emission(arriving, accommodated, temperature, disk.wall, rotates)

    def evaluate(self, fields: np.ndarray, disk: HotDisk) -> np.ndarray:
        """Fields that follow from given fields, shape (2, n, fields)."""
        result = np.empty_like(fields)
        for face in (0, 1):
            emitted = self.emission(self.arriving_fluxes(fields, face, disk), face, disk)
            result[face] = self.half_fields(fields, face, disk, emitted)
        return result

    def half_fields(
        self, fields: np.ndarray, face: int, disk: HotDisk, emitted: np.ndarray
    ) -> np.ndarray:
        """Fields of one half that follow from given fields and what its face emits."""
        result = np.empty_like(fields[face])
        half = self._half(fields, face, disk, emitted)
        nonlinear_kernel.evaluate(self.nodes, False, *self.arguments, self.gas, half, result)
        return result + self.system.uniform_correction(fields[face])

    def precondition_about(self, fields: np.ndarray, disk: HotDisk) -> None:
        """Precondition by the equation linearised about the temperatures of given fields."""
        operators = self.system.operators
        gas = self.system.gas
        excess = 0.5 * (fields[0, :, 3] + fields[1, :, 3])  # the same in both halves
        base = BaseState(
            excess=(excess, excess),
            face=0.5 * sum(disk.uncollided_temperature),
            frequency_exponent=-1.0 - gas.viscosity_exponent,
        )
        about = assemble(operators.mesh, self.rarefaction, self.quadrature, base)
        diagonal = np.arange(operators.mesh.size)
        about.own[diagonal, diagonal] += operators.corrections
        system = LinearSystem(about, gas, self.system.mean_tac, disk.open_fraction, disk.wall)
        self.factors = system.factors

    def solve(self, disk: HotDisk, start: np.ndarray, tolerance: float) -> tuple[np.ndarray, int]:
        """Iterate to a fixed point; returns ``fields`` (2, n, fields), ``iterations``."""
        problem = FixedPoint(
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
        arriving = self.arriving_fluxes(fields, face, disk)
        emitted = self.emission(arriving, face, disk)
        found = result_of(arriving, emitted, disk.diffuse_share(face), self.system.gas.has_rotation)
        solid = 1.0 - disk.open_fraction
        return FaceResult(solid * found.pressure, solid * found.heat)


def damp(old: np.ndarray, new: np.ndarray) -> np.ndarray:
    """Fields on the way to new ones, where pressure and temperature at most halve."""
    share = 1.0
    for field in (0, 3):
        value, change = 1.0 + old[..., field], new[..., field] - old[..., field]
        share = min(share, 0.5 / max(0.5, float((-change / value).max())))
    return old + share * (new - old)
