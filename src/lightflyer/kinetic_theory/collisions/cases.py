"""Cases of the disk problem with the collision operator of real molecules, on one mesh."""

from lightflyer.kinetic_theory.collisions.brackets import Molecule
from lightflyer.kinetic_theory.collisions.operator import (
    FEWER_MOMENTS,
    MOMENTS,
    CollisionOperator,
    Moments,
)
from lightflyer.kinetic_theory.collisions.problem import MolecularProblem
from lightflyer.kinetic_theory.disk.cases import COARSE, MEDIUM, Case, Outcome, Resolution, totals
from lightflyer.kinetic_theory.disk.linear import Walls
from lightflyer.kinetic_theory.disk.operators import Operators, Quadrature

_COARSER = Resolution(3, 0.7, Quadrature(3, 3, 3))

_THIN_DEPTH = 1.5  # Rarefaction δ below which the coarse mesh is right to 6·10⁻⁴ in force


def solve_at_two_levels(case: Case, molecule: Molecule) -> tuple[Outcome, Outcome]:
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
) -> Outcome:
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
    walls = Walls(case.tac, case.perturbation)
    fields, iterations = problem.solve(walls)
    force, heat = totals(mesh, problem.face_results(walls, fields))
    return Outcome(force, heat, problem.gas_fields(fields), iterations, mesh)
