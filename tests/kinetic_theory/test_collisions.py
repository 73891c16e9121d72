"""The collision operator of VHS molecules: alone, and around a disk."""

import numpy as np
import pytest

from lightflyer.core.errors import ParameterError

pytest.importorskip("numba")

from lightflyer.kinetic_theory import solve
from lightflyer.kinetic_theory.collisions.brackets import Molecule
from lightflyer.kinetic_theory.collisions.operator import CollisionOperator, Moments
from lightflyer.kinetic_theory.collisions.problem import MolecularProblem
from lightflyer.kinetic_theory.disk.cases import Resolution
from lightflyer.kinetic_theory.disk.linear import FaceWalls
from lightflyer.kinetic_theory.disk.operators import Quadrature

NITROGEN = Molecule(0.74, 0.2, rotates=True)
FEW = Moments((5, 5, 4, 3), (3, 3, 2))
ROUGH = Resolution(3, 0.7, Quadrature(2, 2, 2))


def operator(exponent, moments=FEW):
    return CollisionOperator(Molecule(exponent), moments)


@pytest.mark.parametrize(
    ("exponent", "viscosity", "conductivity"),
    # hard spheres: Pekeris & Alterman 1957; Maxwell molecules: their first approximation is exact
    [(0.5, 1.016034, 1.025218), (1.0, 1.0, 1.0)],
)
def test_transport_coefficients_are_the_published_ones(exponent, viscosity, conductivity):
    found = operator(exponent)
    # the rate at which ⟨c_x c_z⟩ decays is the first approximation of p/μ
    first = 1.0 / (found.weights(2)[0, 0] - found._gain(2)[0, 0]) * 3.75
    assert 1.0 / first == pytest.approx(viscosity, rel=1e-4)
    over_viscosity = 2.0 / 3.0 * found._response(1, {1: -2.5, 3: 1.0})  # and the gas constant
    assert over_viscosity / 3.75 * viscosity == pytest.approx(conductivity, rel=1e-4)


def test_maxwell_molecules_relax_at_their_known_rates():
    # of isotropic scattering: the heat flux at a third of the collision rate, stress at half, the
    # next harmonic at three quarters
    rates = [np.sort(1.0 - np.linalg.eigvalsh(operator(1.0).mixing(degree))) for degree in range(4)]
    assert rates[1][1] == pytest.approx(1.0 / 3.0, abs=1e-6)
    assert rates[2][0] == pytest.approx(0.5, abs=1e-6)
    assert rates[3][0] == pytest.approx(0.75, abs=1e-4)


@pytest.mark.parametrize("molecule", [Molecule(0.5), Molecule(0.81), NITROGEN], ids=str)
def test_collisions_conserve_number_momentum_and_energy(molecule):
    found = CollisionOperator(molecule, FEW)
    for degree, count in ((0, 2), (1, 1)):
        values = np.linalg.eigvalsh(found.mixing(degree))
        assert np.abs(values[-count:] - 1.0).max() < 1e-12
        assert values[-count - 1] < 0.9
    assert np.linalg.eigvalsh(found.mixing(2)).max() < 0.6


def test_rotation_relaxes_at_the_rate_of_its_exchange():
    # half the exchanges, half the rate, but for the collisions in which both molecules take part
    slow, fast = (CollisionOperator(Molecule(0.74, p, rotates=True), FEW) for p in (0.1, 0.2))
    rates = [1.0 - np.sort(np.linalg.eigvalsh(o.mixing(0)))[-3] for o in (slow, fast)]
    assert rates[1] / rates[0] == pytest.approx(2.0, rel=0.1)


@pytest.fixture(scope="module")
def problem():
    rarefaction = 0.5 * np.sqrt(np.pi)
    return MolecularProblem(
        ROUGH.mesh(rarefaction, np.inf), rarefaction, ROUGH.quadrature,
        CollisionOperator(NITROGEN, Moments((4, 4, 3), (2, 2))), 0.75,
    )  # fmt: skip


def totals(problem, walls):
    faces = problem.face_results(walls, problem.solve(walls)[0])
    weights = problem.mesh.face_weights
    force = weights @ (faces[1].pressure - faces[0].pressure)
    return force, [weights @ face.heat for face in faces]


def test_force_of_heat_is_heat_of_motion(problem):
    # reciprocity: nothing in the solver knows of it
    _, drawn = totals(problem, FaceWalls((0.6, 0.9), (0.0, 0.0), velocity=1.0))
    force, _ = totals(problem, FaceWalls((0.6, 0.9), (0.0, 1.0)))
    assert force == pytest.approx(drawn[1], rel=5e-3)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"collisions": "bgk"}, "shakhov or vhs"),
        ({"collisions": "vhs", "temperature_ratio": 2.0}, "linear problem"),
        ({"collisions": "vhs", "open_fraction": 0.2}, "open_fraction must be 0"),
        ({"collisions": "vhs", "viscosity_exponent": 0.4}, "viscosity_exponent"),
        ({"collisions": "vhs", "collision_number": 5.0}, 'gas = "diatomic"'),
        ({"viscosity_exponent": 0.7}, 'belongs to collisions = "vhs"'),
    ],
)
def test_bad_input_is_named(change, message):
    with pytest.raises(ParameterError, match=message):
        solve(1.0, 0.8, 0.9, **change)
