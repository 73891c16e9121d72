"""Walls of the kinetic model of a disk: free molecules, the solver's table, and what is said."""

import dataclasses
from types import SimpleNamespace

import numpy as np
import pytest
from kinetic_fits import surfaces

import lightflyer as lf
from lightflyer.design.setup import Setup
from lightflyer.files.table import shipped_table
from lightflyer.force.kinetic import walls as kinetic_walls
from lightflyer.force.kinetic.ratios import kinetic_fit
from lightflyer.force.kinetic.walls import sharing_factor, wall_fit
from lightflyer.prediction.prediction import Prediction

COLD, EXCESS = 205.0, 1.34
CL = "cercignani-lampis"
KINDS = ("normal", "tangential", "rotational")
MODEL = lf.Kinetic()
ONE_ERROR = ({"force_error": 1.0, "heat_error": 1.0}, {"wall_error": 1.0})


def state_at(knudsen, gas=lf.gas.AIR):
    pressure = lf.gas.mean_free_path(1.0, COLD, gas) / (0.02 * knudsen)
    return lf.environment.EnvironmentState(pressure, COLD, 9.6, gas, lf.environment.Radiation())


def test_thin_gas_gives_the_free_molecules_of_each_wall(disk):
    state = state_at(1e6)
    (free,) = lf.FreeMolecular().heat_loss(disk, state, (EXCESS,))

    def push(top, bottom):
        return 0.5 * state.pressure * disk.area * (bottom - top)

    reflecting = np.sqrt(1.0 + EXCESS) - 1.0
    maxwell = push(0.8 * reflecting, 0.9 * reflecting)
    accommodated = push(*(np.sqrt(1.0 + tac * EXCESS) for tac in (0.8, 0.9)))
    # the paper's walls, whose tangential momentum accommodates to 0.9
    normal = [2.0 * tac - 0.9 * 1.1 for tac in (0.8, 0.9)]
    slippery = push(*(np.sqrt(1.0 + tac * EXCESS) for tac in normal))
    for model, expected in (
        (lf.Kinetic(wall="maxwell"), maxwell),
        (lf.Kinetic(wall="accommodated"), accommodated),
        (lf.Kinetic(wall=CL), accommodated),
        (lf.Kinetic(wall=CL, tangential_accommodation=0.9), slippery),
        (lf.Kinetic(), 0.5 * (maxwell + accommodated)),
    ):
        assert model.force(disk, state, (EXCESS,)) / expected == pytest.approx(1.0, rel=1e-5)
    (heat,) = lf.Kinetic().heat_loss(disk, state, (EXCESS,))
    assert heat / free == pytest.approx(1.0, rel=1e-4)
    # what decides whether the paper's disk flies
    assert maxwell / accommodated == pytest.approx(1.156, abs=1e-3)


def ends_of(model, function, disk, state, **stated):
    """Force or heat loss at the bounds of the 95 % error of the walls, Maxwell's side last."""
    bound = 1.959963984540054
    models = (lf.Kinetic(wall=model.wall, wall_error=e * bound, **stated) for e in (-1.0, 1.0))
    return [np.ravel(function(m, disk, state, (EXCESS,)))[0] for m in models]


@pytest.mark.parametrize("knudsen", [0.05, 0.5])
def test_unknown_walls_reach_from_one_to_the_other(disk, knudsen):
    """Their bounds contain both walls, with other collisions at each and with the same."""
    state, unknown = state_at(knudsen), lf.Kinetic()
    maxwell, accommodated = (lf.Kinetic(wall=wall) for wall in ("maxwell", "accommodated"))
    force, heat = type(unknown).force, type(unknown).heat_loss
    low, high = ends_of(unknown, heat, disk, state)
    known = [np.ravel(heat(m, disk, state, (EXCESS,)))[0] for m in (accommodated, maxwell)]
    assert (low, high) == pytest.approx(known, rel=1e-12)
    low, high = ends_of(unknown, force, disk, state)
    top = force(maxwell, disk, state, (EXCESS,))
    bottom = force(accommodated, disk, state, (EXCESS,))
    assert low < bottom < top < high
    # half of the difference of free molecules, which are 15.6 % apart
    assert high - low == pytest.approx((1.0 - 1.0 / 1.1560) * top, rel=1e-3)
    assert 0.5 * (low + high) == pytest.approx(0.5 * (top + bottom), rel=1e-12)
    # accommodated walls with the collisions of Maxwell's
    same, itself = (
        ends_of(accommodated, force, disk, state)[1],
        ends_of(maxwell, force, disk, state),
    )
    assert same == pytest.approx(top / 1.1560, rel=1e-3)
    assert itself == pytest.approx([top, top], rel=1e-12)


@pytest.fixture
def study(study_of):
    with study_of("kinetic_walls", "study") as module:
        yield module


@pytest.fixture
def direct_simulation(study_of):
    """The study and the walls of direct simulation."""
    with study_of("direct_simulation", "study", "dsmc.walls") as modules:
        yield modules.values()


def table_of(gas):
    table = shipped_table("kinetic_walls.csv")
    kept = np.array(table.texts["gas"]) == gas
    return {name: column[kept] for name, column in table.numbers.items()}


def misfits(fit, table):
    """Relative deviations of force and heat from the table."""
    where = (table["knudsen"], table["temperature_ratio"], table["tac"])
    with lf.float64():
        return [
            abs(
                np.asarray(factor(*where))
                * table[f"{name}_ratio_maxwell"]
                / table[f"{name}_ratio_accommodated"]
                - 1.0
            )
            for name, factor in (("force", fit.force_factor), ("heat", fit.heat_factor))
        ]


@pytest.mark.parametrize("gas", ["monatomic", "diatomic"])
def test_fit_follows_the_table_and_predicts_what_it_was_not_shown(gas):
    table = table_of(gas)
    force, heat = misfits(wall_fit(gas), table)
    assert force.max() < 5e-3
    assert heat.max() < 1e-3
    linear = table["temperature_ratio"] == 1.0
    for hidden in np.unique(table["knudsen"][linear])[1:-1]:
        force, heat = hiding(table, linear & (table["knudsen"] == hidden))
        assert force.max() < 3e-3
        assert heat.max() < 1e-3
    # one by one, in the middle of the others and at their ends
    force, heat = np.transpose(
        [hiding(table, np.arange(linear.size) == row) for row in np.flatnonzero(~linear)]
    )[0]
    assert np.sqrt(np.mean(force**2)) < 7e-3
    assert force.max() < 0.025
    assert heat.max() < 7e-3


def hiding(table, rows):
    """Misfits at rows that are not fitted."""
    shown, kept = ({k: v[mask] for k, v in table.items()} for mask in (~rows, rows))
    return misfits(surfaces.fit_walls(shown), kept)


def test_a_better_mesh_gives_the_same_ratio_of_walls(study):
    """The table is made on a coarse mesh: the errors of both walls are the same."""
    found, looked = study.read_kept(), 0
    for point, maxwell in found.items():
        if (point.mesh, point.wall) != ("medium", "maxwell") or point.knudsen in study.DENSE:
            continue
        accommodated = found[study.replace(point, wall="accommodated")]
        fit = wall_fit(point.gas)
        place = point.knudsen, point.ratio, point.tac
        with lf.float64():
            force, heat = float(fit.force_factor(*place)), float(fit.heat_factor(*place))
        assert force == pytest.approx(
            accommodated["force_ratio"] / maxwell["force_ratio"], abs=5e-3
        )
        assert heat == pytest.approx(accommodated["heat_ratio"] / maxwell["heat_ratio"], abs=1e-3)
        looked += 1
    assert looked >= 6


def test_the_table_is_made_of_all_points(study, tmp_path, monkeypatch):
    shipped = study.TABLE.read_text("utf-8")
    monkeypatch.setattr(study, "TABLE", tmp_path / "kinetic_walls.csv")
    found = study.read_kept()
    planned = [*study.hot_points(), *(point for group in study.linear_points() for point in group)]
    assert set(planned) == set(found)
    study.write_table(found)
    assert study.TABLE.read_text("utf-8") == shipped


def test_what_is_assumed_and_where_it_ends_is_said(disk):
    state = state_at(0.2)

    def said(**more):
        return lf.Kinetic(**more).diagnostics(disk, state, COLD)

    assert said() == said(wall=CL, tangential_accommodation=0.8) == ()
    (text,) = said(wall=CL, tangential_accommodation=0.4)
    assert "accommodation of normal energy below is 1.16 at" in text
    told = {
        wall: lf.Kinetic(wall=wall).assumptions(disk)[0]
        for wall in ("unknown", "maxwell", "accommodated", CL)
    }
    assert len(set(told.values())) == 4
    # all of a prediction that it looks at is its setup
    told_of = Prediction.assumptions.fget(SimpleNamespace(setup=Setup(disk, lf.Earth(), MODEL)))
    assert told["unknown"] in told_of


def scattering_table(gas):
    table = shipped_table("kinetic_scattering.csv")
    kept = np.array(table.texts["gas"]) == gas
    return {name: column[kept] for name, column in table.numbers.items()}


@pytest.mark.parametrize("gas", ["monatomic", "diatomic"])
def test_weights_of_accommodation_follow_the_table(gas):
    """Relative to the force of normal motion, also at a Knudsen number that is not fitted."""
    table = scattering_table(gas)
    with lf.float64():
        accommodated = surfaces.force_at_walls_of_one_temperature(
            table, gas, kinetic_fit(gas), wall_fit(gas)
        )
        fits = [kinetic_walls.scattering_fit(gas)]
        hidden = table["knudsen"] == 0.1
        shown = {name: column[~hidden] for name, column in table.items()}
        fits.append(surfaces.fit_scattering(shown, accommodated[~hidden]))
        for fit, rows in zip(fits, (~hidden, hidden), strict=True):
            means = kinetic_walls.Accommodations(*(table[name][rows] for name in KINDS))
            weights = fit.weights(table["knudsen"][rows], means)
            for kind, weight in zip(KINDS, weights, strict=True):
                misfit = np.asarray(weight) - (table[f"force_{kind}"] / accommodated)[rows]
                assert np.sqrt(np.mean(misfit**2)) < 0.015
                assert abs(misfit).max() < 0.06


def test_only_normal_motion_pushes_without_collisions():
    faces = (
        kinetic_walls.Accommodations(0.4, 0.9, 0.6),
        kinetic_walls.Accommodations(0.7, 0.7, 0.8),
    )
    thin, dense = (
        np.ravel(kinetic_walls.scattering_fit().effective(knudsen, faces)) for knudsen in (1e6, 0.1)
    )
    assert thin == pytest.approx([0.4, 0.7], abs=1e-5)
    # where tangential motion heats the gas more above, and rotation below
    assert 0.2 < dense[1] - dense[0] < 0.28


def simulated(study):
    """Simulations of walls of Cercignani and Lampis, in an open reservoir."""
    runs = study.combined(study.read_runs())
    return {point: found for point, found in runs.items() if point.wall == CL}


def test_hot_faces_that_share_unevenly_are_within_the_walls_error():
    """Solved, non-linear (coarse mesh): α_n 0.3 and 0.4, tangential energy 0.9, rotation 0.5."""
    film = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=1.7 / 3.0, tac_bottom=0.6)
    disk, state = lf.Disk(film, radius=0.01), state_at(0.1, lf.gas.NITROGEN)
    stated = {"tangential_accommodation": 1.0 - np.sqrt(0.1), "rotational_accommodation": 0.5}
    accommodated = lf.Kinetic(wall="accommodated").force(disk, state, (EXCESS,))
    model = lf.Kinetic(wall=CL, **stated)
    solved = 2.398 * accommodated
    (low,) = (e for e in ends_of(model, lf.Kinetic.force, disk, state, **stated) if e < solved)
    force = float(model.force(disk, state, (EXCESS,)))
    assert low < solved < force < 1.1 * solved


def force_and_heat(disk, state, excess, **errors):
    model = lf.Kinetic(wall=CL, tangential_accommodation=0.5, **errors).model_of(disk)
    with lf.float64():
        force, (heat,) = model.force(disk, state, excess), model.heat_loss(disk, state, excess)
    return np.array([float(force), float(heat)])


@pytest.mark.parametrize("gas", ["nitrogen", "argon", "helium"])
def test_direct_simulations_lie_within_the_stated_error(direct_simulation, monkeypatch, gas):
    """At temperatures of flight, where the three kinds of accommodation differ: 95 % bounds."""
    study, walls = direct_simulation
    chosen = {p: found for p, found in simulated(study).items() if p.gas == gas}
    assert len(chosen) > 1
    for point, found in chosen.items():
        rotates = gas == "nitrogen"
        normal = np.array([point.tac_top, point.tac_bottom])
        along = np.array(point.tangential or normal)
        tacs = (2.0 * normal + along) / 3.0 if rotates else 0.5 * (normal + along)
        faces = [
            kinetic_walls.Accommodations(*kinds)
            for kinds in zip(normal, along, normal, strict=True)
        ]
        fit = kinetic_walls.scattering_fit("diatomic" if rotates else "monatomic")
        effective = fit.effective(point.knudsen, tuple(faces))
        monkeypatch.setattr(kinetic_walls, "effective_tacs", lambda *_, e=effective: e)
        film = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=tacs[0], tac_bottom=tacs[1])
        disk = lf.Disk(film, radius=0.01)
        state = state_at(point.knudsen, getattr(lf.gas, gas.upper()))
        state = dataclasses.replace(state, wall_distance=point.boundary * disk.radius)
        excess = (point.temperature_ratio - 1.0,)
        hot = (point.temperature_ratio,) * 2
        free, drawn = walls.free_molecular(
            walls.build_faces(CL, tuple(normal), hot, 2 * rotates, tuple(along))
        )
        unit = float(state.pressure) * float(disk.area)
        speed = np.sqrt(2.0 * state.gas.specific_gas_constant * COLD)
        limits = np.array([free * unit, sum(drawn) * unit * speed])
        nominal = force_and_heat(disk, state, excess) / limits
        stated = [force_and_heat(disk, state, excess, **e) / limits - nominal for e in ONE_ERROR]
        simulations = np.array([found["force"], found["heat"]])
        # the simulation's known bias, from coarser cells and time steps
        deviation = nominal - simulations[:, 0] - [0.002, -0.0005]
        bound = 2.0 * np.sqrt(np.sum(np.square(stated), axis=0) + simulations[:, 1] ** 2)
        assert (abs(deviation) < bound).all(), (point, deviation / simulations[:, 0])
        assert (bound < [0.1, 0.02]).all()
        if point.tangential != (1.0, 0.4):
            assert (abs(deviation) < [0.03, 0.01] * simulations[:, 0]).all(), point


FORCE = '[force]\nmodel = "kinetic"\n'


def test_maxwell_walls_have_no_error_in_a_flyer_file(flyer_file):
    text = flyer_file().read_text("utf-8").partition("[force]")[0] + FORCE
    names = {"unknown": True, "maxwell": False, "accommodated": True, CL: True}
    for wall, uncertain in names.items():
        read = lf.read_flyer_file(flyer_file(text=f'{text}wall = "{wall}"\n'))
        assert ("force.wall_error" in read.uncertainties()) == uncertain
        assert ("force.sharing_error" in read.uncertainties()) == (wall == "unknown")
        assert read.build().model.wall == wall
    slip = f'{text}wall = "{CL}"\ntangential_accommodation = "0.9 ± 0.05"\n'
    read = lf.read_flyer_file(flyer_file(text=slip))
    assert read.uncertainties()["force.tangential_accommodation"] == pytest.approx(0.05)
    with pytest.raises(lf.ConfigurationError, match="wall"):
        lf.read_flyer_file(flyer_file(text=text + 'wall = "rough"\n'))
    with pytest.raises(lf.ConfigurationError, match="it is for unknown"):
        lf.read_flyer_file(flyer_file(text=f'{text}wall = "{CL}"\nsharing_error = "0 ± 1"\n'))


def test_bad_walls_are_named():
    with pytest.raises(lf.ParameterError, match='wall = "rough" is unknown; choose from unknown'):
        lf.Kinetic(wall="rough")
    with pytest.raises(lf.ParameterError, match="it is for cercignani-lampis"):
        lf.Kinetic(wall="maxwell", tangential_accommodation=0.9)
    with pytest.raises(lf.ParameterError, match="tangential_accommodation"):
        lf.Kinetic(wall=CL, tangential_accommodation=1.2)


@pytest.mark.parametrize(
    ("gas", "most", "least"), [("diatomic", 3.0, 0.6), ("monatomic", 2.0, 2 / 3)]
)
def test_shared_differences_push_by_hand_in_thin_gas(gas, most, least):
    """One kind of energy alone differs, or bounced molecules give half of their normal one."""
    kinds = {"diatomic": 3, "monatomic": 2}[gas]
    of_all = (kinds - 0.5) / kinds  # what a trapped molecule adds to the mean of all kinds
    assert least == pytest.approx(0.5 / of_all)
    for error, expected in ((0.0, 1.0), (1.96, most), (-1.96, least), (10.0, most), (-10.0, least)):
        found = float(sharing_factor(gas, 1e5, 0.85, 0.0, error))
        assert found == pytest.approx(expected, rel=2e-4)


@pytest.mark.parametrize("gas", ["monatomic", "diatomic"])
def test_where_the_normal_motion_alone_differs_the_solver_says_what_it_pushes(gas):
    """At the table's walls where all kinds accommodate alike, to 0.98."""
    table = scattering_table(gas)
    kinds = KINDS[: {"monatomic": 2, "diatomic": 3}[gas]]
    alike = np.all([table[kind] == table["normal"] for kind in kinds], axis=0)
    dense = alike & (table["knudsen"] >= 0.02)
    assert dense.sum() >= 10
    pushes = np.array([table[f"force_{kind}"][dense] for kind in kinds])
    with lf.float64():
        found = sharing_factor(gas, table["knudsen"][dense], 0.98, 0.0, 1.96)
        half = sharing_factor(gas, table["knudsen"][dense], 0.98, 0.0, 0.98)
    alone = len(kinds) * pushes[0] / pushes.sum(axis=0)
    np.testing.assert_allclose(found, alone, rtol=0.025)
    np.testing.assert_allclose(half, 0.5 * (1.0 + alone), rtol=0.025)  # a line


@pytest.mark.parametrize("knudsen", [0.05, 0.1, 0.5, 20.0])
def test_the_upper_end_is_that_of_walls_whose_normal_motion_alone_differs(disk, knudsen):
    state, small = state_at(knudsen), (1e-3,)
    alike = {"tangential_accommodation": 1.0, "rotational_accommodation": 1.0}
    forces = [
        np.ravel(lf.Kinetic(wall=CL, **one).force(disk, state, small))[0] for one in (alike, {})
    ]
    ends = [
        np.ravel(lf.Kinetic(sharing_error=error).force(disk, state, small))[0]
        for error in (1.96, 0.0)
    ]
    assert ends[0] / ends[1] == pytest.approx(forces[0] / forces[1], rel=0.01)


@pytest.mark.parametrize("altitude", [60e3, 70e3, 80e3, 100e3])
@pytest.mark.parametrize("tacs", [(0.8, 0.9), (0.9, 0.8), (0.93, 0.97)])
def test_the_band_of_unknown_walls_contains_those_of_cercignani_and_lampis(altitude, tacs):
    disk = lf.Disk(lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, *tacs), radius=0.01)
    state = lf.Earth().state(altitude)

    nominal = lf.lift(disk, state, MODEL)
    low, high = (
        float(lf.lift(disk, state, lf.Kinetic(sharing_error=end)) / nominal)
        for end in (-1.96, 1.96)
    )
    looked = 0
    for tangential, rotational in ((None, None), (0.9, None), (0.9, 0.85), (0.95, 0.8), (1.0, 1.0)):
        known = lf.Kinetic(
            wall=CL, tangential_accommodation=tangential, rotational_accommodation=rotational
        )
        if any("no wall has" in text for text in known.diagnostics(disk, state, COLD)):
            continue
        looked += 1
        assert low < float(lf.lift(disk, state, known) / nominal) < 1.04 * high  # and wall_error
    assert looked >= 3


def test_an_even_sharing_is_the_nominal_one_and_known_walls_have_none(film):
    disk, state = lf.Disk(film, radius=0.01), lf.Earth().state(75e3)
    assert lf.lift(disk, state, lf.Kinetic(sharing_error=0.0)) == lf.lift(disk, state, MODEL)
    with pytest.raises(lf.ParameterError, match="it is for unknown ones"):
        lf.Kinetic(wall="maxwell", sharing_error=1.0)
    # as a file has it, whose numbers are unknown while a program is traced
    exact = lf.Kinetic(wall="maxwell", sharing_error=0.0)
    assert lf.lift(disk, state, exact) == lf.lift(disk, state, lf.Kinetic(wall="maxwell"))
