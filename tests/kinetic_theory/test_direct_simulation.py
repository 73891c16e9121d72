"""Direct simulation: collisions, walls and limits, and the results that are kept."""

import importlib
import math
import sys

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from lightflyer.kinetic_theory.disk.cases import Resolution
from lightflyer.kinetic_theory.disk.operators import Quadrature

KNUDSEN = 0.1
NUMBER = 20_000
NITROGEN_EXPONENT = 0.74


@pytest.fixture(scope="module")
def study(study_of):
    with study_of("direct_simulation", "study") as module:
        yield module


@pytest.fixture(scope="module")
def dsmc(study):
    """Every module of the simulation, by name."""
    names = ("cells", "collisions", "gas", "particles", "simulation", "vessel", "walls")
    return {name: importlib.import_module(f"dsmc.{name}") for name in names}


def small(dsmc, knudsen, ratio, boundary=1.6, **vessel):
    """A simulation of a thousand particles of nitrogen."""
    gas = dsmc["gas"].GASES["nitrogen"]
    faces = dsmc["walls"].build_faces("maxwell", (0.2, 1.0), (ratio, ratio), 2)
    numerics = dsmc["simulation"].Numerics(0.2, 0.2, 20.0)
    vessel = dsmc["vessel"].build_vessel(boundary, **vessel)
    return dsmc["simulation"].Simulation(gas, knudsen, faces, vessel, numerics, seed=3)


def test_without_collisions_force_and_heat_are_exact(dsmc, study):
    blocks = list(small(dsmc, math.inf, 2.25).blocks(20, 200, 50))
    for name, (mean, error) in study.means(blocks).items():
        assert error < (0.02 if name.startswith("heat") else 0.15)
        assert abs(mean - 1.0) < 3.5 * error, name


def test_gas_at_a_face_is_from_both_without_collisions(dsmc):
    """Molecules of the face fill the directions that it takes up, fewer and hotter."""
    made, ratio, height = small(dsmc, math.inf, 2.25, boundary=1.4), 2.25, -0.1
    made.run(5000)
    found = made.fields()
    inside = (found["radius"] < 0.5) & (found["height"] < 0.0) & (found["height"] > 2.0 * height)
    volume = made.cells.volume[inside]
    hot = 0.5 * (1.0 + height / math.hypot(1.0, height)) / math.sqrt(ratio)  # on the axis
    cold = 0.5 * (1.0 - height / math.hypot(1.0, height))
    expected = {"density": hot + cold}
    for name in ("temperature", "rotational_temperature"):
        expected[name] = (hot * ratio + cold) / (hot + cold)
    for name, value in expected.items():  # 3 % of noise; 15 % from one
        assert np.average(found[name][inside], weights=volume) == pytest.approx(value, rel=0.1)


class Box:
    """Gas at rest in one cell, of the density far away."""

    def __init__(self, dsmc, gas):
        self.rng = np.random.Generator(np.random.SFC64(5))
        self.collide, self.molecule = dsmc["collisions"].collide, gas.molecule(KNUDSEN)
        self.cells = dsmc["cells"].Cells(
            *(None, 0.1, 40, np.zeros((1, 1), np.int32), np.ones(1)),
            *(np.full(1, 1.0 / NUMBER), np.ones(1), np.zeros(1)),
        )
        self.particles = np.zeros(NUMBER, dsmc["particles"].PARTICLE)
        for name in ("radial", "azimuthal", "axial"):
            self.particles[name] = math.sqrt(0.5) * self.rng.standard_normal(NUMBER)
        self.fastest = np.full(1, self.molecule.cross_section)

    def step(self, duration):
        """Collisions of molecules in a time step."""
        order, first = np.arange(NUMBER, dtype=np.int32), np.array([0, NUMBER])
        return self.collide(
            self.particles,
            order,
            first,
            self.cells,
            self.fastest,
            duration,
            self.molecule,
            self.rng,
        )

    def momentum(self):
        """Per molecule, in three directions."""
        names = ("radial", "azimuthal", "axial")
        return np.array([self.particles[name].mean(dtype=float) for name in names])

    def energies(self):
        """Of translation and rotation, per molecule."""
        squares = [
            np.mean(self.particles[name].astype(float) ** 2)
            for name in ("radial", "azimuthal", "axial")
        ]
        return 0.5 * sum(squares), self.particles["rotation"].mean(dtype=float)


def collision_rate(omega, correction, temperature=1.0):
    """Collisions per molecule and time: v̄/λ, λ by Bird (1994) eq. 4.65 from the viscosity."""
    viscosity = 2.0 * KNUDSEN / math.sqrt(math.pi) / correction
    path = 2.0 * (7.0 - 2.0 * omega) * (5.0 - 2.0 * omega) / 15.0 / math.sqrt(math.pi) * viscosity
    return 2.0 / math.sqrt(math.pi) / path * temperature ** (1.0 - omega)


@pytest.mark.parametrize(("name", "omega"), [("hard spheres", 0.5), ("argon", 0.81)])
def test_rate_of_collisions_is_that_of_the_viscosity(dsmc, name, omega):
    gas = dsmc["gas"].GASES[name]
    box = Box(dsmc, gas)
    momentum, energy = box.momentum(), sum(box.energies())
    box.step(0.05)  # until the fastest pairs have been met
    collisions = sum(box.step(0.05) for _ in range(20))
    expected = 0.5 * collision_rate(omega, gas.viscosity_correction)
    assert collisions == pytest.approx(expected, rel=0.015)  # 0.4 % of noise
    assert box.momentum() == pytest.approx(momentum, abs=1e-6)
    assert sum(box.energies()) == pytest.approx(energy, rel=1e-5)


def test_viscosity_exceeds_its_first_approximation_as_published(dsmc):
    """Chapman and Cowling: 3/202 for hard spheres, nothing for Maxwell's molecules."""
    gas = dsmc["gas"].Gas
    assert gas(0.5).viscosity_correction == pytest.approx(1.0 + 3.0 / 202.0)
    assert gas(1.0).viscosity_correction == 1.0


def test_rotation_relaxes_at_the_rate_of_its_collision_number(dsmc):
    """A molecule's exchange carries the share (5 − 2ω)/(7 − 2ω) of the difference to kT.

    In one collision of Z its partner has exchanged before, and 2/(7 − 2ω) of that is less there.
    """
    number, omega, duration = 10.0, NITROGEN_EXPONENT, 0.04
    gas = dsmc["gas"].Gas(omega, number)
    box = Box(dsmc, gas)
    start = sum(box.energies())

    def rate(_, rotation):
        temperature = (start - rotation) / 1.5  # k T
        frequency = collision_rate(omega, gas.viscosity_correction, 2.0 * temperature)
        share = (5.0 - 2.0 * omega) / (7.0 - 2.0 * omega) * (1.0 - 1.0 / number / (7 - 2 * omega))
        return frequency / number * share * (temperature - rotation)

    for _ in range(50):
        box.step(duration)
    expected = solve_ivp(rate, (0.0, 50 * duration), [0.0], rtol=1e-8).y[0, -1]
    translation, rotation = box.energies()
    assert 0.3 < rotation / translation < 0.5  # on its way to 2/3
    assert rotation == pytest.approx(expected, rel=0.02)
    assert translation + rotation == pytest.approx(start, rel=1e-5)


def view_factor(radius, distance):
    """From a disk of radius 1 to one opposite (Howell's catalogue of view factors, C-41)."""
    one, other = 1.0 / distance, radius / distance
    total = 1.0 + (1.0 + other**2) / one**2
    return 0.5 * (total - math.sqrt(total**2 - 4.0 * radius**2))


def momentum_factor(radius, distance):
    """Share of the momentum of a diffuse disk's molecules along its axis that reaches another.

    Of molecules that leave as the cosine, the momentum along the normal goes as its third power.
    """
    nodes, weights = np.polynomial.legendre.leggauss(30)
    nodes, weights = 0.5 * (nodes + 1.0), 0.5 * weights
    start, end = nodes[:, None, None], radius * nodes[:, None]
    angle = math.pi * nodes
    apart = np.sqrt(distance**2 + start**2 + end**2 - 2.0 * start * end * np.cos(angle))
    share = 1.5 * distance**3 / (math.pi * apart**5) * start * 2.0 * end * 2.0 * math.pi * radius
    return np.einsum("ijk,i,j,k", share, weights, weights, weights)


@pytest.mark.parametrize(("solid", "warmth"), [("floor side", 1.0), ("floor", 2.0)])
def test_floor_without_collisions_is_exact(dsmc, study, solid, warmth):
    """As many molecules leave each part of a wall as arrive: those of gas at rest.

    A floor as cold as the gas is thus no floor for the disk. That of another temperature pushes and
    heats by what the disk sees of it.
    """
    ratio, radius, distance = 2.25, 1.6, 1.0
    made = small(
        dsmc, math.inf, ratio, radius, floor=distance, solid=solid, floor_temperature=warmth
    )
    force, (top, bottom) = dsmc["walls"].free_molecular(made.faces)
    seen, pushed = view_factor(radius, distance), momentum_factor(radius, distance)
    expected = {
        "force": 1.0 + 0.5 * pushed * (math.sqrt(warmth) - 1.0) / force,
        "heat": (top + bottom * (1.0 - seen * (warmth - 1.0) / (ratio - 1.0))) / (top + bottom),
    }
    if warmth == 1.0:
        expected["force_floor"] = 0.5 * pushed * (math.sqrt(ratio) - 1.0) / force
        expected["heat_floor"] = seen * bottom / (top + bottom)
    for whole in ("force", "heat"):
        expected[f"{whole}_reservoir"] = expected[whole]
    found = study.means(list(made.blocks(20, 800, 100)), expected)
    for name, (mean, error) in found.items():
        assert error < (0.02 if name.startswith("heat") else 0.1)
        assert abs(mean - expected[name]) < 3.5 * error, name


@pytest.mark.parametrize("vessel", [{}, {"floor": 1.0, "solid": "floor side"}])
def test_nothing_happens_at_equal_temperatures(dsmc, vessel):
    """Neither force nor heat on the disk, density and temperature of the reservoir."""
    made = small(dsmc, 0.3, 1.0, **vessel)
    blocks = list(made.blocks(20, 400, 400))
    for name in ("force_mean", "heat_mean"):
        values = np.array([getattr(block, name) for block in blocks])
        error = values.std(ddof=1) / math.sqrt(values.size)
        assert error < 0.02  # at T_h/T_c = 2: 0.2 and 1.0
        assert abs(values.mean()) < 3.5 * error
    expected = (made.cells.volume / made.cells.weight).sum()
    assert np.mean([block.particles for block in blocks]) == pytest.approx(expected, rel=0.03)
    found = made.fields()
    assert np.average(found["temperature"], weights=made.cells.volume) == pytest.approx(1, rel=0.02)


def test_vessel_without_an_opening_is_refused(dsmc):
    with pytest.raises(ValueError, match="holds the pressure"):
        dsmc["vessel"].build_vessel(4.0, solid="floor lid side")
    with pytest.raises(ValueError, match="'roof': must be of floor, side, lid"):
        dsmc["vessel"].build_vessel(4.0, solid="roof")


@pytest.mark.parametrize("wall", ["maxwell", "accommodated", "cercignani-lampis"])
def test_walls_push_and_heat_as_they_should_without_collisions(dsmc, wall):
    walls = dsmc["walls"]
    rng = np.random.Generator(np.random.SFC64(7))
    number, ratio, tac = 10_000, 2.25, 0.4
    normal = np.sqrt(rng.standard_exponential(number))
    first, second = math.sqrt(0.5) * rng.standard_normal((2, number))
    rotation = 0.5 * rng.standard_exponential(number).astype(np.float32)
    faces = walls.build_faces(wall, (1.0, tac), (1.0, ratio), 2, (1.0, 0.7))
    arriving = np.stack([normal, first, second, rotation], axis=1)
    leaving = np.array(
        [walls.leave(faces, 1, 0.5, 0.01, *one, rng) for one in _molecules(arriving)]
    )
    # half a Maxwellian brings √π/2 of momentum and v̄/4 = 1/(2√π) of molecules
    force, (_, heat) = walls.free_molecular(faces)
    push = leaving[:, 0].mean() / (0.5 * math.sqrt(math.pi)) - 1.0
    assert 0.5 * push == pytest.approx(force, rel=0.06)  # 2 % of noise
    gained = _energy(leaving) - _energy(arriving)
    assert gained / math.sqrt(math.pi) == pytest.approx(heat, rel=0.04)  # 1.4 % of noise


def _molecules(arriving):
    for normal, first, second, rotation in arriving.tolist():
        yield normal, first, second, np.float32(rotation)


def _energy(molecules):
    return 0.5 * np.mean(np.sum(molecules[:, :3] ** 2, axis=1)) + molecules[:, 3].mean()


def test_maxwells_walls_push_as_the_package_says(dsmc):
    free = importlib.import_module("lightflyer.kinetic_theory.walls").FreeMolecularDisk
    for freedoms in (0, 2):
        faces = dsmc["walls"].build_faces("maxwell", (0.4, 0.9), (1.5, 2.5), freedoms)
        force, heat = dsmc["walls"].free_molecular(faces)
        other = free((0.4, 0.9), (1.5, 2.5), False, freedoms > 0)
        assert force == pytest.approx(other.force)
        assert heat == pytest.approx(other.heat)


def test_kept_results_agree_with_another_program(study):
    """Within 3 standard errors each, and by both measures of the force."""
    results, peer = study.combined(study.read_runs()), study.read_peer()
    compared = [point for point in results if point in peer]
    assert len(compared) >= 3
    for point in compared:
        for name in {"force", "heat"} & set(peer[point]):
            (ours, error), (theirs, other) = results[point][name], peer[point][name]
            assert abs(ours - theirs) < 3.0 * math.hypot(error, other), (point, name)
    for result in results.values():
        (faces, error), (reservoir, other) = result["force"], result["force_reservoir"]
        assert abs(faces - reservoir) < 3.0 * math.hypot(error, other)


def test_every_point_of_the_study_is_kept(study):
    made = {point for point, _, _ in study.read_runs()}
    assert set(study.POINTS_TO_RUN) <= made


def test_runs_are_read_as_they_were_kept(study, tmp_path, monkeypatch):
    monkeypatch.setattr(study, "POINTS", tmp_path / "points.jsonl")
    assert study.read_runs() == []
    point = study.Point("argon", 0.3, 2.0, 0.4, 1.0, "accommodated", floor=2.0, solid="floor")
    runs = [
        (point, seed, dict.fromkeys(point.measured, (value, 0.3)))
        for seed, value in enumerate((0.5, 0.7))
    ]
    for run in runs:
        study.keep(run, 1.0)
    assert study.read_runs() == runs
    (result,) = study.combined(runs).values()
    assert result["force"] == pytest.approx((0.6, 0.3 / math.sqrt(2.0)))
    assert any("0.6000 ± 0.2121" in line for line in study.table())


def test_cells_fill_the_reservoir(dsmc):
    build, vessel = dsmc["cells"].build_cells, dsmc["vessel"].build_vessel
    cells = build(vessel(4.0, 2.25, 3.0), 0.1, 20.0)
    assert cells.volume.sum() == pytest.approx(math.pi * 4.0**2 * (2.25 + 3.0))
    assert np.average(cells.height, weights=cells.volume) == pytest.approx(0.5 * (3.0 - 2.25))
    finest = cells.volume / (2.0 * math.pi * cells.radius) < 1.5 * 0.05**2
    assert np.all(np.abs(cells.radius[finest] - 1.0) < 0.2)
    with pytest.raises(ValueError, match="multiple"):
        build(vessel(4.0, 2.26), 0.1, 20.0)


def test_hot_solver_beside_simulations_of_walls_of_cercignani_and_lampis(study):
    """With the collisions of Maxwell's walls force is right; with the model's factors heat is."""
    scattering = importlib.import_module("scattering")
    with scattering.float64():
        compared = scattering.compared()
    assert len(compared) == 11
    assert {p for p in study.POINTS_TO_RUN if p.wall == study.CL} == set(compared)
    for point, row in compared.items():
        force, heat = np.divide(row.corrected, row.simulated) - 1.0
        assert abs(heat) < 0.0045, point
        assert -0.045 < force < 0.0 or point.gas == "hard spheres", point
        assert row.solver[0] < row.simulated[0]
        found, error = row.by_walls
        assert abs(found - row.simulated[0]) < 2.0 * np.hypot(error, row.error[0]), point
    # the code as it is gives a line of scattering.jsonl again, but for its finer mesh
    point = next(p for p in compared if p.gas == "argon" and p.knudsen > 0.5)
    found = scattering.solve_point(point, Resolution(3, 0.7, Quadrature(3, 3, 3)))
    assert found == pytest.approx(compared[point].solver, rel=2e-3)
    del sys.modules["scattering"]
