"""Floor, lid and side wall around the kinetic disk, and a film that is not isothermal."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from kinetic_fits.surfaces import fit_chamber

import lightflyer as lf
from lightflyer.array.namespace import float64
from lightflyer.core.errors import ParameterError
from lightflyer.files.table import shipped_table
from lightflyer.force.kinetic.chamber import (
    FORCE_ERROR,
    PUSH_ERROR,
    SurfaceDistances,
    chamber_fit,
)

RADIUS = 0.01
COLD = 293.0


@pytest.fixture(scope="module")
def table():
    return dict(shipped_table("kinetic_chamber.csv").numbers)


def state_at(knudsen, **more):
    """Surroundings in which the disk has this Knudsen number; distances in radii."""
    pressure = lf.gas.mean_free_path(1.0, COLD, lf.gas.AIR) / (2.0 * RADIUS * knudsen)
    distances = {f"{name}_distance": value * RADIUS for name, value in more.items()}
    state = lf.Chamber(temperature=COLD).state(float(pressure))
    return replace(state, **distances)


def disk(top=0.8, bottom=0.9):
    film = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=top, tac_bottom=bottom)
    return lf.Disk(film, RADIUS)


def misfits(fit, table):
    place = SurfaceDistances(table["floor"], table["lid"], table["wall"])
    opened = 0.5, table["open_heat_ratio"]
    with float64():
        walls = fit.walls(table["knudsen"], place, opened, 0.85)
        factors = walls.force_ratio(opened[0]) / opened[0], walls.heat_ratio(opened[1]) / opened[1]
        force, heat, lift = map(np.asarray, (*factors, walls.lift))
    return {
        "force": force / table["force_factor"] - 1.0,
        "heat": heat / table["heat_factor"] - 1.0,
        "lift": (lift - table["lift"]) / table["force"],
    }


def test_fit_follows_the_table(table):
    found = misfits(chamber_fit(), table)
    for name, bound in (("force", 0.02), ("heat", 0.003), ("lift", 0.03)):
        assert np.sqrt(np.mean(found[name] ** 2)) < bound, name


def test_fit_predicts_chambers_that_it_was_not_shown(table):
    hidden = (table["floor"] == 3.0) & (table["wall"] == 6.0)
    assert hidden.any()
    fit = fit_chamber({name: column[~hidden] for name, column in table.items()})
    found = misfits(fit, {name: column[hidden] for name, column in table.items()})
    for name, bound in (("force", 0.05), ("heat", 0.01), ("lift", 0.06)):
        assert np.abs(found[name]).max() < bound, name


def test_far_surfaces_do_nothing():
    model = lf.Kinetic(wall="maxwell")
    opened, far = state_at(0.1), state_at(0.1, floor=1e5, lid=1e5, wall=1e5)
    for quantity in (model.force, lambda *a: model.heat_loss(*a)[0]):
        values = [float(quantity(disk(), state, (0.5,))) for state in (opened, far)]
        assert values[1] == pytest.approx(values[0], rel=1e-3)


def test_alike_above_and_below_a_disk_of_like_faces_is_not_pushed():
    model, plain = lf.Kinetic(), disk(0.85, 0.85)
    weight = 0.1 * 293.0
    for place in ({"floor": 2.0, "lid": 2.0, "wall": 4.0}, {"floor": 1.0, "lid": 1.0}):
        state = state_at(0.1, **place)
        assert abs(float(model.force(plain, state, (0.5,)))) < 1e-12 * weight


def test_turned_over_the_force_is_reversed():
    model = lf.Kinetic(wall="maxwell")
    below = float(model.force(disk(), state_at(0.1, floor=2.0, lid=5.0), (0.5,)))
    above = float(model.force(disk(0.9, 0.8), state_at(0.1, floor=5.0, lid=2.0), (0.5,)))
    assert above == pytest.approx(-below, rel=1e-9)


def test_a_floor_lifts_a_disk_of_like_faces_whichever_is_on_top():
    state = replace(state_at(0.1, floor=2.25, lid=10.0, wall=10.0), floor_excess=0.1)
    lifts = []
    for tilt in (0.0, np.pi):
        turned = replace(disk(0.85, 0.85), attitude=lf.environment.Attitude(tilt=tilt))
        along_axis = float(lf.Kinetic().force(turned, state, (0.5,)))
        lifts.append(along_axis * np.cos(tilt))
    assert lifts[0] > 0.0
    assert lifts[1] == pytest.approx(lifts[0], rel=1e-12)


def test_a_disk_as_cold_as_the_gas_is_not_pushed():
    state = state_at(0.1, floor=2.0, wall=4.0, lid=4.0)
    assert float(lf.Kinetic().force(disk(), state, (0.0,))) == 0.0


@pytest.mark.parametrize(
    ("model", "state", "words"),
    [
        (lf.Kinetic(), state_at(0.1, floor=0.2, wall=3.0), ("the floor", "0.2")),
        (lf.Kinetic(), state_at(0.01, floor=2.0), ("table of chambers", "0.01")),
        (lf.Kinetic(), replace(state_at(0.1, floor=2.0), gas=lf.gas.ARGON), ("diatomic",)),
        (lf.Kinetic(film_balance="local"), state_at(0.01), ("locally",)),
    ],
)
def test_what_is_outside_the_tables_is_said(model, state, words):
    told = model.diagnostics(disk(), state, 400.0)
    assert [text for text in told if all(word in text for word in words)]
    assert not [t for t in lf.Kinetic().diagnostics(disk(), state_at(0.1), 400.0) if "floor" in t]


@pytest.mark.parametrize("model", [lf.Lu2023(), lf.force.FreeMolecular()])
def test_a_model_that_knows_no_floor_says_so(model):
    chamber = lf.Chamber(floor=0.045)
    found = lf.predict(disk(), chamber, model, at=[5.0])
    assert any("floor and lid have no effect" in text for text in found.warnings)


# computed by others than the package's solver: open space, equal absorbed power, TACs 0.8 and 0.9
@pytest.mark.parametrize(
    ("excess", "ratios"), [(1e-3, (0.998, 0.976, 0.918)), (1.2, (0.999, 0.994, 0.978))]
)
def test_a_film_that_balances_its_heat_locally_is_pushed_less(excess, ratios):
    film = lf.FilmProperties(1e-3, 0.75, 1e-9, 1e-9, tac_top=0.8, tac_bottom=0.9)  # gas cools alone
    cold, isothermal = lf.Disk(film, RADIUS), lf.Kinetic()
    local = lf.Kinetic(film_balance="local")
    for knudsen, ratio in zip((0.3, 0.1, 0.05), ratios, strict=True):
        state = state_at(knudsen)
        pushed, lost = (
            float(quantity(local)) / float(quantity(isothermal))
            for quantity in (
                lambda model, state=state: model.force(cold, state, (excess,)),
                lambda model, state=state: model.heat_loss(cold, state, (excess,))[0],
            )
        )
        assert pushed / lost == pytest.approx(ratio, abs=0.004)


def test_radiation_evens_the_film_out():
    state = state_at(0.05)
    black = lf.Disk(lf.FilmProperties(1e-3, 0.75, 1.0, 1.0, tac_top=0.8, tac_bottom=0.9), RADIUS)

    def kept(flyer):
        both = (lf.Kinetic(film_balance=how) for how in ("local", "isothermal"))
        one, other = (float(model.force(flyer, state, (0.3,))) for model in both)
        return one / other

    assert kept(disk()) < kept(black) < 1.0


def test_a_bad_balance_is_named():
    with pytest.raises(ParameterError, match="film_balance"):
        lf.Kinetic(film_balance="adiabatic")


@pytest.mark.parametrize("place", [lf.Earth(floor=0.02), lf.environment.Mars(floor=0.02)])
def test_ground_below_in_open_air(place):
    altitude = 70e3 if isinstance(place, lf.Earth) else 50e3
    model = lf.Kinetic(polyatomic="scaled")
    light = [
        float(lf.levitate(disk(), world.state(altitude), model).irradiance)
        for world in (replace(place, floor=None), place)
    ]
    assert 0.1 * light[0] < light[1] < 0.5 * light[0]  # a floor two radii away
    assert any(text.startswith("solid floor 2 cm below") for text in place.assumptions())


# solved, non-linear (lightflyer.kinetic_theory.solve_in_chamber): nitrogen, floor, lid = side wall,
# TACs, T_h/T_c, force [p A]
HOT = [
    (0.0982, 2.25, 4.0, (0.8, 0.9), 2.341463, 0.008789),
    (0.2945, 2.25, 4.0, (0.8, 0.9), 2.341463, 0.018146),
    (0.0982, 2.25, 4.0, (0.85, 0.85), 2.341463, 0.001705),
    (0.0982, 2.25, 4.0, (0.8, 0.9), 1.6, 0.004055),
    (0.0982, 2.25, 10.0, (0.8, 0.9), 1.8, 0.006500),
    (0.0982, 2.25, 10.0, (0.85, 0.85), 1.8, 0.002705),
]


@pytest.mark.parametrize(("knudsen", "floor", "around", "tacs", "ratio", "solved"), HOT)
def test_hot_disks_in_chambers_are_met_within_the_stated_error(
    knudsen, floor, around, tacs, ratio, solved
):
    """Of which the collisions' part is left out: the solver has the model equation's too."""
    gas, cold = lf.gas.NITROGEN, 205.0
    pressure = float(lf.gas.mean_free_path(1.0, cold, gas)) / (2.0 * RADIUS * knudsen)
    place = {"floor": floor, "lid": around, "radius": around}
    chamber = lf.Chamber(temperature=cold, gas=gas, **{k: v * RADIUS for k, v in place.items()})
    model, body = lf.Kinetic(wall="maxwell", collisions="shakhov"), disk(*tacs)
    force = float(model.force(body, chamber.state(pressure), (ratio - 1.0,)))
    push = float(model.force(disk(0.85, 0.85), chamber.state(pressure), (ratio - 1.0,)))
    unit = pressure * float(body.area)
    allowed = np.hypot(FORCE_ERROR * (force - push), PUSH_ERROR * push) / unit
    assert abs(force / unit - solved) < 2.0 * allowed


@pytest.mark.parametrize(
    ("knudsen", "simulated", "noise"), [(0.2945, 0.734, 0.003), (0.0982, 0.358, 0.002)]
)
def test_a_solid_floor_by_direct_simulation(knudsen, simulated, noise):
    """Nitrogen, TACs 0.01 and 1, T_h/T_c 2.34, over that of free molecules; lid and side open."""
    gas, cold, ratio = lf.gas.NITROGEN, 205.0, 480.0 / 205.0
    pressure = float(lf.gas.mean_free_path(1.0, cold, gas)) / (2.0 * RADIUS * knudsen)
    far = {"floor": 2.25 * RADIUS, "lid": 4.0 * RADIUS, "radius": 4.0 * RADIUS}
    body, state = disk(0.01, 1.0), lf.Chamber(temperature=cold, gas=gas, **far).state(pressure)
    force, above = (
        float(lf.Kinetic(each, wall="maxwell").force(body, state, (ratio - 1.0,)))
        for each in (0.0, 1.0)
    )
    free = 0.5 * 0.99 * (np.sqrt(ratio) - 1.0) * pressure * float(body.area)
    assert abs(force / free - simulated) < 2.0 * np.hypot(noise, (above - force) / free)


def test_walls_do_nothing_to_free_molecules():
    tiny = replace(disk(), radius=1e-9)
    state = lf.Chamber(floor=3e-9, lid=3e-9, radius=3e-9).state(1e-15)
    opened = lf.Chamber().state(1e-15)
    forces = [float(lf.Kinetic().force(tiny, each, (0.5,))) for each in (state, opened)]
    assert forces[0] == pytest.approx(forces[1], rel=1e-9)
    assert forces[0] > 0.0


def test_the_page_of_experiments_has_what_a_floor_adds():
    """The largest lift over that far from any floor."""
    page = (Path(__file__).parents[2] / "docs" / "experiments.md").read_text(encoding="utf-8")
    film = lf.FilmProperties(1.15e-3, 0.75, 0.08, 0.08, tac_top=0.79, tac_bottom=0.90)
    pressure = np.geomspace(0.2, 15.0, 60)
    for size in (0.02, 0.04, 0.08):

        def most(disk, far, **floor):
            around = lf.Chamber(radiation=lf.environment.Radiation(3e3), radius=far, **floor)
            return np.max(lf.lift(disk, around.state(pressure), lf.Kinetic()))

        disk, far = lf.Disk(film, radius=0.5 * size), 5.0 * size
        shares = (0.25, 0.5, 1.0, 1.5, 2.0, 3.0)
        lifts = [most(disk, far, floor=share * size, lid=far) for share in shares]
        row = " | ".join(f"{lift / most(disk, far):.1f}" for lift in lifts)
        assert f"| {100 * size:g} cm | {row} |" in page
