"""The kinetic force model of a sandwich: limits, the solver, the disk, and the calculus."""

import numpy as np
import pytest
from kinetic_fits import sandwich
from kinetic_fits.common import some, table_of

import lightflyer as lf
from lightflyer.array import tree
from lightflyer.force.kinetic import sandwich_table as tables
from lightflyer.force.kinetic.ratios import kinetic_fit
from lightflyer.force.membranes.sandwich import rarefaction
from lightflyer.kinetic_theory.disk.cases import COARSE, Case, solve_case
from lightflyer.kinetic_theory.model_gases import DIATOMIC

COLD = 220.0
# as the solver has it: with the model equation's collisions
ALIGNED = lf.Kinetic(wall="maxwell", collisions="shakhov")
WIDE = lf.Kinetic(transmission="wide", collisions="shakhov")
INSULATED = (1e-15, 1e-15)  # inner faces between which nothing is conducted


def make(tac=(0.8, 0.9), inner=(0.8, 0.7), **changed):
    top = lf.FilmProperties(3e-4, 0.02, 0.10, 0.20, tac[0], inner[0], transmittance=0.9)
    bottom = lf.FilmProperties(4e-4, 0.60, 0.30, 0.05, inner[1], tac[1])
    numbers = {
        "radius": 0.01,
        "gap": 1e-4,
        "open_fraction": 0.5,
        "hole_radius": 5e-5,
        "support_fraction": 1e-4,
        "support_conductivity": 1.8,
    }
    return lf.Sandwich(top, bottom, **(numbers | changed))


def state_at(pressure, **more):
    radiation = lf.environment.Radiation(irradiance=more.pop("irradiance", 1361.0))
    return lf.environment.EnvironmentState(
        pressure, COLD, 9.7, lf.gas.US1976_AIR, radiation, **more
    )


def pressure_of(delta):
    with lf.float64():
        return delta / float(rarefaction(0.01, 1.0, COLD, lf.gas.US1976_AIR))


@pytest.mark.parametrize("beta", [0.0, 0.3, 0.9, 0.99])
def test_limit_of_free_molecules_is_exact(beta):
    """Maxwell walls: each outer face for itself, with its own TAC."""
    flyer, pressure = make(inner=INSULATED, open_fraction=beta, support_fraction=0.0), 1e-9
    excess, area = np.array([0.2, 0.7]), np.pi * 0.01**2
    shares = (1.0 - beta) * np.array([0.8, 0.9])
    pushed = shares * (np.sqrt(1.0 + excess) - 1.0)
    force = 0.5 * pressure * area * (pushed[1] - pushed[0])
    state = state_at(pressure)
    assert ALIGNED.force(flyer, state, tuple(excess)) == pytest.approx(force, rel=1e-6, abs=0.0)
    speed = lf.gas.US1976_AIR.mean_speed(COLD)
    heat = 6.0 / 8.0 * speed * pressure * area * shares * excess
    found = ALIGNED.heat_loss(flyer, state, tuple(excess))
    assert np.asarray(found) == pytest.approx(heat, rel=1e-6, abs=0.0)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("delta", "beta", "tac", "face"),
    [(0.8, 0.5, (0.7, 0.9), 0), (0.8, 0.5, (0.7, 0.9), 1), (5.0, 0.3, (0.85, 0.75), 1)],
)  # fmt: skip
def test_the_solver_between_the_tables_points(delta, beta, tac, face):
    """One face hot, by the linear equation: the force to 1 %, the heat to 0.5 %."""
    faces = (1.0, 0.0) if face == 0 else (0.0, 1.0)
    case = Case(delta, tac, faces, linear=True, gas=DIATOMIC, boundary=np.inf, open_fraction=beta)
    solved = solve_case(case, COARSE)
    flyer = make(tac, INSULATED, open_fraction=beta, support_fraction=0.0)
    pressure, small = pressure_of(delta), 1e-6
    state, excess = state_at(pressure), tuple(small * value for value in faces)
    scale = pressure * np.pi * 0.01**2 * small
    assert ALIGNED.force(flyer, state, excess) / scale == pytest.approx(solved.force, rel=0.012)
    scale *= np.sqrt(2.0 * lf.gas.US1976_AIR.specific_gas_constant * COLD)
    found = np.asarray(ALIGNED.heat_loss(flyer, state, excess)) / scale
    assert found[face] == pytest.approx(solved.heat[face], rel=0.005)
    assert found[1 - face] == pytest.approx(solved.heat[1 - face], abs=0.01 * solved.heat[face])


@pytest.mark.parametrize("excess", [1e-3, 0.8])
@pytest.mark.parametrize("delta", [0.5, 3.0, 12.0])
def test_without_holes_it_is_a_disk(delta, excess):
    """Both membranes as warm: the disk of the same outer faces, force and heat.

    The sandwich's table leaves out the difference of the TACs.
    """
    state, tac = state_at(pressure_of(delta)), (0.78, 0.82)
    sandwich = make(tac, open_fraction=0.0)
    disk = lf.Disk(lf.FilmProperties(1e-3, 0.7, 0.1, 0.1, *tac), 0.01)
    alone, both = ALIGNED.force(disk, state, (excess,)), (excess, excess)
    assert ALIGNED.force(sandwich, state, both) == pytest.approx(alone, rel=1e-3, abs=0.0)
    (heat,) = ALIGNED.heat_loss(disk, state, (excess,))
    found = sum(ALIGNED.heat_loss(sandwich, state, both))
    assert found == pytest.approx(heat, rel=2e-3, abs=0.0)
    # collisions of molecules change both alike
    real = lf.Kinetic(wall="maxwell")
    changes = [
        real.force(flyer, state, unknowns) / ALIGNED.force(flyer, state, unknowns)
        for flyer, unknowns in ((disk, (excess,)), (sandwich, both))
    ]
    assert changes[0] == pytest.approx(changes[1], rel=1e-3)
    assert abs(changes[0] - 1.0) > 0.005


def test_no_force_in_an_isothermal_world():
    flyer = make()
    for model in (ALIGNED, WIDE):
        for pressure in (1e-3, 1.0, 100.0):
            state = state_at(pressure, irradiance=0.0)
            found = lf.equilibrium(flyer, state, model)
            assert found.temperatures == (COLD, COLD)
            assert abs(lf.lift(flyer, state, model)) <= 1e-12 * pressure * flyer.area


@pytest.mark.parametrize("gas", ["diatomic", "monatomic"])
def test_fit_follows_the_table(gas):
    table = table_of("kinetic_sandwich", gas)
    kept = (table.rarefaction <= 35.0) & (table.open_fraction <= 0.95)
    share = (1.0 - table.open_fraction) * table.tac
    found = tables.Ratios(
        tables.sandwich_fit(gas), table.rarefaction, table.open_fraction, table.tac, share, 1.0
    )
    for name, most in (
        ("force", 4e-3), ("tac_force", 1.4e-2), ("heat", 6e-3), ("heat_difference", 8e-3)
    ):  # fmt: skip
        misfit = np.asarray(getattr(found, name)) / getattr(table, f"{name}_ratio") - 1.0
        assert np.all(np.abs(misfit[kept]) < most), name


def test_fit_predicts_rows_it_was_not_shown():
    """At an open fraction within the table, from all others."""
    table = table_of("kinetic_sandwich", "diatomic")
    rest = table_of("kinetic_sandwich_hot"), table_of("kinetic_sandwich_boundary")
    rows = table.open_fraction != 0.4
    kept = ~rows & (table.rarefaction <= 20.0)
    delta, tac = table.rarefaction[kept], table.tac[kept]
    fit = sandwich.fit(kinetic_fit("diatomic"), some(table, rows), *rest)
    found = tables.Ratios(fit, delta, 0.4, tac, 0.6 * tac, 1.0)
    assert np.asarray(found.force) == pytest.approx(table.force_ratio[kept], rel=5e-3)
    assert np.asarray(found.tac_force) == pytest.approx(table.tac_force_ratio[kept], rel=1.5e-2)
    assert np.asarray(found.heat) == pytest.approx(table.heat_ratio[kept], rel=5e-3)


@pytest.mark.slow
def test_walls_press_the_more_the_nearer():
    """A chamber raises the force; far walls change nothing."""
    flyer, delta = make(), 2.2
    forces = [
        ALIGNED.force(flyer, state_at(pressure_of(delta), wall_distance=distance), (0.0, 0.2))
        for distance in (0.03, 0.1, 1e4)
    ]
    opened = ALIGNED.force(flyer, state_at(pressure_of(delta)), (0.0, 0.2))
    assert forces[0] > forces[1] > forces[2]
    assert forces[2] == pytest.approx(opened, rel=1e-4)
    # the solver itself, within a reservoir and in open space
    near, free = (
        solve_case(Case(delta, (0.9, 0.8), (0.0, 1.0), True, DIATOMIC, place, 0.5), COARSE).force
        for place in (3.0, np.inf)
    )
    assert forces[0] / opened == pytest.approx(near / free, rel=0.015)


def test_error_of_the_model():
    flyer, state = make(), state_at(10.0)
    low, high = (
        lf.Kinetic(force_error=sign, collisions="shakhov").force(flyer, state, (0.1, 0.3))
        for sign in (-1.0, 1.0)
    )
    middle = ALIGNED.force(flyer, state, (0.1, 0.3))
    assert low < middle < high
    assert (high - low) / (2.0 * middle) == pytest.approx(0.165 * (1.0 - 0.3), rel=0.4)
    warm = lf.Kinetic(heat_error=1.0, collisions="shakhov").heat_loss(flyer, state, (0.1, 0.3))
    assert sum(warm) > sum(ALIGNED.heat_loss(flyer, state, (0.1, 0.3)))


def test_what_is_outside_the_models_range():
    flyer = make()
    assert ALIGNED.diagnostics(flyer, state_at(1.0), 300.0) == ()
    told = ALIGNED.diagnostics(make((0.3, 0.9)), state_at(500.0), 700.0)
    for words in (
        "rarefaction parameter",
        "T_h/T_c",
        "difference of the outer TACs",
        "hole_radius",
    ):
        assert any(words in text for text in told), words
    held = "what heat does to force or heat loss outside its table, rarefactions 0.6 to 7"
    warm, hot = 1.02 * COLD, 1.6 * COLD
    for delta, temperature, is_told in ((3.0, hot, 0), (20.0, warm, 0), (20.0, hot, 1)):
        found = ALIGNED.diagnostics(flyer, state_at(pressure_of(delta)), temperature)
        assert sum(text.startswith(held) for text in found) == is_told
    chamber = state_at(pressure_of(30.0), wall_distance=0.05)
    assert any(
        "the table of walls ends there" in text
        for text in ALIGNED.diagnostics(flyer, chamber, warm)
    )
    disk = lf.Disk(lf.FilmProperties(1e-3, 0.7, 0.1, 0.1, 0.8, 0.9), 0.01)
    assert WIDE.diagnostics(disk, state_at(1.0), 300.0) == (
        "transmission = wide has no effect: a disk has no holes",
    )


def test_derivatives_jit_and_vmap(require_derivatives):
    state = state_at(pressure_of(3.0))

    def payload(numbers):
        flyer = tree.replace_at(lambda f: (f.open_fraction, f.bottom.tac_bottom), make(), numbers)
        return 1e6 * lf.payload(flyer, state, ALIGNED)[None]

    require_derivatives(payload, np.array([0.4, 0.8]), rtol=1e-5, atol=1e-9)
