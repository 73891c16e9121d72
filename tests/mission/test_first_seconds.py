"""Releases with a velocity beside closed forms and Newton's law by SciPy."""

import dataclasses

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import lightflyer as lf
from lightflyer.array.namespace import by_numpy
from lightflyer.environment import EARTH_PLANET, Place
from lightflyer.mission.path.dynamics import Moving
from lightflyer.mission.path.integration import Limits
from lightflyer.mission.path.motion import Vehicle
from lightflyer.mission.path.release import Start

PLACE = {"latitude": 45.0, "longitude": 10.0, "time": "2026-06-21T12:00Z"}
DARK = lf.environment.Radiation(0.0)
TURN = EARTH_PLANET.rotation_rate


@pytest.fixture
def still_air(isothermal_air):
    """Air of 220 K whose pressure falls by e in 6.5 km, in the dark."""
    return dataclasses.replace(isothermal_air, radiation=DARK, sky=None)


def fly(flyer, air, altitude, duration, velocity=None, **more):
    release = lf.Release(altitude, **PLACE, velocity=velocity)
    return lf.fly(flyer, air, lf.FreeMolecular(), release=release, duration=duration, **more)


def test_where_there_is_no_air_it_flies_a_parabola_that_the_turning_earth_bends(disk):
    speed, seconds, altitude = 300.0, 60.0, 700e3
    flown = fly(disk, lf.Earth(radiation=DARK), altitude, seconds, (0.0, 0.0, speed))

    def fall(_, state):
        return [state[1], -9.80665 * (6_356_766.0 / (6_356_766.0 + state[0])) ** 2]

    exact = solve_ivp(fall, (0.0, seconds), [altitude, speed], rtol=1e-10).y[:, -1]
    assert float(flown.end_altitude) == pytest.approx(exact[0], abs=0.5)
    gravity = (speed - exact[1]) / seconds
    west = TURN * np.cos(np.pi / 4.0) * (speed * seconds**2 - gravity * seconds**3 / 3.0)
    metres = np.radians(10.0 - float(flown.end_longitude)) * np.cos(np.pi / 4.0)
    radius = float(EARTH_PLANET.curvature_radius(np.pi / 4.0, 0.5 * np.pi)) + altitude
    assert metres * radius == pytest.approx(west, rel=0.02)
    np.testing.assert_allclose(flown.vertical_speed[0], speed)
    assert float(flown.release_speed) == speed


@pytest.mark.parametrize("direction", [(1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.6, 0.8, 0.0)])
def test_linear_drag_stops_it_after_mass_times_speed_over_drag(
    direction, closed_form_disk, still_air
):
    """Edgewise: free molecules and slow flow of dense gas in series."""
    speed, altitude = 90.0, 60e3
    flyer = closed_form_disk(1e-2)
    flown = fly(flyer, still_air, altitude, "2 min", speed * np.array(direction), every="1 min")
    pressure, gas = 5.0 * np.exp(10e3 / 6500.0), lf.gas.US1976_AIR
    thermal = np.sqrt(2.0 * float(gas.specific_gas_constant) * 220.0)
    faces = 4.0 / np.sqrt(np.pi) + np.sqrt(np.pi)
    free = np.pi * 5e-3**2 * pressure / thermal * faces
    slow = 32.0 / 3.0 * float(gas.viscosity(220.0)) * 5e-3
    way = 1e-3 * np.pi * 5e-3**2 * speed * (free + slow) / (free * slow)
    assert way > 5.0
    radius = float(EARTH_PLANET.curvature_radius(np.pi / 4.0, np.arctan2(*direction[:2])))
    over_ground = way * EARTH_PLANET.radius / (radius + altitude)
    assert float(flown.release_distance) == pytest.approx(over_ground, rel=1e-3)
    assert float(flown.release_acceleration) == pytest.approx(
        np.hypot(speed**2 / way, 9.6), rel=5e-3
    )
    gone = np.array([flown.end_longitude - 10.0, flown.end_latitude - 45.0])
    gone *= [np.cos(np.pi / 4.0), 1.0]
    np.testing.assert_allclose(gone / np.linalg.norm(gone), direction[:2], atol=5e-3)


def test_a_film_warms_up_as_fast_as_its_heat_capacity_lets_it(still_air):
    """In next to no air: light less radiation, over areal density and specific heat."""
    film = lf.FilmProperties(0.1, 0.75, 0.08, 0.12, tac_top=0.8, tac_bottom=0.9)
    lit = dataclasses.replace(still_air, radiation=lf.environment.Radiation(1000.0))
    vehicle = Vehicle(lf.Setup(lf.Disk(film, 0.01), lit, lf.FreeMolecular()), lf.mission.Level())
    place = Place(*(np.full((1, 1), part) for part in Place.at(PLACE["time"], 45.0, 10.0)))
    law = Moving(vehicle, place.time, Limits(0.0, 200e3), lf.mission.Inertia(800.0))
    with by_numpy():
        state = law.at_release(Start(np.full((1, 1), 170e3), place))
        for kelvin in (220.0, 400.0):
            state[..., 7] = kelvin / 100.0
            warming = 100.0 * law.rate(0.0, state)[0][..., 7].item()
            radiated = 0.2 * 5.670374419e-8 * (kelvin**4 - 220.0**4)
            assert warming == pytest.approx((750.0 - radiated) / (0.1 * 800.0), rel=1e-4)


@pytest.mark.parametrize("velocity", [(0.0, 0.0, 0.0), (50.0, 20.0, -10.0)])
def test_a_tilted_film_begins_to_move_by_its_weight_and_its_drag(velocity, film, still_air):
    """At rest it falls straight down; drag along its normal and across goes with its azimuth."""
    tilt, azimuth, altitude = 0.5, 2.0, 60e3
    flyer = lf.Disk(film, 0.01, attitude=lf.environment.Attitude(tilt, azimuth))
    vehicle = Vehicle(lf.Setup(flyer, still_air, lf.FreeMolecular()), lf.mission.Own())
    place = Place(*(np.full((1, 1), part) for part in Place.at(PLACE["time"], 45.0, 10.0)))
    law = Moving(vehicle, place.time, Limits(0.0, 200e3), lf.mission.Inertia(800.0))
    start = Start(np.full((1, 1), altitude), place, np.array([[velocity]]))
    with by_numpy():
        found = 100.0 * law.rate(0.0, law.at_release(start))[0][0, 0, 4:7]
    longitude, root = np.radians(10.0), np.sqrt(0.5)
    up = np.array([root * np.cos(longitude), root * np.sin(longitude), root])
    east = np.array([-np.sin(longitude), np.cos(longitude), 0.0])
    north = np.cross(up, east)
    aside = np.sin(azimuth) * east + np.cos(azimuth) * north
    normal = np.sin(tilt) * aside + np.cos(tilt) * up
    moving = np.array(velocity) @ [east, north, up]
    axial, state = moving @ normal, still_air.state(altitude)
    across = moving - axial * normal
    speed = np.linalg.norm(across)
    drag = flyer.drag(state, (0.0,), axial, "broadside") * normal
    if speed:
        drag = drag + flyer.drag(state, (0.0,), speed, "edgewise") * across / speed
    expected = -9.6 * up - drag / flyer.mass - np.cross([0.0, 0.0, 2.0 * TURN], moving)
    np.testing.assert_allclose(found, expected, atol=1e-8)


@pytest.mark.parametrize("up", [None, 400.0])
def test_a_fall_from_thin_air_is_that_of_newtons_law(up, closed_form_disk, still_air):
    altitude, flyer, air = 135e3, closed_form_disk(1e-2, inertia=0.0), still_air
    velocity = None if up is None else (0.0, 0.0, up)
    times = np.arange(0.0, 1801.0, 60.0)
    ensemble = lf.mission.Ensemble(5, drag=0.2, waves=0.0)
    flown = fly(flyer, air, altitude, "30 min", velocity, every="1 min", ensemble=ensemble)
    gas, mass = lf.gas.US1976_AIR, 1e-3 * np.pi * 5e-3**2
    thermal = np.sqrt(2.0 * float(gas.specific_gas_constant) * 220.0)
    slow = 16.0 * float(gas.viscosity(220.0)) * 5e-3

    def rate(_, state):
        pressure = 5.0 * np.exp((70e3 - state[0]) / 6500.0)
        free = np.pi * 5e-3**2 * pressure / thermal * (4.0 / np.sqrt(np.pi) + np.sqrt(np.pi))
        return [state[1], -9.6 - state[1] * free * slow / (free + slow) / mass]

    begin = [altitude, up or 0.0]
    exact = solve_ivp(rate, (0.0, 1800.0), begin, "Radau", times, rtol=1e-9, atol=1e-6).y
    assert exact[1].min() < -200.0  # far from balance
    np.testing.assert_allclose(flown.altitude, exact[0], atol=10.0)
    late = float(flown.release_balance)
    assert 100.0 < late < 1800.0
    early = times <= late
    np.testing.assert_allclose(flown.vertical_speed[early], exact[1][early], atol=0.3)
    after = flown.ensemble_altitude.values
    assert np.all(np.isfinite(after))
    assert np.ptp(after[:, -1]) > 1e3


def test_a_velocity_that_is_uncertain_scatters_the_ensemble(closed_form_disk, still_air):
    """After one time constant of free flight members are where their velocities carried them."""
    spread, seconds = 20.0, 15.0
    ensemble = lf.mission.Ensemble(200, velocity=spread, drag=0.0, waves=0.0, seed=3)
    up = (0.0, 0.0, 500.0)
    flown = fly(closed_form_disk(1e-2), still_air, "190 km", seconds, up, ensemble=ensemble)
    metres = np.radians(flown.ensemble_end_latitude.values - 45.0) * 6.55e6
    assert metres.std() == pytest.approx(spread * seconds, rel=0.17)  # 3.5 standard errors
    assert flown.ensemble_end_altitude.values.std() == pytest.approx(spread * seconds, rel=0.17)


def test_a_release_from_an_aircraft_is_soon_one_at_rest(disk):
    dark = lf.Earth(radiation=DARK)
    ends = [fly(disk, dark, "12 km", "1 h", velocity) for velocity in (None, (60.0, 0.0, 2.0))]
    assert float(ends[1].end_altitude) == pytest.approx(float(ends[0].end_altitude), abs=0.3)
    assert float(ends[1].release_balance) <= 10.0
    density = 0.3119  # kg/m³, of the standard atmosphere at 12 km
    pressure = float(ends[1].release_pressure)
    assert pressure == pytest.approx(0.5 * density * (60.0**2 + 2.0**2), rel=1e-3)
