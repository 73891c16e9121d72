"""Cases of a disk in a chamber, or of a film whose spots balance their heat, on one mesh."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from lightflyer.core.errors import ConvergenceError
from lightflyer.kinetic_theory.chamber.enclosure import Chamber, Film
from lightflyer.kinetic_theory.chamber.half_mesh_operator import HalfOperator, assemble_halves
from lightflyer.kinetic_theory.chamber.linear import ChamberSystem, Totals
from lightflyer.kinetic_theory.chamber.nonlinear import HotChamber
from lightflyer.kinetic_theory.disk.cases import Resolution
from lightflyer.kinetic_theory.disk.operators import Quadrature, kernel_arguments
from lightflyer.kinetic_theory.grid.interpolation import interpolate_on_face
from lightflyer.kinetic_theory.grid.mesh import Mesh, build_chamber_meshes
from lightflyer.kinetic_theory.model_gases import GasModel

if TYPE_CHECKING:
    from lightflyer.kinetic_theory.chamber.linear import Layout

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


def _fields(x: np.ndarray, layout: "Layout") -> np.ndarray:
    shape = layout.n, layout.fields
    return np.stack([x[layout.gas(half)].reshape(shape) for half in (0, 1)])
