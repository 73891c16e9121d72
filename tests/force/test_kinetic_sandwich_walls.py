"""Walls of a sandwich: free molecules, rows the fit has not seen, the disk, and the bands."""

import dataclasses

import numpy as np
import pytest
from kinetic_fits import sandwich

import lightflyer as lf
from lightflyer.files.table import shipped_table
from lightflyer.force.kinetic import sandwich_table as walls
from lightflyer.force.kinetic.sandwich_table import sandwich_fit
from lightflyer.force.kinetic.walls import Accommodations
from lightflyer.force.membranes.sandwich import rarefaction

COLD, RADIUS = 220.0, 0.01
CL = "cercignani-lampis"
GASES = {"diatomic": lf.gas.US1976_AIR, "monatomic": lf.gas.HELIUM}


def make(tac, open_fraction=0.4):
    film = lf.FilmProperties(3e-4, 0.1, 0.1, 0.1, *(tac if isinstance(tac, tuple) else (tac, tac)))
    return lf.Sandwich(film, film, RADIUS, 1e-6, open_fraction, 1e-6, 0.0, 1.0)


def state_at(delta, gas="diatomic"):
    with lf.float64():
        pressure = delta / float(rarefaction(RADIUS, 1.0, COLD, GASES[gas]))
    light = lf.environment.Radiation(0.0)
    return lf.environment.EnvironmentState(pressure, COLD, 9.7, GASES[gas], light)


def push(model, flyer, state, excess=(0.2, 0.7)):
    """Force over half of p A."""
    with lf.float64():
        found = float(model.force(flyer, state, excess))
    return found / (0.5 * state.pressure * np.pi * RADIUS**2)


def roots(normal, excess=(0.2, 0.7)):
    """What free molecules of an accommodated normal motion push, of both faces."""
    return np.diff(np.sqrt(1.0 + normal * np.array(excess)))[0]


@pytest.mark.parametrize(
    ("gas", "options", "normal"),
    [
        ("diatomic", {}, 0.8),
        ("diatomic", {"tangential_accommodation": 0.9}, 2 * 0.8 + 0.8 - 0.99 - 0.8),
        ("diatomic", {"tangential_accommodation": 0.9, "rotational_accommodation": 0.9}, 0.51),
        ("monatomic", {"tangential_accommodation": 0.9}, 0.61),
    ],
)
def test_free_molecules_push_by_their_normal_motion_alone(gas, options, normal):
    """The rest of a TAC of 0.8 is what tangential motion, 1 − 0.1², and rotation have not."""
    found = push(lf.Kinetic(wall=CL, **options), make(0.8), state_at(1e-7, gas))
    assert found == pytest.approx(0.6 * roots(normal), rel=1e-5)


@pytest.mark.parametrize("kinds", [3, 2])
def test_unknown_walls_reach_the_ends_by_hand_in_thin_gas(kinds):
    """Normal motion lacks all that the TAC lacks, or half of the bounced molecules' energy does."""
    gas, tac = {3: "diatomic", 2: "monatomic"}[kinds], 0.8
    trapped = (tac - 0.5 / kinds) / (1.0 - 0.5 / kinds)
    ends = {1.96: kinds * tac - (kinds - 1), -1.96: trapped + 0.5 * (1.0 - trapped)}
    flyer, state = make(tac), state_at(1e-7, gas)
    for error, normal in ends.items():
        for beyond in (1.0, 5.0):
            found = push(lf.Kinetic(sharing_error=beyond * error), flyer, state)
            assert found == pytest.approx(0.6 * roots(normal), rel=1e-4)
    plain, maxwell = (push(lf.Kinetic(wall=wall), flyer, state) for wall in ("unknown", "maxwell"))
    assert plain == pytest.approx(maxwell, rel=1e-12)


@pytest.mark.parametrize("gas", ["monatomic", "diatomic"])
def test_fit_predicts_walls_it_has_not_seen(gas):
    """Each of the table's inner walls, to 2 % of the force below δ = 5, where others are kept."""
    table = shipped_table("kinetic_sandwich_scattering.csv")
    rows = np.array(table.texts["gas"]) == gas
    columns = {name: column[rows] for name, column in table.numbers.items()}
    unseen = (columns["normal"] == 0.4) & (columns["tangential"] == 0.9)
    with lf.float64():
        fit = sandwich.fit_walls(
            {name: c[~unseen] for name, c in columns.items()}, gas, sandwich_fit(gas)
        )
        here = {name: c[unseen] for name, c in columns.items()}
        faces = Accommodations(*(here[kind] for kind in ("normal", "tangential", "rotational")))
        kinds = 3 if gas == "diatomic" else 2
        tac = sum(faces[:kinds]) / kinds
        place = here["rarefaction"], here["open_fraction"]
        maxwell = walls.Ratios(sandwich_fit(gas), *place, tac, (1.0 - place[1]) * tac, 1.0).force
        found = np.asarray((faces.normal + fit.added(*place, faces)) * maxwell)
    off = np.abs(found / here["force"] - 1.0)
    assert off[here["rarefaction"] < 5.0].max() < 0.01
    assert off.max() < 0.025


@pytest.mark.parametrize(
    "options",
    [
        {"wall": "accommodated"},
        {"wall": CL, "tangential_accommodation": 0.95},
        {"sharing_error": 1.0},
    ],
)
def test_unlike_faces_push_as_those_of_a_disk(options):
    """Without holes, both membranes equally warm: to the 1 % of the two tables."""
    excess, state = 0.05, state_at(2.0)
    film = lf.FilmProperties(3e-4, 0.1, 0.1, 0.1, 0.8, 0.9)
    model = lf.Kinetic(**options)
    with lf.float64():
        disk = float(model.force(lf.Disk(film, RADIUS), state, (excess,)))
    found = push(model, make((0.8, 0.9), 0.0), state, (excess, excess))
    assert found * 0.5 * state.pressure * np.pi * RADIUS**2 == pytest.approx(disk, rel=0.015)


def test_a_reservoir_leaves_less_of_what_collisions_add():
    """Half-widths of 3 radii and rarefactions at which the solver's shares are 0.855 and 0.937."""
    assert float(walls.near_walls(0.2, 3.0)) == pytest.approx(0.855, abs=0.02)
    assert float(walls.near_walls(1.0, 3.0)) == pytest.approx(0.937, abs=0.02)


def test_more_of_the_band_is_below_than_above():
    """At a TAC of 0.8 in air the ends are 0.6 and 1.07 of the nominal force."""
    flyer, state = make(0.8, 0.0), state_at(1.0)
    low, middle, high = (
        push(lf.Kinetic(sharing_error=error), flyer, state, (0.0, 0.1))
        for error in (1.96, 0.0, -1.96)
    )
    assert 0.55 < low / middle < 0.7
    assert 1.04 < high / middle < 1.1


def test_walls_that_no_face_can_have_are_named():
    model = lf.Kinetic(wall=CL, tangential_accommodation=0.2)
    said = " ".join(model.diagnostics(make(0.9), state_at(1.0), 230.0))
    assert "the accommodation of normal energy on top is 1.44" in said  # 2 · 0.9 − 0.36
    assert "no wall has TAC" in said
    with pytest.raises(lf.ParameterError, match="it is for cercignani-lampis"):
        lf.Kinetic(tangential_accommodation=0.9)


def test_a_reservoir_nearer_than_its_table_is_taken_as_the_nearest():
    flyer, model = make(0.8), lf.Kinetic(wall=CL, tangential_accommodation=0.9)
    state = dataclasses.replace(state_at(0.2), wall_distance=2.0 * RADIUS)
    near = dataclasses.replace(state, wall_distance=0.3 * RADIUS)
    assert push(model, flyer, near) == pytest.approx(push(model, flyer, state), rel=1e-9)
