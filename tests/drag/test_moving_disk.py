"""Drag by the kinetic equation: the solver, the table and the law of holes."""

import math
from importlib.resources import files

import numpy as np
import pytest
from drag.hot_disk import hot_disk_drag

import lightflyer as lf
from lightflyer.core.errors import ParameterError
from lightflyer.drag import free_molecular
from lightflyer.drag.disk import dense_share
from lightflyer.kinetic_theory.disk import cases
from lightflyer.kinetic_theory.disk.cases import COARSE, Case, Resolution, solve_case
from lightflyer.kinetic_theory.disk.operators import Quadrature
from lightflyer.kinetic_theory.model_gases import DIATOMIC, MONATOMIC, GasModel
from lightflyer.kinetic_theory.moving import MovedDisk, moving_outcomes

pytestmark = pytest.mark.slow  # numba compiles the solver

FACES = (0.6, 0.9)
BGK = GasModel("bgk", 1.0, 0.0, 0.0, 0.66)
SKETCH = Resolution(2, 0.7, Quadrature(2, 2, 2))  # suffices where two of its solutions are compared


def table_says(rarefaction, tac, molecules, holes=0.0):
    with lf.float64():
        thin = (1.0 - holes) * float(free_molecular.broadside_disk(0.0, tac, 1.0))
        share = float(dense_share(rarefaction, tac, molecules))
    return 1.0 / (1.0 / thin + share * math.pi * rarefaction / 16.0)


@pytest.fixture(scope="module")
def solved():
    """At a rarefaction between those of the table, where both limits count alike."""
    disks = {
        "solid": (MONATOMIC, MovedDisk((0.7, 0.7))),
        "holes": (MONATOMIC, MovedDisk((0.7, 0.7), 0.5)),
        "unlike": (MONATOMIC, MovedDisk((0.4, 1.0))),
        "diatomic": (DIATOMIC, MovedDisk((0.7, 0.7))),
        "bgk": (BGK, MovedDisk((0.7, 0.7))),
        "faces": (MONATOMIC, MovedDisk(FACES)),
    }
    outcomes = moving_outcomes(1.2, COARSE, list(disks.values()))
    return dict(zip(disks, outcomes, strict=True))


def test_table_at_other_points(solved):
    assert solved["solid"].drag == pytest.approx(table_says(1.2, 0.7, "monatomic"), rel=2e-3)
    assert solved["diatomic"].drag == pytest.approx(table_says(1.2, 0.7, "diatomic"), rel=2e-3)
    assert solved["unlike"].drag == pytest.approx(solved["solid"].drag, rel=1e-3)


def test_holes_add_a_resistance(solved):
    assert solved["holes"].drag == pytest.approx(table_says(1.2, 0.7, "monatomic", 0.5), rel=3e-3)


def test_model_equations_differ_little(solved):
    for other in ("diatomic", "bgk"):
        assert solved[other].drag == pytest.approx(solved["solid"].drag, rel=4e-3)


def test_heat_of_motion_is_the_force_of_a_hot_face(solved):
    """Onsager's reciprocity, between two solutions that share nothing but the equation."""
    hot = solve_case(Case(1.2, FACES, (1.0, 0.0), True, MONATOMIC, np.inf), COARSE)
    assert solved["faces"].heat[0] == pytest.approx(hot.force, rel=1e-3)


def test_solution_of_one_disk(monkeypatch):
    sketch = Resolution(3, 0.7, Quadrature(3, 3, 3))
    monkeypatch.setattr(cases, "meshes", lambda knudsen, *, linear: (COARSE, sketch))
    solution = lf.kinetic_theory.solve_moving(2.0, 1.0, 1.0)
    delta = math.sqrt(math.pi) / 8.0
    assert solution.drag == pytest.approx(table_says(delta, 1.0, "monatomic"), rel=1e-3)
    assert 0.0 < solution.error_estimate < 1e-2 * solution.drag
    assert solution.drag_ratio == pytest.approx(solution.drag * math.sqrt(math.pi) / (4 + math.pi))
    # the gas at the axis follows the disk, in part; far away it rests
    near, far = solution.flow([0.0, 0.0], [0.05, 40.0])["velocity_axial"]
    assert 0.5 < near < 1.0
    assert abs(far) < 0.03
    with pytest.raises(ParameterError, match="knudsen"):
        lf.kinetic_theory.solve_moving(1e-3, 1.0, 1.0)


def test_table_is_made_of_the_points(study_of):
    with study_of("drag", "study") as study:
        shipped = files("lightflyer.data").joinpath("drag_disk.csv").read_text("utf-8")
        assert shipped == study.HEADER + "\n".join(study.rows()) + "\n"
        worst = max(
            abs(drag / table_says(delta, tac, gas) - 1.0)
            for (delta, level), values in study.read_points().items()
            if level == "fine"
            for (gas, tac), drag in values.items()
            if tac in study.CHECKED_TAC or delta > study.HIGHEST
        )
        assert worst < 1.5e-3  # between the TACs of the table, and in denser gas


@pytest.mark.parametrize(("gas", "tac"), [(MONATOMIC, 0.5), (DIATOMIC, 1.0)])
def test_a_disk_as_warm_as_the_gas_has_the_drag_of_the_linear_problem(gas, tac):
    (found,) = hot_disk_drag(1.0, gas, tac, [1.0], SKETCH)
    (linear,) = moving_outcomes(1.0, SKETCH, [(gas, MovedDisk((tac, tac)))])
    assert found == pytest.approx(linear.drag, rel=1e-4)


def test_a_hot_disk_in_thin_gas_has_the_drag_of_free_molecules():
    """A share of the molecules leaves with the root of the disk's temperature [Bird1994]."""
    cold, hot = hot_disk_drag(0.004, DIATOMIC, 0.5, [1.0, 1.6], SKETCH)
    arriving, leaving = 1.5 * 4.0 / math.sqrt(math.pi), 0.5 * math.sqrt(math.pi)
    growth = (arriving + leaving * math.sqrt(1.6)) / (arriving + leaving)
    assert hot / cold == pytest.approx(growth, rel=1e-3)


def test_the_law_has_the_drag_of_a_hot_disk():
    """At Kn = 0.3, where warm gas of the film's viscosity would have 4 % more."""
    cold, hot = hot_disk_drag(math.sqrt(math.pi) / 1.2, DIATOMIC, 1.0, [1.0, 1.6], SKETCH)
    around = (5.0, 220.0, lf.gas.AIR)
    path = float(lf.gas.mean_free_path(*around))
    by_law = [
        float(lf.drag.disk_drag(1e-3, path / 0.6, *around, excess=(excess, excess)))
        for excess in (0.0, 0.6)
    ]
    assert by_law[1] / by_law[0] == pytest.approx(hot / cold, rel=0.01)
