"""Walls of the kinetic solver: limits, and what a wall of one temperature does to a moving disk."""

import numpy as np
import pytest

from lightflyer.core.errors import ParameterError
from lightflyer.kinetic_theory import solve, solve_moving
from lightflyer.kinetic_theory.disk.cases import Case, Resolution, solve_case
from lightflyer.kinetic_theory.disk.operators import Quadrature
from lightflyer.kinetic_theory.model_gases import DIATOMIC, MONATOMIC
from lightflyer.kinetic_theory.moving import MovedDisk, moving_outcomes
from lightflyer.kinetic_theory.solver import TEMPERATURE_RATIOS

SKETCH = Resolution(3, 0.7, Quadrature(3, 3, 3))
ROUGH = Resolution(2, 0.7, Quadrature(2, 2, 2))  # where both sides have the same error of a mesh


def outcome(
    kn, tac, faces, gas=MONATOMIC, wall="accommodated", *, linear=False, holes=0.0, mesh=ROUGH
):
    rarefaction = float(np.sqrt(np.pi) / 4.0 / kn)
    case = Case(rarefaction, tac, faces, linear, gas, np.inf, holes, wall)
    return solve_case(case, mesh), case.free_molecular()


RECOIL = {  # of a face with a TAC at T/T_c, over the momentum that arrives
    "accommodated": lambda tac, hot: np.sqrt(1.0 + tac * (hot - 1.0)) - 1.0,
    "maxwell": lambda tac, hot: tac * (np.sqrt(hot) - 1.0),
    "linear": lambda tac, hot: 0.5 * tac * (hot - 1.0),
}


@pytest.mark.parametrize(
    ("wall", "gas", "holes", "top", "bottom"),
    [
        ("accommodated", MONATOMIC, 0.3, 2.5, 2.0),
        ("accommodated", DIATOMIC, 0.0, 2.5, 2.0),
        ("maxwell", MONATOMIC, 0.0, *TEMPERATURE_RATIOS[::-1]),
        ("maxwell", DIATOMIC, 0.99, 1.2, 1.9),
        ("linear", DIATOMIC, 0.3, 1.2, 1.9),
    ],
)
def test_free_molecular_limit(wall, gas, holes, top, bottom):
    """Molecules leave with the root of the temperature at which they do times the momentum."""
    linear, named = wall == "linear", "maxwell" if wall == "linear" else wall
    faces = (top - 1.0, bottom - 1.0) if linear else (top, bottom)
    found, limit = outcome(100.0, (0.5, 1.0), faces, gas, named, linear=linear, holes=holes)
    force = 0.5 * (1.0 - holes) * (RECOIL[wall](1.0, bottom) - RECOIL[wall](0.5, top))
    carried = {"monatomic": 2.0, "diatomic": 3.0}[gas.name] / 2.0
    heat = carried * (1.0 - holes) * (0.5 * (top - 1.0) + bottom - 1.0) / np.sqrt(np.pi)
    assert found.force == pytest.approx(force, rel=4e-3)
    assert sum(found.heat) == pytest.approx(heat, rel=1e-3)
    assert (limit.force, sum(limit.heat)) == pytest.approx((force, heat), rel=1e-12)


@pytest.mark.parametrize(
    ("wall", "gas", "holes", "excess"),
    [
        ("accommodated", MONATOMIC, 0.6, 1e-3),
        ("accommodated", DIATOMIC, 0.0, 1e-3),
        ("maxwell", MONATOMIC, 0.0, 1e-3),
        ("maxwell", DIATOMIC, 0.6, -1e-3),
    ],
)
def test_nonlinear_goes_to_linear(wall, gas, holes, excess):
    linear, _ = outcome(0.3, (0.7, 0.9), (0.5, 1.0), gas, wall, linear=True, holes=holes)
    hot = (1.0 + 0.5 * excess, 1.0 + excess)
    found, _ = outcome(0.3, (0.7, 0.9), hot, gas, wall, holes=holes)
    assert found.force / excess == pytest.approx(linear.force, rel=1e-3)
    assert np.divide(found.heat, excess) == pytest.approx(linear.heat, rel=1e-3)


@pytest.mark.parametrize("linear", [True, False])
def test_walls_are_one_where_all_molecules_accommodate(linear):
    faces = (0.0, 1.0) if linear else (1.2, 2.2)
    accommodated, maxwell = (
        outcome(0.4, (1.0, 1.0), faces, DIATOMIC, wall, linear=linear)[0]
        for wall in ("accommodated", "maxwell")
    )
    assert accommodated.force == pytest.approx(maxwell.force, rel=1e-7)
    assert accommodated.heat == pytest.approx(maxwell.heat, rel=1e-7)


def test_a_face_that_accommodates_nothing_draws_no_heat_and_warms_up():
    """Its molecules leave with the energy of those that arrive, which the other face heated."""
    found, reflecting = (
        outcome(0.3, (1e-9, 1.0), (1.0, 1.0), DIATOMIC, wall, linear=True, mesh=SKETCH)[0]
        for wall in ("accommodated", "maxwell")
    )
    for one in (found, reflecting):
        assert abs(one.heat[0]) < 1e-8
    assert found.heat[1] == pytest.approx(reflecting.heat[1], rel=0.01)
    assert found.heat[1] != pytest.approx(reflecting.heat[1], rel=1e-5)


def quadrature_of_drag(tac, sideways):
    """Pressure difference of a slowly moved disk per speed ratio, from fluxes on a grid of speeds.

    In its frame a face meets molecules of the shifted Maxwellian; all leave at one temperature.
    ``sideways`` is what a molecule carries besides the energy of its normal motion [kT].
    """
    speed = 1e-4
    c, step = np.linspace(0.0, 8.0, 40_001, retstep=True)
    pressures = []
    for toward in (speed, -speed):
        arriving = np.exp(-((c - toward) ** 2)) / np.sqrt(np.pi)
        number, momentum, energy = (np.sum(arriving * c**power) * step for power in (1, 2, 3))
        brought = (energy / number + sideways) / (1.0 + sideways)
        temperature = tac + (1.0 - tac) * brought
        pressures.append(2.0 * momentum + number * np.sqrt(np.pi * temperature))
    return (pressures[0] - pressures[1]) / speed


def test_moved_disk_feels_the_drag_of_free_molecules():
    """Of Maxwell's walls 2 (4 − 2α + πα/2)/√π; of others by quadrature."""
    maxwell = 2.0 * (4.0 - 2.0 * 0.7 + 0.5 * np.pi * 0.7) / np.sqrt(np.pi)
    disks = [
        (MONATOMIC, MovedDisk((0.7, 0.7)), maxwell),
        (MONATOMIC, MovedDisk((0.3, 0.3), wall="accommodated"), quadrature_of_drag(0.3, 1.0)),
        (DIATOMIC, MovedDisk((0.3, 0.3), wall="accommodated"), quadrature_of_drag(0.3, 2.0)),
    ]
    found = moving_outcomes(0.004, SKETCH, [moved[:2] for moved in disks])
    for (gas, disk, expected), solved in zip(disks, found, strict=True):
        assert disk.free_molecular_drag(gas.has_rotation) == pytest.approx(expected, rel=1e-6)
        assert solved.drag == pytest.approx(expected, rel=3e-3)


@pytest.mark.parametrize("call", [solve, solve_moving])
def test_walls_that_the_solver_does_not_know_are_named(call):
    with pytest.raises(ParameterError, match='wall = "specular" is not maxwell, accommodated, c'):
        call(1.0, 0.8, 0.9, wall="specular")
