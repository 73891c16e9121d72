"""Walls of Cercignani and Lampis in the linear problem, by modes."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import i0e

from lightflyer.core.errors import ParameterError
from lightflyer.kinetic_theory import Chamber, solve, solve_in_chamber
from lightflyer.kinetic_theory.chamber import cases as chamber_cases
from lightflyer.kinetic_theory.disk import cases
from lightflyer.kinetic_theory.disk.cases import (
    Case,
    Resolution,
    solve_case,
    totals,
)
from lightflyer.kinetic_theory.disk.linear import FaceWalls, LinearSystem, face_result
from lightflyer.kinetic_theory.disk.operators import Quadrature, assemble
from lightflyer.kinetic_theory.disk.scattering import (
    NORMAL_ENERGY,
    NUMBER,
    TANGENTIAL_ENERGY,
    Mode,
    Scattering,
    ScatteringSystem,
    assemble_modes,
    modes_up_to,
)
from lightflyer.kinetic_theory.model_gases import DIATOMIC, MONATOMIC
from lightflyer.kinetic_theory.moving import MovedDisk, moving_outcomes
from lightflyer.kinetic_theory.walls import Accommodation

ROUGH = Resolution(2, 0.7, Quadrature(2, 2, 2))
SKETCH = Resolution(3, 0.7, Quadrature(3, 3, 3))
FACES = (0.3, 0.9, 0.5), (0.8, 0.7, 0.9)  # normal, tangential, rotational


def systems(rarefaction, level, gas, holes=0.0, modes=None):
    mesh = level.mesh(rarefaction, np.inf)
    operators = assemble(mesh, rarefaction, level.quadrature)
    rows = assemble_modes(operators, rarefaction, level.quadrature, modes)
    return operators, ScatteringSystem(operators, rows, gas, holes)


def result(system, heated=(1.0, 1.0), velocity=0.0, faces=FACES):
    top, bottom = (
        Scattering(*face, temperature, sign * velocity)
        for face, temperature, sign in zip(faces, heated, (1.0, -1.0), strict=True)
    )
    return totals(system.operators.mesh, system.solve(top, bottom)[1])


def at(mode, normal, along, across):
    """A mode at velocities, by its coefficients."""
    table = mode.coefficients(mode.degree // 2 + 1)
    square = along**2 + across**2
    powers = np.polynomial.polynomial.polyval2d(*np.broadcast_arrays(normal**2, square), table)
    return powers * ((along + 1j * across) ** mode.harmonic).real


@pytest.mark.parametrize("mode", [Mode(0, 0, 0), Mode(1, 0, 0), Mode(3, 0, 0)])
def test_normal_modes_are_kept_by_the_published_kernel(mode):
    """Their mean over what leaves, of molecules that arrive with one speed."""
    accommodation, speed = 0.6, 1.3
    kept = 1.0 - accommodation

    def leaving(c):
        shift = 2.0 * np.sqrt(kept) * c * speed / accommodation
        exponent = (c - np.sqrt(kept) * speed) ** 2 / accommodation
        return 2.0 * c / accommodation * np.exp(-exponent) * i0e(shift)

    mean = quad(lambda c: leaving(c) * at(mode, c, 0.0, 0.0), 0.0, 12.0)[0]
    share = mode.eigenvalue(accommodation, 0.0)
    assert mean == pytest.approx(share * at(mode, speed, 0.0, 0.0), rel=1e-9)


@pytest.mark.parametrize("mode", [Mode(0, 1, 0), Mode(0, 0, 1), Mode(0, 2, 1)])
def test_tangential_modes_are_kept_by_the_published_kernel(mode):
    """Both components are scattered about 1 − σ of what they were, by Hermite quadrature."""
    momentum, along, across = 0.4, 0.9, -0.5
    nodes, weights = np.polynomial.hermite.hermgauss(20)
    spread = np.sqrt(momentum * (2.0 - momentum))
    x, y = np.meshgrid(*((1.0 - momentum) * c + spread * nodes for c in (along, across)))
    mean = np.sum(np.outer(weights, weights) * at(mode, 0.0, x, y)) / np.pi
    share = mode.eigenvalue(0.0, momentum)
    assert mean == pytest.approx(share * at(mode, 0.0, along, across), rel=1e-12)


def test_modes_are_orthonormal():
    x, normal = np.polynomial.laguerre.laggauss(20)
    nodes, weights = np.polynomial.hermite.hermgauss(20)
    c, along, across = np.meshgrid(np.sqrt(x), nodes, nodes, indexing="ij")
    measure = np.einsum("i,j,k->ijk", normal, weights, weights) / np.pi
    values = np.array([at(mode, c, along, across) for mode in modes_up_to(4, 3)])
    found = np.einsum("aijk,bijk,ijk->ab", values, values, measure)
    assert found == pytest.approx(np.eye(len(values)), abs=1e-10)


@pytest.mark.parametrize(("gas", "holes"), [(MONATOMIC, 0.0), (DIATOMIC, 0.4)])
def test_full_accommodation_is_diffuse_reflection(gas, holes):
    operators, system = systems(1.5, ROUGH, gas, holes)
    diffuse = LinearSystem(operators, gas, 1.0, holes)
    for heated, velocity in (((1.0, 0.0), 0.0), ((0.0, 0.0), 1.0)):
        walls = FaceWalls((1.0, 1.0), heated, velocity, holes)
        fields = diffuse.solve(walls)[0]
        expected = totals(
            operators.mesh, [face_result(diffuse, walls, fields[k], k) for k in (0, 1)]
        )
        force, heat = result(system, heated, velocity, ((1.0, 1.0, 1.0),) * 2)
        assert force == pytest.approx(expected[0], rel=1e-10)
        assert heat == pytest.approx(expected[1], rel=1e-10)


@pytest.mark.parametrize("gas", [MONATOMIC, DIATOMIC])
def test_free_molecular_limit(gas):
    """Only normal motion pushes; each kind carries 1/(2√π) of heat."""
    _, system = systems(1e-7, ROUGH, gas)
    force, heat = result(system)
    assert force == pytest.approx(0.25 * (0.8 - 0.3), rel=1e-6)
    for found, (normal, momentum, rotation) in zip(heat, FACES, strict=True):
        kinds = normal + momentum * (2.0 - momentum) + rotation * gas.has_rotation
        assert found == pytest.approx(0.5 * kinds / np.sqrt(np.pi), rel=1e-6)


@pytest.mark.parametrize(
    ("gas", "holes", "rarefaction", "near"),
    [(MONATOMIC, 0.0, 0.2, 1e-3), (DIATOMIC, 0.5, 1.0, 2e-3)],
)
def test_force_of_heat_is_heat_of_motion(gas, holes, rarefaction, near):
    """Onsager's reciprocity, face by face."""
    _, system = systems(rarefaction, SKETCH, gas, holes)
    _, drawn = result(system, (0.0, 0.0), 1.0)
    for face, heated in enumerate(((1.0, 0.0), (0.0, 1.0))):
        assert drawn[face] == pytest.approx(result(system, heated)[0], rel=near)


def test_more_modes_change_nothing():
    usual, more = (
        result(systems(2.0, SKETCH, DIATOMIC, modes=modes)[1])
        for modes in (None, modes_up_to(8, 9))
    )
    assert usual[0] == pytest.approx(more[0], rel=2e-4)
    assert usual[1] == pytest.approx(more[1], rel=2e-5)


def test_moved_disk_feels_the_free_molecular_drag():
    """By the kernel: a face that runs into molecules meets c_n of them, and scatters that."""
    faces = Accommodation(0.5, 0.9, 0.4), Accommodation(0.8, 0.3, 0.9)
    disk = MovedDisk((0.5, 0.5), scattering=faces)
    c = np.linspace(1e-6, 7.0, 1201)
    kept = []
    for face in faces:
        # R(c' → c), weighted with the flux of molecules c' that arrive
        arriving, leaving = np.meshgrid(c, c, indexing="ij")
        shift = np.sqrt(1.0 - face.normal)
        exponent = (leaving - shift * arriving) ** 2 / face.normal
        kernel = np.exp(-exponent) * i0e(2.0 * shift * arriving * leaving / face.normal)
        flux = 2.0 * arriving * np.exp(-(arriving**2)) * 2.0 * leaving / face.normal
        kept.append(np.sum(flux * kernel * arriving * leaving) * (c[1] - c[0]) ** 2)
    expected = 4.0 * (1.0 + np.mean(kept)) / np.sqrt(np.pi)
    gases = MONATOMIC, DIATOMIC
    outcomes = moving_outcomes(1e-7, ROUGH, [(gas, disk) for gas in gases])
    for gas, found in zip(gases, outcomes, strict=True):
        assert disk.free_molecular_drag(gas.has_rotation) == pytest.approx(expected, rel=1e-5)
        assert found.drag == pytest.approx(expected, rel=1e-4)


def test_solution_by_tacs(monkeypatch):
    monkeypatch.setattr(cases, "meshes", lambda knudsen, *, linear: (SKETCH, ROUGH))
    found = solve(
        1.0, 0.8, 0.9, gas="diatomic", wall="cercignani-lampis", tangential_accommodation=0.85
    )
    # thin gas: α_n = 2α − σ(2 − σ), differences of which are twice those of the TACs
    assert found.force / found.force_ratio == pytest.approx(0.25 * 0.2)
    heat = 1.5 * 0.8 / np.sqrt(np.pi)
    assert found.heat[0] / found.heat_ratio_top == pytest.approx(heat)
    assert "Cercignani-Lampis walls" in found.title
    assert found.inputs["tangential_accommodation"] == [0.85, 0.85]
    # normal motion pushes less than without collisions: direct simulation, page of walls
    alike = solve(1.0, 0.8, 0.9, gas="diatomic", wall="cercignani-lampis")
    assert 1.8 < found.force / alike.force < 2.0


BAD = {
    "no wall has tac_top = 0.8 with tangential_accommodation = 0.3": {
        "tangential_accommodation": 0.3
    },
    "tangential_accommodation = 1.3 is not between 0 and 1": {"tangential_accommodation": 1.3},
    'rotational_accommodation belongs to gas = "diatomic"': {"rotational_accommodation": 0.3},
    'belongs to collisions = "shakhov"': {"collisions": "vhs"},
    "tangential_accommodation and rotational_accommodation belong to": {
        "wall": "maxwell",
        "tangential_accommodation": 0.9,
    },
}


@pytest.mark.parametrize("says", BAD)
def test_what_no_wall_can_do_is_named(says):
    with pytest.raises(ParameterError, match=says):
        solve(1.0, 0.8, 0.9, **{"wall": "cercignani-lampis", **BAD[says]})


def hot(rarefaction, gas, temperature, faces=FACES, holes=0.0, level=ROUGH):
    faces = tuple(Accommodation(*face) for face in faces)
    tac = tuple(float(np.mean(face.of_energy[: 2 + gas.has_rotation])) for face in faces)
    case = Case(rarefaction, tac, temperature, False, gas, np.inf, holes, "accommodated", faces)
    return solve_case(case, level), case.free_molecular()


@pytest.mark.parametrize(("gas", "holes"), [(MONATOMIC, 0.3), (DIATOMIC, 0.0)])
def test_hot_free_molecular_limit(gas, holes):
    """What arrives is cold: normal motion pushes, and each kind carries heat of its own."""
    found, limit = hot(1e-7, gas, (2.5, 2.0), holes=holes)
    force = 0.5 * (1.0 - holes) * (np.sqrt(1.0 + 0.8 * 1.0) - np.sqrt(1.0 + 0.3 * 1.5))
    heat = [
        0.5 * (1.0 - holes) / np.sqrt(np.pi) * excess * (n + t * (2.0 - t) + r * gas.has_rotation)
        for excess, (n, t, r) in zip((1.5, 1.0), FACES, strict=True)
    ]
    assert found.force == pytest.approx(force, rel=1e-6)
    assert found.heat == pytest.approx(heat, rel=1e-6)
    assert (limit.force, *limit.heat) == pytest.approx((force, *heat), rel=1e-12)


def test_free_molecules_leave_with_two_temperatures():
    """Density in the gas by quadrature over the disk that is seen."""
    found, _ = hot(1e-7, MONATOMIC, (2.5, 2.5))
    across, along = 1.0 + 0.3 * 1.5, 1.0 + 0.9 * 1.1 * 1.5
    radius, angle = np.meshgrid((np.arange(100) + 0.5) / 100, (np.arange(100) + 0.5) * np.pi / 100)
    mesh = found.mesh
    chosen = np.flatnonzero((mesh.height > 0.2) & (mesh.height < 2.5) & (mesh.radius < 2.5))
    assert chosen.size > 3
    for node in chosen:
        height = mesh.height[node]
        square = radius**2 + mesh.radius[node] ** 2 + height**2
        distance = np.sqrt(square - 2.0 * radius * mesh.radius[node] * np.cos(angle))
        inverse = (height / distance) ** 2 / across + (1.0 - (height / distance) ** 2) / along
        seen = 2.0 * radius * height / distance**3 * (np.pi / 100**2)
        excess = np.sum(seen * (inverse**-1.5 / (across * along) - 1.0)) / (4.0 * np.pi)
        pressure, _, _, temperature = found.fields[0, node, :4]
        density = (1.0 + pressure) / (1.0 + temperature)
        assert density - 1.0 == pytest.approx(excess, rel=0.04, abs=1e-4)


@pytest.mark.parametrize("gas", [MONATOMIC, DIATOMIC])
def test_hot_goes_to_linear(gas):
    """Three temperatures are three modes; all modes change the force by less than it is said."""
    excess = 1e-3
    found, _ = hot(1.5, gas, (1.0 + 0.5 * excess, 1.0 + excess))
    few = NUMBER, NORMAL_ENERGY, TANGENTIAL_ENERGY
    force, heat = result(systems(1.5, ROUGH, gas, modes=few)[1], (0.5, 1.0))
    assert found.force / excess == pytest.approx(force, rel=excess)
    assert np.divide(found.heat, excess) == pytest.approx(heat, rel=excess)
    faces = (0.4, 0.9, 0.4), (1.0, 0.4, 1.0)
    (force, heat), (of_few, heat_of_few) = (
        result(systems(1.5, SKETCH, gas, modes=modes)[1], faces=faces) for modes in (None, few)
    )
    assert of_few == pytest.approx(force, rel=6e-3)
    assert of_few != pytest.approx(force, rel=1e-4)
    assert heat_of_few == pytest.approx(heat, rel=2e-3)


def test_hot_full_accommodation_is_diffuse_reflection():
    found, _ = hot(1.5, DIATOMIC, (1.2, 2.2), ((1.0, 1.0, 1.0),) * 2)
    diffuse = solve_case(
        Case(1.5, (1.0, 1.0), (1.2, 2.2), False, DIATOMIC, np.inf, wall="maxwell"), ROUGH
    )
    assert found.force == pytest.approx(diffuse.force, rel=1e-7)
    assert found.heat == pytest.approx(diffuse.heat, rel=1e-7)


def test_a_hot_face_draws_heat_of_the_kinds_that_it_accommodates():
    """Energy of each kind is conserved: heat of one kind is all where the others bounce."""
    for face in 0.7 * np.eye(3):
        found, _ = hot(1.5, DIATOMIC, (2.0, 2.0), (face, (0.0, 0.0, 0.0)))
        assert found.heat[0] > 0.1
        assert abs(found.heat[1]) < 1e-12


def test_a_chamber_takes_these_walls_where_the_disk_is_hot(monkeypatch):
    monkeypatch.setattr(chamber_cases, "meshes", lambda *, linear: (SKETCH, ROUGH))
    near = {"chamber": Chamber(floor=2.0, lid=2.0, side=2.0), "gas": "diatomic"}
    wall = {"wall": "cercignani-lampis", "tangential_accommodation": 0.9}
    found = solve_in_chamber(3.0, 0.8, 0.9, temperature_ratio=2.0, **near, **wall)
    # α_n = 2α − σ(2 − σ), as the TACs differ twice
    normal = 0.61, 0.81
    force = 0.5 * (np.sqrt(1.0 + normal[1]) - np.sqrt(1.0 + normal[0]))
    assert found.forces["disk"] / found.force_ratio == pytest.approx(force)
    assert 0.85 < found.force_ratio < 1.1
    assert abs(found.closure["heat"]) < 5e-3
    assert "Cercignani-Lampis walls" in found.title
    assert found.inputs["tangential_accommodation"] == [0.9, 0.9]
    with pytest.raises(ParameterError, match="needs temperature_ratio"):
        solve_in_chamber(3.0, 0.8, 0.9, **near, **wall)
