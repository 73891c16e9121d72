"""A floor that is warmer than the rest of a chamber: the gas above it, and its push."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.special import j1, jn_zeros

import lightflyer as lf
from lightflyer.array.namespace import float64
from lightflyer.core.constants import STEFAN_BOLTZMANN
from lightflyer.core.errors import ParameterError
from lightflyer.environment.chamber import conducted_share, share_of_floor, view_of_floor
from lightflyer.files.table import shipped_table

COLD = 293.0
RADIUS = 0.01
SIMULATED = 0.0315, 0.0012
"""Force over p A and its standard error: studies/direct_simulation, the point with a solid side."""
AROUND = {"floor": 0.03, "lid": 0.06, "radius": 0.06}


def number_of(function, *arguments):
    with float64():
        return np.asarray(function(*arguments))


def disk(top=0.8, bottom=0.9):
    return lf.Disk(
        lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=top, tac_bottom=bottom), RADIUS
    )


def pressure_of(knudsen, cold=COLD, gas=lf.gas.AIR):
    return float(lf.gas.mean_free_path(1.0, cold, gas)) / (2.0 * RADIUS * knudsen)


@pytest.mark.parametrize(
    ("floor", "lid", "wall"), [(1, 1, 1), (0.5, 3, 2), (3, 0.7, 2), (2, 9, 5), (3, np.inf, 1.5)]
)
def test_conduction_on_the_axis_is_the_other_series(floor, lid, wall):
    """Bessel functions across in place of sines along."""
    zeros = jn_zeros(0, 200)
    rate = zeros / wall
    below = np.exp(-rate * floor) * -np.expm1(-2 * rate * min(lid, 1e3))
    parts = below / -np.expm1(-2 * rate * (floor + min(lid, 1e3)))
    expected = np.sum(2.0 / (zeros * j1(zeros)) * parts)
    assert number_of(conducted_share, floor, lid, wall) == pytest.approx(expected, rel=2e-4)


def test_between_plates_the_temperature_is_a_line():
    assert number_of(conducted_share, 1.0, 3.0, np.inf) == pytest.approx(0.75, rel=1e-12)
    assert number_of(conducted_share, 1.0, 3.0, 300.0) == pytest.approx(0.75, rel=1e-12)


def test_thin_gas_has_half_of_the_view_and_dense_gas_conducts():
    place = (2.0, 4.0, 5.0)
    view = number_of(view_of_floor, 2.0, 5.0)
    assert view == pytest.approx(25.0 / 29.0)
    assert number_of(share_of_floor, *place, 1e6) == pytest.approx(0.5 * view, rel=1e-3)
    dense = number_of(conducted_share, *place)
    assert number_of(share_of_floor, *place, 1e-6) == pytest.approx(dense, rel=1e-3)


def test_share_and_push_follow_the_solved_equation():
    """All chambers of the table but a tube, whose mesh is too coarse for a warm floor."""
    table = dict(shipped_table("kinetic_chamber.csv").numbers)
    good = ~((table["wall"] == 1.5) & (table["lid"] == 12.0))
    table = {name: column[good] for name, column in table.items()}
    floor, lid, wall = (table[name] for name in ("floor", "lid", "wall"))
    share = number_of(share_of_floor, floor, lid, wall, table["knudsen"])  # radius is one
    assert np.sqrt(np.mean((share - table["floor_share"]) ** 2)) < 0.02
    # what pushes the cold disk is the floor, and the gas that is warmer than it
    chosen = {name: column[::5] for name, column in table.items()}
    pushed = []
    for row in zip(*(chosen[name] for name in ("knudsen", "floor", "lid", "wall")), strict=True):
        knudsen, *distances = row
        names = ("floor", "lid", "radius")
        around = {name: part * RADIUS for name, part in zip(names, distances, strict=True)}
        warm, pressure = (
            lf.Chamber(temperature=COLD, floor_temperature=1.001 * COLD, **around),
            (pressure_of(knudsen)),
        )
        state, plain = warm.state(pressure), disk(0.85, 0.85)
        force = lf.Kinetic().force(plain, state, (COLD / state.temperature - 1.0,))
        pushed.append(float(force) / (pressure * plain.area * 1e-3))
    off = np.array(pushed) - chosen["floor_push"]
    assert np.sqrt(np.mean(off**2)) < 0.008
    assert np.max(np.abs(off)) < 0.025
    assert np.max(chosen["floor_push"]) > 0.15


def test_by_direct_simulation():
    """Nitrogen, Kn 0.295, disk at 1.2 T_c, floor at 1.5 T_c; lid a reservoir. 2 standard errors."""
    cold, gas = 205.0, lf.gas.NITROGEN
    around = {"floor": 2.25 * RADIUS, "lid": 4.0 * RADIUS, "radius": 4.0 * RADIUS}
    chamber = lf.Chamber(temperature=cold, gas=gas, floor_temperature=1.5 * cold, **around)
    pressure = pressure_of(0.294524, cold, gas)
    state, plain = chamber.state(pressure), disk(0.99, 1.0)
    excess = 1.2 * cold / state.temperature - 1.0
    force = lf.Kinetic(wall="maxwell").force(plain, state, (excess,))
    error = lf.Kinetic(1.0, wall="maxwell").force(plain, state, (excess,)) - force
    simulated, noise = SIMULATED
    off = float(force) / (pressure * plain.area) - simulated
    assert abs(off) < 2.0 * np.hypot(noise, float(error) / (pressure * plain.area))


def test_in_dense_gas_neither_push_nor_its_error_lifts():
    """What is wrong by a share of p A must not be multiplied by any pressure."""
    state = lf.Chamber(floor_temperature=350.0, **AROUND).state(np.array([1e3, 1e4, 1e5]))
    unheated = np.zeros(3)
    errors = [lf.Kinetic(each).force(disk(), state, (unheated,)) for each in (0.0, 2.0)]
    weight = float(disk().mass) * 9.80665
    assert np.all(np.abs(errors) < 0.1 * weight)
    assert np.all(np.diff(errors, axis=1) < 0.0)


def test_a_floor_as_warm_as_the_rest_changes_nothing():
    chambers = lf.Chamber(**AROUND), lf.Chamber(floor_temperature=COLD, **AROUND)
    for model in (lf.Kinetic(), lf.Lu2023()):
        light = [lf.levitate(disk(), each.state(3.0), model).irradiance for each in chambers]
        assert light[1] == pytest.approx(light[0], rel=1e-10)


def test_the_warmer_the_floor_the_less_light_until_none():
    floors = (280.0, COLD, 310.0, 500.0)
    found = [
        lf.levitate(disk(), lf.Chamber(floor_temperature=each, **AROUND).state(3.0), lf.Kinetic())
        for each in floors
    ]
    light = [float(each.irradiance) for each in found]
    assert light == sorted(light, reverse=True)
    assert light[-2] > 0.0 == light[-1]
    assert found[-1].levitates
    assert COLD < found[-1].temperature < 500.0


def test_the_floor_radiates_unless_the_light_says_otherwise():
    chamber = lf.Chamber(floor_temperature=400.0, **AROUND)
    state = chamber.state(1e-3)
    radiation = state.radiation
    assert radiation.infrared_below == pytest.approx(STEFAN_BOLTZMANN * 400.0**4)
    assert radiation.infrared_above == pytest.approx(STEFAN_BOLTZMANN * COLD**4)
    assert radiation.ground_view == pytest.approx(0.8)
    given = replace(chamber, radiation=lf.environment.Radiation(infrared_below=100.0))
    assert given.state(1.0).radiation.infrared_below == 100.0
    (said,) = [text for text in chamber.assumptions() if text.startswith("floor at 400 K")]
    assert "293 K" in said
    assert any("W/m²" in text for text in chamber.assumptions() if text.startswith("infrared"))


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({}, "give floor"),
        ({"floor": 0.03}, "give lid or radius"),
        ({"floor": 0.03, "lid": 0.1, "floor_temperature": -3.0}, "not positive"),
    ],
)
def test_what_is_missing_is_said(given, message):
    with pytest.raises(ParameterError, match=message):
        lf.Chamber(**{"floor_temperature": 300.0, **given})


def test_a_model_that_knows_no_floor_takes_the_gas_and_says_so():
    found = lf.predict(disk(), lf.Chamber(floor_temperature=320.0, **AROUND), lf.Lu2023(), at=[5.0])
    assert found.at["gas_temperature"][0] > COLD
    assert any("no effect but on the gas temperature" in text for text in found.warnings)
