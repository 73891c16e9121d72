"""Cases of a disk in a chamber on one mesh: hot ones, and films whose spots balance their heat.

Non-linear problem of a hot disk between any floor, lid and side wall.

The unknowns are those of :mod:`lightflyer.kinetic_theory.chamber.linear`; σ of a wall is the
excess of the arriving molecules' flux over that of the gas at rest. Its linear system, about the
temperatures of the hot gas where that is dense, preconditions Anderson's iteration.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.linalg import lu_solve

from lightflyer.core.errors import ConvergenceError
from lightflyer.kinetic_theory.chamber.enclosure import Chamber, Film
from lightflyer.kinetic_theory.chamber.half_mesh_operator import (
    HalfOperator,
    assemble_halves,
    wall_quadrature,
)
from lightflyer.kinetic_theory.chamber.linear import NUMBER, ChamberSystem, Totals
from lightflyer.kinetic_theory.disk import nonlinear_kernel
from lightflyer.kinetic_theory.disk.cases import Resolution
from lightflyer.kinetic_theory.disk.linear import FaceResult
from lightflyer.kinetic_theory.disk.nonlinear import (
    FixedPoint,
    diffuse_emission,
    iterate,
    result_of,
)
from lightflyer.kinetic_theory.disk.operators import (
    BaseState,
    Quadrature,
    face_points,
    kernel_arguments,
    node_points,
)
from lightflyer.kinetic_theory.grid.interpolation import interpolate_on_face
from lightflyer.kinetic_theory.grid.mesh import Mesh, build_chamber_meshes
from lightflyer.kinetic_theory.model_gases import GasModel

if TYPE_CHECKING:
    from lightflyer.kinetic_theory.chamber.linear import SystemLayout

_SQRT_PI = np.sqrt(np.pi)
_LARGEST_STEP = 0.5  # of pressures and temperatures, relative
_ROTATIONAL, _AXIAL = 3, 4  # places of fluxes of the compiled kernel


@dataclass(frozen=True)
class Arrivals:
    """Fluxes less those of the gas at rest at the disk and at walls, of both halves."""

    # ``emitted`` is what leaves the faces of the disk.

    faces: list[np.ndarray]
    emitted: list[np.ndarray]
    walls: list[np.ndarray]


class HotChamber:
    """Non-linear problem on the halves of a linear system."""

    def __init__(self, system: ChamberSystem, rarefaction: float, quadrature: Quadrature) -> None:
        self.system, self.rarefaction, self.quadrature = system, rarefaction, quadrature
        self.gas = system.gas.of_kernel
        meshes = [half.mesh for half in system.halves]
        self.panels = [kernel_arguments(mesh, rarefaction, quadrature)[1] for mesh in meshes]
        self.setup = kernel_arguments(meshes[0], rarefaction, quadrature)[0]
        at_walls = wall_quadrature(quadrature)
        self.wall_setup = kernel_arguments(meshes[0], rarefaction, at_walls)[0]
        self.nodes = [node_points(mesh) for mesh in meshes]
        self.faces = [face_points(mesh) for mesh in meshes]
        self.factors = system.factors

    # ------------------------------------------------------------------ one evaluation

    def _fields(self, x: np.ndarray, half: int) -> np.ndarray:
        layout = self.system.layout
        return np.ascontiguousarray(x[layout.gas(half)].reshape(layout.n, layout.fields))

    def _rim(self, x: np.ndarray, half: int) -> np.ndarray:
        """Density and temperature of what leaves the walls of a half."""
        layout = self.system.layout
        temperature = 1.0 + x[layout.wall_temperature(half)]
        density = (1.0 + x[layout.wall_sigma(half)]) / np.sqrt(temperature)
        return np.stack([density, temperature])

    def _half(self, x: np.ndarray, half: int, emitted: np.ndarray) -> tuple:
        diffuse = self.system.film.diffuse_share(half)
        return (
            self._fields(x, half),
            self._fields(x, 1 - half),
            emitted,
            np.array([diffuse, 1.0 - diffuse, 0.0]),
            self._rim(x, half),
            self._rim(x, 1 - half),
            np.zeros(2),
        )

    def _run(self, points: np.ndarray, on_wall: bool, half: int, sent: tuple) -> np.ndarray:
        out = np.empty((points.shape[0], 6 if on_wall else self.system.fields))
        nonlinear_kernel.evaluate(
            np.ascontiguousarray(points),
            on_wall,
            self.rarefaction,
            self.wall_setup if on_wall else self.setup,
            self.panels[half],
            self.panels[1 - half],
            self.gas,
            sent,
            out,
        )
        return out

    def evaluate(self, x: np.ndarray) -> tuple[np.ndarray, Arrivals]:
        """What is missing to a solution in each equation, and fluxes at all walls."""
        system, layout = self.system, self.system.layout
        missing = np.zeros(layout.size)
        rotates, film = system.gas.has_rotation, system.film
        faces, emitted, walls = [], [], []
        for half in (0, 1):
            unused = np.ones((4, layout.e))
            arriving = self._run(self.faces[half], True, half, self._half(x, half, unused))
            temperature = 1.0 + x[layout.film(half)]
            face = (film.scattering or film.tac)[half]
            leaves = diffuse_emission(arriving, face, temperature, film.wall, rotates)
            sent = self._half(x, half, leaves)
            found = self._run(self.nodes[half], False, half, sent)
            found += system.uniform_correction(sent[0], half)
            missing[layout.gas(half)] = (found - sent[0]).ravel()
            at_walls = self._run(system.halves[half].rim_points, True, half, sent)
            # by what a gas of uniform density arrives at the walls, of the linear problem
            at_walls[:, :3] *= system.wall_scales[half]
            sigma, warmth = x[layout.wall_sigma(half)], x[layout.wall_temperature(half)]
            new_sigma, new_warmth = np.zeros_like(sigma), np.zeros_like(warmth)
            for _, surface, mask in system.surface_masks(half):
                if surface.solid:
                    hot, met = 1.0 + surface.temperature, at_walls[mask]
                    warm = diffuse_emission(met, surface.tac, hot, "accommodated", rotates)[1]
                    new_sigma[mask] = 2.0 * _SQRT_PI * met[:, NUMBER] + x[layout.leak]
                    new_warmth[mask] = warm - 1.0
            missing[layout.wall_sigma(half)] = new_sigma - sigma
            missing[layout.wall_temperature(half)] = new_warmth - warmth
            faces.append(arriving)
            emitted.append(leaves)
            walls.append(at_walls)
        arrivals = Arrivals(faces, emitted, walls)
        top, bottom = layout.film(0), layout.film(1)
        if not film.local:
            missing[top] = film.temperature[0] - x[top]
            missing[bottom] = film.temperature[1] - x[bottom]
        else:
            missing[top] = x[bottom] - x[top]
            missing[bottom] = x[layout.power] - self.film_loss(x, arrivals)
            if film.absorbed is not None:
                missing[layout.power] = film.absorbed - x[layout.power]
            else:
                missing[layout.power] = film.temperature[0] - system.weights @ x[top]
        if system.chamber is not None and system.chamber.is_closed:
            missing[layout.leak] = -system.equations[0][layout.leak] @ x
        return missing, arrivals

    def film_loss(self, x: np.ndarray, arrivals: Arrivals) -> np.ndarray:
        """Heat that each spot of the film loses by gas on both sides and radiation, shape (e,)."""
        layout, film = self.system.layout, self.system.film
        gas = sum(self._face(arrivals, half).heat for half in (0, 1))
        temperature = 1.0 + x[layout.film(0)]
        return gas + film.radiation * (temperature**4 - 1.0) / 4.0

    # ------------------------------------------------------------------ iteration

    def precondition_about(self, x: np.ndarray) -> None:
        """Precondition by the equation linearised about the temperatures of given unknowns."""
        system, layout = self.system, self.system.layout
        # share of the film's excess that its diffuse molecules have without collisions
        given = 1.0 if system.film.wall == "maxwell" else 0.5 * sum(system.film.tac)
        mean = float(sum(system.weights @ x[layout.film(half)] for half in (0, 1)))
        face = 1.0 + 0.5 * mean * given
        state = BaseState(
            excess=(self._fields(x, 0)[:, 3].copy(), self._fields(x, 1)[:, 3].copy()),
            face=face,
            frequency_exponent=-1.0 - system.gas.viscosity_exponent,
        )
        meshes = system.halves[0].mesh, system.halves[1].mesh
        about = assemble_halves(meshes, self.rarefaction, self.quadrature, state)
        diagonal = np.arange(layout.n)
        for half, linear in zip(about, system.halves, strict=True):
            half.gas.own[diagonal, diagonal] += linear.corrections
        radiation = system.film.radiation * face**3
        film = replace(system.film, radiation=radiation)
        self.factors = ChamberSystem(about, system.gas, system.chamber, film, face).factors

    def solve(self, start: np.ndarray, tolerance: float) -> tuple[np.ndarray, Arrivals, int]:
        """Iterate until nothing is missing; returns ``x`` (size,), ``arrivals``, ``iterations``."""
        arrivals: list[Arrivals] = []

        def missing(x: np.ndarray) -> np.ndarray:
            found, *arrivals[:] = self.evaluate(x)
            return found

        problem = FixedPoint(
            missing,
            lambda missing: lu_solve(self.factors, missing, check_finite=False),
            self.precondition_about,
            self._damp,
        )
        x, _, iterations = iterate(problem, start, tolerance, self.rarefaction)
        return x, arrivals[0], iterations

    def _damp(self, old: np.ndarray, new: np.ndarray) -> np.ndarray:
        """Unknowns on the way to new ones, where pressures and temperatures at most halve."""
        share = 1.0
        for value, change in zip(self._positive(old), self._positive(new), strict=True):
            fall = float(((value - change) / value).max()) if value.size else 0.0
            share = min(share, _LARGEST_STEP / max(_LARGEST_STEP, fall))
        return old + share * (new - old)

    def _positive(self, x: np.ndarray) -> list[np.ndarray]:
        layout = self.system.layout
        values = []
        for half in (0, 1):
            fields = self._fields(x, half)
            values += [1.0 + fields[:, 0], 1.0 + fields[:, 3]]
            places: list[Callable[[int], slice]] = [
                layout.wall_sigma,
                layout.wall_temperature,
                layout.film,
            ]
            values += [1.0 + x[place(half)] for place in places]
        return values

    # ------------------------------------------------------------------ results

    def _face(self, arrivals: Arrivals, half: int) -> FaceResult:
        """Normal pressure on a face and heat out of it, less those of the gas at rest."""
        system, diffuse = self.system, self.system.film.diffuse_share(half)
        found = arrivals.faces[half], arrivals.emitted[half]
        return result_of(*found, diffuse, system.gas.has_rotation)

    def totals(self, x: np.ndarray, arrivals: Arrivals) -> Totals:
        """Forces and heats of all surfaces."""
        weights = self.system.weights
        top, bottom = (self._face(arrivals, half) for half in (0, 1))
        heat = float(weights @ top.heat), float(weights @ bottom.heat)
        totals = Totals(float(weights @ (bottom.pressure - top.pressure)), heat)
        for half in (0, 1):
            arriving, (density, temperature) = arrivals.walls[half], self._rim(x, half)
            recoil = 0.5 * (density * temperature - 1.0)
            emitted = (density * temperature**1.5 - 1.0) / _SQRT_PI
            lost = emitted - arriving[:, 2]
            if self.system.gas.has_rotation:
                lost = lost + 0.5 * emitted - arriving[:, _ROTATIONAL]
            sent = 0.5 * (density * np.sqrt(temperature) - 1.0) / _SQRT_PI - arriving[:, NUMBER]
            self.system.add_walls(totals, half, (arriving[:, _AXIAL], recoil, lost, sent))
        return totals


# between near walls more heights of directions are needed than in open space
FINE = Resolution(5, 1.0, Quadrature(6, 6, 4))
MEDIUM = Resolution(4, 1.0, Quadrature(6, 4, 3))
COARSE = Resolution(3, 1.0, Quadrature(4, 4, 3))

_TOLERANCE = 3e-7  # of the non-linear equation, relative


def meshes(*, linear: bool) -> tuple[Resolution, Resolution]:
    """The mesh of a result, and the coarser one for its error."""
    return (FINE, MEDIUM) if linear else (MEDIUM, COARSE)


@dataclass(frozen=True)
class ChamberCase:
    """A disk in a chamber; temperatures are perturbations, T/T_c − 1."""

    rarefaction: float  # δ = √π/(4 Kn)
    film: Film
    gas: GasModel
    chamber: Chamber | None  # None is open space
    linear: bool

    def meshes(self, resolution: Resolution) -> tuple[Mesh, Mesh]:
        """Meshes of the upper and of the lower half."""
        if self.chamber is None:
            mesh = resolution.mesh(self.rarefaction, np.inf)
            return mesh, mesh
        return build_chamber_meshes(
            self.rarefaction,
            self.chamber.side.distance,
            self.chamber.ceilings,
            order=resolution.order,
            refinement=resolution.refinement,
        )


@dataclass(frozen=True)
class ChamberOutcome:
    """A solved case on one mesh."""

    totals: Totals
    # shape (2, n, 6 or 9); at the nodes of the upper and the mirrored lower half
    fields: np.ndarray
    iterations: int
    meshes: tuple[Mesh, Mesh]
    # shape (2, e); perturbation of the film's temperature at the nodes of its top and bottom
    film: np.ndarray
    # Largest difference of the heat that a spot of the film absorbs and loses, over their mean; 0
    # where the film has a given temperature
    imbalance: float
    absorbed: float  # Heat that the film loses per unit area, by gas and radiation [p √(2RT_c)]
    unknowns: np.ndarray  # shape (size,)

    def film_at(self, radius: np.ndarray) -> np.ndarray:
        """Perturbation of the film's temperature, its mean over both faces, shape (m,)."""
        # ``radius``, shape (m,), is the distance from its centre [disk radii].
        mesh = self.meshes[0]
        panels = kernel_arguments(mesh, 1.0, Quadrature())[1]
        values, basis = self.film.mean(axis=0), np.empty(mesh.order)
        return np.array(
            [
                interpolate_on_face(values, np.sqrt(1.0 - r * r), panels, basis)
                for r in np.asarray(radius, float)
            ]
        )


def assemble_case(case: ChamberCase, resolution: Resolution) -> tuple[HalfOperator, HalfOperator]:
    """Trace the rays of a case, which serve any gas, TAC and temperature."""
    return assemble_halves(case.meshes(resolution), case.rarefaction, resolution.quadrature)


def solve_chamber_case(
    case: ChamberCase,
    resolution: Resolution,
    *,
    halves: tuple[HalfOperator, HalfOperator] | None = None,
) -> ChamberOutcome:
    """Solve a case on one mesh."""
    halves = assemble_case(case, resolution) if halves is None else halves
    system = ChamberSystem(halves, case.gas, case.chamber, case.film)
    x, iterations = system.solve(), 1
    if case.linear:
        totals, loss = system.totals(x), system.film_loss[0] @ x + system.film_loss[1]
    else:
        problem = HotChamber(system, case.rarefaction, resolution.quadrature)
        x, arrivals, iterations = problem.solve(x, _TOLERANCE)
        totals, loss = problem.totals(x, arrivals), problem.film_loss(x, arrivals)
    if not np.isfinite(totals.force):
        raise ConvergenceError("the kinetic equation gave no finite force")
    layout, absorbed = system.layout, float(system.weights @ loss)
    imbalance = float(np.abs(loss / absorbed - 1.0).max()) if case.film.local else 0.0
    return ChamberOutcome(
        totals,
        _fields(x, layout),
        iterations,
        (halves[0].mesh, halves[1].mesh),
        np.stack([x[layout.film(0)], x[layout.film(1)]]),
        imbalance,
        absorbed,
        x,
    )


def _fields(x: np.ndarray, layout: "SystemLayout") -> np.ndarray:
    shape = layout.n, layout.fields
    return np.stack([x[layout.gas(half)].reshape(shape) for half in (0, 1)])
