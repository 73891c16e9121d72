"""A disk between floor, lid and side wall: limits, conservation, reciprocity and other programs."""

from dataclasses import replace

import numpy as np
import pytest

from lightflyer.core.errors import ParameterError
from lightflyer.kinetic_theory import Chamber, Surface, solve_in_chamber
from lightflyer.kinetic_theory.chamber import cases as chamber_cases
from lightflyer.kinetic_theory.chamber import half_mesh_operator as halves_module
from lightflyer.kinetic_theory.chamber.cases import (
    COARSE,
    ChamberCase,
    assemble_case,
    solve_chamber_case,
)
from lightflyer.kinetic_theory.chamber.enclosure import Film
from lightflyer.kinetic_theory.chamber.half_mesh_operator import assemble_halves
from lightflyer.kinetic_theory.chamber.linear import ChamberSystem
from lightflyer.kinetic_theory.disk.cases import Case, Resolution, solve_case
from lightflyer.kinetic_theory.disk.operators import Quadrature
from lightflyer.kinetic_theory.grid.mesh import Rim, build_chamber_meshes
from lightflyer.kinetic_theory.model_gases import DIATOMIC, MONATOMIC

SKETCH = Resolution(3, 0.7, Quadrature(3, 3, 3))
HOT = Film((0.8, 0.9), (1.0, 1.0))


def rarefaction(kn):
    return float(np.sqrt(np.pi) / 4.0 / kn)


def case(kn, chamber, film=HOT, gas=MONATOMIC, *, linear=True):
    return ChamberCase(rarefaction(kn), film, gas, chamber, linear)


def reservoir(distance):
    return Surface(distance, solid=False)


@pytest.fixture(scope="module")
def near():
    """A closed chamber with all surfaces near, and its rays."""
    problem = case(0.5, Chamber(floor=0.6, lid=1.5, side=2.0))
    return problem, assemble_case(problem, COARSE)


def test_walls_have_their_areas():
    for mesh, ceiling in zip(build_chamber_meshes(1.0, 3.0, (2.0, 0.7)), (2.0, 0.7), strict=True):
        rim = Rim(mesh)
        assert rim.weights[rim.is_flat].sum() == pytest.approx(9.0, rel=1e-3)
        assert rim.weights[~rim.is_flat].sum() == pytest.approx(6.0 * ceiling, rel=1e-3)
        assert np.all(rim.radius <= 3.0)
        assert np.all(rim.height <= ceiling)


def test_reservoirs_on_all_sides_are_the_boundary(monkeypatch):
    """By other equations: even and odd fields, and nothing that comes from walls."""
    monkeypatch.setattr(halves_module, "_FINER", 1)  # the same directions at the disk
    kn, tac, gas = 0.3, (0.6, 0.9), DIATOMIC
    known = solve_case(Case(rarefaction(kn), tac, (0.5, 1.0), True, gas, 3.0), SKETCH)
    mesh = SKETCH.mesh(rarefaction(kn), 3.0)
    halves = assemble_halves((mesh, mesh), rarefaction(kn), SKETCH.quadrature)
    chamber = Chamber(*(reservoir(3.0) for _ in range(3)))
    problem = case(kn, chamber, Film(tac, (0.5, 1.0)), gas)
    found = solve_chamber_case(problem, SKETCH, halves=halves).totals
    assert found.force == pytest.approx(known.force, rel=1e-7)
    assert found.heat == pytest.approx(known.heat, rel=1e-7)


def test_forces_and_heats_of_all_surfaces_add_up(near):
    problem, halves = near
    found = solve_chamber_case(problem, COARSE, halves=halves).totals
    forces, heats = found.forces, found.heats
    assert found.force + sum(forces.values()) == pytest.approx(0.0, abs=2e-3 * forces["lid"])
    assert sum(found.heat) + sum(heats.values()) == pytest.approx(0.0, abs=5e-3 * sum(found.heat))
    # as many molecules arrive at each wall as leave it
    assert all(abs(molecules) < 3e-4 for molecules in found.molecules.values())
    # a hot disk is pushed up by a cold floor that is nearer than the lid
    equal = replace(problem, film=Film((0.85, 0.85), (1.0, 1.0)))
    assert solve_chamber_case(equal, COARSE, halves=halves).totals.force > 1e-3


def test_a_floor_pushes_a_disk_of_like_faces_as_simulated():
    """studies/direct_simulation: nitrogen, T_h/T_c 2.3415, force over p A within two errors."""
    chamber = Chamber(Surface(2.25), reservoir(4.0), reservoir(4.0))
    problem = case(0.294524, chamber, Film((0.99, 1.0), (1.0, 1.0)), DIATOMIC)
    small = solve_chamber_case(problem, SKETCH).totals.force
    assert 2.0 * (np.sqrt(2.3415) - 1.0) * small == pytest.approx(0.0072, abs=2.0 * 0.0013)


def test_heat_and_force_are_reciprocal(near):
    """Onsager: floor and disk heat one another alike, and motion draws the heat that pushes."""
    problem, halves = near
    cold = Film((0.8, 0.9), (0.0, 0.0))

    def totals(film, chamber=problem.chamber):
        changed = replace(problem, film=film, chamber=chamber)
        return solve_chamber_case(changed, COARSE, halves=halves).totals

    floor = replace(problem.chamber.floor, temperature=1.0)
    warm = totals(cold, replace(problem.chamber, floor=floor))
    hot, moved = totals(HOT), totals(replace(cold, velocity=1.0))
    assert sum(warm.heat) == pytest.approx(hot.heats["floor"], rel=2e-3)
    for face in (0, 1):
        one = totals(Film((0.8, 0.9), (1.0 - face, float(face))))
        assert one.force == pytest.approx(moved.heat[face], rel=1e-3)


def test_free_molecules_between_disk_and_floor():
    """Energy goes between diffuse walls as light between grey rings on one axis."""
    gap, tac, floor_tac = 0.2, 0.8, 0.5
    chamber = Chamber(Surface(gap, tac=floor_tac), 2.0, 3.0)
    film = Film((1.0, tac), (1.0, 1.0), wall="accommodated")
    system = ChamberSystem(assemble_case(case(1000.0, chamber), SKETCH), MONATOMIC, chamber, film)
    loss = system.face_heat(1)[0] @ system.solve()
    edges = np.linspace(0.0, 3.0, 601)
    ring, width = 0.5 * (edges[1:] + edges[:-1]), np.diff(edges)
    square = gap**2 + ring[:, None] ** 2 + ring**2
    seen = (
        2.0
        * gap**2
        * square
        * ring
        * width
        / (square**2 - (2.0 * ring[:, None] * ring) ** 2) ** 1.5
    )
    disk = ring < 1.0
    down, up = seen[:, disk], seen[disk]
    # the cold floor returns 1 − γ of what the disk sends: α, and what it does not accommodate
    kernel = (1.0 - tac) * up @ ((1.0 - floor_tac) * down)
    sent = np.linalg.solve(np.eye(disk.sum()) - kernel, np.full(disk.sum(), tac))
    arrives = up @ ((1.0 - floor_tac) * (down @ sent))
    expected = np.interp(system.halves[1].mesh.face_radius, ring[disk], tac * (1.0 - arrives))
    assert loss * np.sqrt(np.pi) == pytest.approx(expected, rel=0.01)


def test_fourier_between_disk_and_floor():
    """With the jump of temperature of the model equation, 1.954 μ√(2RT)/p ([Sharipov2011]_)."""
    gap, kn = 0.3, 0.012
    delta, chamber = rarefaction(kn), Chamber(gap, 0.6, 1.3)
    film = Film((1.0, 1.0), (1.0, 1.0))
    system = ChamberSystem(assemble_case(case(kn, chamber, film), SKETCH), MONATOMIC, chamber, film)
    loss = system.face_heat(1)[0] @ system.solve()
    conductivity = 15.0 / (8.0 * delta)  # [r p √(2RT)/T], Prandtl number 2/3
    assert loss[-1] == pytest.approx(conductivity / (gap + 2.0 * 1.954 / delta), rel=0.01)


def test_far_walls_act_as_their_inverse_distance():
    kn = 0.8
    forces = [
        solve_chamber_case(case(kn, None if np.isinf(d) else Chamber(d, d, d)), SKETCH).totals.force
        for d in (np.inf, 60.0, 20.0)
    ]
    opened, far, near = forces
    assert (near - opened) / (far - opened) == pytest.approx(3.0, rel=0.1)
    assert near > 1.01 * opened


def test_local_balance_in_open_space():
    """Equal absorbed power; the ratio is that of a computation with collisions by other code."""
    found = {}
    for local in (False, True):
        film = Film((0.8, 0.9), (1.0, 1.0), local=local)
        found[local] = solve_chamber_case(case(0.1, None, film, DIATOMIC), SKETCH)
    uniform, local = found[False], found[True]
    assert local.imbalance < 1e-6
    ratio = local.totals.force / local.absorbed / (uniform.totals.force / uniform.absorbed)
    assert ratio == pytest.approx(0.976, abs=3e-3)
    assert local.film_at(np.array([0.0]))[0] > 1.05 > 0.95 > local.film_at(np.array([1.0]))[0]


def test_a_film_in_thin_gas_is_uniform():
    film = Film((0.8, 0.9), (1.0, 1.0), local=True)
    found = solve_chamber_case(case(100.0, Chamber(1.0, 2.0, 3.0), film), SKETCH)
    assert np.abs(found.film - 1.0).max() < 5e-3


@pytest.mark.parametrize("local", [False, True])
def test_small_differences_are_linear(local):
    excess, chamber = 1e-3, Chamber(0.8, Surface(2.0, tac=0.7), reservoir(2.0))
    film = Film((0.6, 0.9), (1.0, 1.0), local=local, radiation=0.2 if local else 0.0)
    problem = case(0.8, chamber, film, DIATOMIC)
    linear = solve_chamber_case(problem, SKETCH)
    warm = replace(film, temperature=(excess, excess))
    hot = solve_chamber_case(replace(problem, film=warm, linear=False), SKETCH)
    assert hot.totals.force / excess == pytest.approx(linear.totals.force, rel=5e-3)
    assert hot.absorbed / excess == pytest.approx(linear.absorbed, rel=2e-3)
    assert hot.film[0] / excess == pytest.approx(linear.film[0], rel=1e-3)
    assert hot.imbalance < 1e-6


@pytest.mark.parametrize(
    ("change", "names"),
    [
        ({"chamber": lambda: Chamber(0.05, 4.0, 4.0)}, "floor = 0.05"),
        ({"chamber": lambda: Chamber(1.0, 4.0, 1.0)}, "side = 1"),
        ({"chamber": lambda: Chamber(1.0, 40.0, 4.0)}, "lid = 40"),
        ({"chamber": lambda: Chamber(Surface(1.0, tac=1.2), 4.0, 4.0)}, "floor_tac = 1.2"),
        ({"chamber": lambda: Chamber(Surface(1.0, temperature=-2.0), 4.0, 4.0)}, "floor_temp"),
        ({"chamber": lambda: Chamber(Surface(1.0, False, 0.1), 4.0, 4.0)}, "reservoir is at T_c"),
        ({"chamber": lambda: Chamber(900.0, 900.0, 900.0)}, "exceeds 339"),
        ({"film": "warm"}, "isothermal or local"),
        ({"radiation": 0.1}, "radiation belongs to"),
        ({"absorbed": 0.1}, "absorbed belongs to"),
        ({"film": "local", "top_temperature": 0.5}, "one temperature on both sides"),
        ({"temperature_ratio": 4.0}, "temperature_ratio"),
        ({"top_temperature": 0.0, "bottom_temperature": 0.0}, "at the gas temperature"),
        ({"knudsen": 0.01}, "knudsen = 0.01"),
        ({"tac_top": 0.0}, "tac_top"),
    ],
)
def test_bad_input_is_named(change, names):
    given = {"knudsen": 1.0, "tac_top": 0.8, "tac_bottom": 0.9} | change
    with pytest.raises(ParameterError, match=names):
        solve_in_chamber(**(given | {"chamber": given.get("chamber", lambda: None)()}))


def test_solution_tells_all_surfaces_and_the_flow(monkeypatch):
    monkeypatch.setattr(chamber_cases, "meshes", lambda *, linear: (COARSE, SKETCH))
    chamber = Chamber(0.6, 1.5, Surface(2.0, temperature=0.1))
    found = solve_in_chamber(0.5, 0.8, 0.9, chamber=chamber, film="local")
    assert set(found.forces) == set(found.heats) == {"disk", "floor", "lid", "side"}
    assert abs(found.closure["force"]) < 2e-3
    assert abs(found.closure["heat"]) < 5e-3
    flow = found.flow(np.array([0.0, 0.0, 0.0]), np.array([-0.3, 0.3, 1.6]))
    assert flow["temperature"][0] > 0.2
    assert np.isnan(flow["temperature"][2])
    assert found.to_json()["closure"] == found.closure
    assert "floor 0.6" in found.title
    assert "side 2 at +0.1" in found.title
