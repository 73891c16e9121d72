"""Flights that are steered, against plain NumPy, closed forms and still air."""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from scipy.integrate import solve_ivp
from scipy.interpolate import RectBivariateSpline

import lightflyer as lf
from lightflyer.config.designs import as_design
from lightflyer.environment import Place, Wind
from lightflyer.environment.wind.base import AbstractWind
from lightflyer.mission import Circle, Release
from lightflyer.mission.areas import angles_towards, unit_vector
from lightflyer.mission.fleet import flights_of
from lightflyer.mission.path.dynamics import follow
from lightflyer.mission.path.integration import Accuracy, Limits, Trajectory
from lightflyer.mission.path.motion import Vehicle
from lightflyer.mission.report.ground import add_station

EQUATOR, FLATTENING = 6_378_137.0, 1.0 / 298.257223563  # WGS 84
RADIUS = 6_371e3
DEGREE = np.pi / 180.0
RELEASE = {"latitude": 20.0, "longitude": 179.9, "time": "2026-06-21T12:00Z"}


@pytest.fixture
def fly(closed_form_disk, lit_air):
    """Fly a disk of 2 mm under a sun that stands still."""

    def flown(duration, wind=None, flyer=None, altitude="75 km", **options):
        return lf.fly(
            flyer or closed_form_disk(2e-3), lit_air(wind), lf.FreeMolecular(), duration=duration,
            release=Release(altitude, **RELEASE), **options,
        )  # fmt: skip

    return flown


class Shear(AbstractWind):
    """Wind that turns with altitude."""

    def velocity(self, altitude, place):
        east = (altitude - 72e3) * 1e-3
        return Wind(east, 0.3 * east - 1.0, 0.0 * altitude)

    def describe(self):
        return ("wind: turning with altitude",)


@pytest.fixture(scope="module")
def station():
    return Circle(20.2, -179.9, "60 km")


def test_choosing_the_wind_is_what_plain_numpy_makes_of_the_rule(
    closed_form_disk, lit_air, station, fly
):
    disk, air, hours = closed_form_disk(2e-3, inertia=0.0), lit_air(Shear()), 8.0
    rule = lf.mission.Shaded(lf.mission.ChooseWind(station, "66 km", "78 km", ahead="2 h"))
    times = np.linspace(0.0, 3600.0 * hours, 33)
    flown = fly(times[-1], Shear(), disk, every=900.0, attitude=rule)
    # over altitude and share of light, from statics at lights of their own
    altitudes, shares = np.linspace(50e3, 95e3, 181), np.linspace(0.0, 1.0, 41)
    dimmed = type(air)(lf.environment.sunlight(1361.0 * shares, 0.3)).state(altitudes[:, None])
    lit = lf.lift(disk, dimmed, lf.FreeMolecular())
    lift = RectBivariateSpline(altitudes, shares, lit, kx=3, ky=3)
    target = np.array([station.latitude, station.longitude], float) * DEGREE
    mass = float(disk.mass)

    def rate(time, flown):
        altitude, latitude, longitude = flown
        turn = target[1] - longitude
        ahead = np.sin(latitude) * np.sin(target[0]) + np.cos(latitude) * np.cos(
            target[0]
        ) * np.cos(turn)
        bearing = np.arctan2(
            np.sin(turn) * np.cos(target[0]),
            np.cos(latitude) * np.sin(target[0])
            - np.sin(latitude) * np.cos(target[0]) * np.cos(turn),
        )
        way = planet_radius * np.arccos(ahead) * np.array([np.sin(bearing), np.cos(bearing)])
        levels = np.linspace(66e3, 78e3, 21)
        east = (levels - 72e3) * 1e-3
        missed = np.hypot(way[0] - 7200.0 * east, way[1] - 7200.0 * (0.3 * east - 1.0))
        weights = np.exp(-(missed - missed.min()) / 2e3)
        wanted = (weights * levels).sum() / weights.sum()
        below = np.clip(0.5 + (wanted - altitude) / 1e3, 0.0, 1.0)
        share = below**2 * (3.0 - 2.0 * below)
        # the thin and the dense drag of the disk, one after the other
        pressure, temperature = 5.0 * np.exp((70e3 - altitude) / 6500.0), 220.0
        thermal = np.sqrt(2.0 * gas.specific_gas_constant * temperature)
        free = float(disk.area) * pressure / thermal * (4.0 / np.sqrt(np.pi) + np.sqrt(np.pi))
        slow = 16.0 * float(gas.viscosity(temperature)) * 1e-3
        up = (lift(altitude, share)[0, 0] - mass * 9.6) * (1.0 / free + 1.0 / slow)
        squared = 1.0 - (2.0 * FLATTENING - FLATTENING**2) * np.sin(latitude) ** 2
        normal = EQUATOR / np.sqrt(squared)
        meridian = normal * (1.0 - FLATTENING) ** 2 / squared
        here = (altitude - 72e3) * 1e-3
        return [
            up,
            (0.3 * here - 1.0) / (meridian + altitude),
            here / (normal + altitude) / np.cos(latitude),
        ]

    gas, planet_radius = lf.gas.US1976_AIR, float(air.planet.radius)
    begin = [75e3, 20.0 * DEGREE, 179.9 * DEGREE]
    expected = solve_ivp(rate, (0.0, times[-1]), begin, t_eval=times, rtol=1e-9, atol=1e-7)
    altitude, latitude, longitude = expected.y
    assert np.ptp(altitude) > 3e3
    np.testing.assert_allclose(flown.altitude, altitude, atol=2.0)
    np.testing.assert_allclose(flown.latitude, latitude / DEGREE, atol=2e-5)
    apart = (flown.longitude - longitude / DEGREE + 180.0) % 360.0 - 180.0
    np.testing.assert_allclose(apart, 0.0, atol=2e-5)
    assert 0.0 < float(flown.light_share.min()) < 0.9


def test_a_shaded_flyer_rests_where_it_lets_in_what_lifts_it(closed_form_disk, lit_air, fly):
    disk, air = closed_form_disk(2e-3), lit_air()
    rule = lf.mission.Shaded(lf.mission.HoldAltitude("72 km", width="400 m"))
    flown = fly("8 h", attitude=rule)
    end = float(flown.end_altitude)
    assert abs(end - 72e3) < 200.0
    assert abs(float(flown.vertical_speed[-1])) < 1e-3
    share = float(flown.light_share[-1])
    dimmed = type(air)(lf.environment.sunlight(1361.0 * share, 0.3))
    held = lf.lift(disk, dimmed.state(end), lf.FreeMolecular())
    assert held == pytest.approx(float(disk.mass) * 9.6, rel=1e-3)
    assert float(flown.irradiance[-1]) == 1361.0  # what there is, not what is let in


def test_shade_and_errors_of_the_drag_hold_with_inertia_too(fly):
    rule = lf.mission.Shaded(lf.mission.HoldAltitude("74 km", width="500 m"))
    flights = [fly("1 h", inertia=one, attitude=rule) for one in (None, lf.mission.Inertia())]
    assert float(flights[0].end_altitude) < 74.5e3
    assert "shading" not in flights[0].warnings
    assert float(flights[1].end_altitude) == pytest.approx(float(flights[0].end_altitude), abs=1.0)
    told = "temperatures, powers and speeds over time are those in balance at each place"
    assert told in flights[1].attrs["assumptions"]
    assert told not in flights[0].attrs["assumptions"]


@pytest.mark.parametrize(("altitude", "some"), [("95 km", "all"), ("40 km", "none")])
def test_shading_that_changes_nothing_is_said(fly, altitude, some):
    flown = fly("10 min", attitude=lf.mission.Shaded(lf.mission.HoldAltitude(altitude)))
    assert f"the flyer lets in {some} of the light throughout" in flown.warnings


def test_more_drag_makes_the_same_flight_slower(closed_form_disk, lit_air):
    disk, hours, more = closed_form_disk(2e-3, inertia=0.0), 4.0, 1.25
    vehicle = Vehicle(lf.Setup(disk, lit_air(), lf.FreeMolecular()), lf.mission.Level())
    start, limits = Release("60 km", **RELEASE).start(), Limits(0.0, 120e3)
    times = np.linspace(0.0, 3600.0 * hours, 9)
    accuracy = Accuracy.for_duration(times[-1])
    stated, _ = follow(vehicle, start, limits, times / more, accuracy)
    slower, _ = follow(replace(vehicle, drag=more), start, limits, times, accuracy)
    assert np.ptp(stated.altitude) > 1e3
    np.testing.assert_allclose(slower.altitude, stated.altitude, atol=0.5)


def test_members_have_a_drag_of_their_own(closed_form_disk, lit_air):
    design = as_design(closed_form_disk(2e-3), lit_air(), lf.FreeMolecular())
    start = Release("75 km", **RELEASE).start()
    members = lf.mission.Ensemble(4000, drag=0.05)
    drags = flights_of(design, lf.mission.Level(), start, members, [3600.0]).vehicle.drag[:, 0]
    assert drags[0] == drags[-1] == 1.0
    assert np.log(drags[1:-1]).std() == pytest.approx(0.05, rel=0.03)
    still = lf.mission.Ensemble(3, drag=0.0, waves=0.0)
    assert flights_of(design, lf.mission.Level(), start, still).vehicle.drag is None


@pytest.mark.parametrize("bearing", [0.0, 1.5, 3.0, 4.5])
def test_a_tilted_flyer_makes_for_its_station_at_the_speed_of_steady_drift(
    closed_form_disk, lit_air, bearing, fly
):
    disk, air, away = closed_form_disk(0.01), lit_air(), 1.0 * DEGREE
    north = 20.0 + np.cos(bearing) * away / DEGREE
    east = 179.9 + np.sin(bearing) * away / DEGREE / np.cos(20.0 * DEGREE)
    rule = lf.mission.TowardsStation(Circle(north, (east + 180.0) % 360.0 - 180.0, 1e3), 0.2)
    flown = fly("10 min", flyer=disk, altitude="72 km", attitude=rule)
    near = np.radians(float(flown.tilt[0]))
    assert near == pytest.approx(0.2 * 111.2 / 121.2, rel=2e-3)
    steady = lf.mission.steady_drift(
        disk, air, lf.FreeMolecular(), altitude=72e3, tilt=near, azimuth=bearing
    )
    moving = np.array([flown.northward_speed[0], flown.eastward_speed[0]])
    speed = float(steady.speed) * np.array([np.cos(bearing), np.sin(bearing)])
    np.testing.assert_allclose(moving, speed, atol=0.01 * float(steady.speed))
    assert float(steady.speed) > 0.3


def test_the_way_to_a_place_is_that_of_spherical_trigonometry(rng):
    here, there = (
        np.array([rng.uniform(-1.5, 1.5, 200), rng.uniform(-np.pi, np.pi, 200)]) for _ in range(2)
    )
    with lf.float64():
        east, north = map(np.asarray, angles_towards(*here, *there))
        none = angles_towards(0.7, 0.2, 0.7, 0.2)
    half = (
        np.sin(0.5 * (there[0] - here[0])) ** 2
        + np.cos(here[0]) * np.cos(there[0]) * np.sin(0.5 * (there[1] - here[1])) ** 2
    )
    turn = there[1] - here[1]
    bearing = np.arctan2(
        np.sin(turn) * np.cos(there[0]),
        np.cos(here[0]) * np.sin(there[0]) - np.sin(here[0]) * np.cos(there[0]) * np.cos(turn),
    )
    angle = 2.0 * np.arcsin(np.sqrt(half))
    np.testing.assert_allclose(east, angle * np.sin(bearing), atol=1e-9)
    np.testing.assert_allclose(north, angle * np.cos(bearing), atol=1e-9)
    np.testing.assert_allclose(none, 0.0, atol=1e-15)


@pytest.mark.parametrize(("begin", "speed", "within", "left"), [
    (0.0, 20.0, 5000.0, 5000.0),  # leaves, and does not come back
    (-300e3, 20.0, 10_000.0, 20_000.0),  # passes through
    (-300e3, 10.0, 16_000.0, np.inf),  # stays
    (-300e3, 5.0, 0.0, np.inf),  # does not come there
])  # fmt: skip
def test_a_stay_lasts_as_long_as_the_way_through_the_station(begin, speed, within, left):
    duration = 36_000.0

    def along(at):
        with lf.float64():
            unit = unit_vector(0.0 * at, (begin + speed * at) / RADIUS)
        return np.column_stack([unit, 0.0 * at])

    way = Trajectory(np.array([0.0, duration]), along)
    stay = xr.Dataset(attrs={"planet_radius_km": RADIUS / 1e3})
    add_station(stay, Circle(0.0, 0.0, 100e3), way)
    assert float(stay.station_within) == pytest.approx(within, abs=0.02)
    assert float(stay.station_left) == pytest.approx(left, abs=0.02)
    farthest = max(abs(begin), abs(begin + speed * duration))
    assert float(stay.station_farthest) == pytest.approx(farthest, rel=1e-9)


class Daytime(lf.mission.AbstractAttitudeRule):
    """A rule of a user's own: tilted in the first hour, dim after."""

    def attitude(self, moment):
        del moment

    def light(self, moment):
        return np.where(moment.elapsed < 3600.0, 1.0, 0.25)

    def describe(self):
        return "dim after an hour"


def test_a_rule_of_ones_own_flies_and_so_does_an_ensemble_of_it(fly):
    flown = fly(
        "2 h", Shear(), attitude=Daytime(), every="15 min",
        ensemble=lf.mission.Ensemble(3, wind=5.0), station=Circle(20.0, 179.9, "20 km"),
    )  # fmt: skip
    np.testing.assert_allclose(flown.light_share, [1.0] * 4 + [0.25] * 5)
    assert "attitude: dim after an hour" in flown.attrs["assumptions"]
    stay = lf.mission.summarise(flown)["station"]
    assert stay["place"] == "within 20 km of 20° N, 179.9° E"
    assert stay["within_h"] == pytest.approx(stay["left_after_h"])
    members = flown.ensemble_station_within.values
    assert members.shape == (3,)
    assert np.ptp(members) > 60.0
    assert np.all(members < 7200.0)


@pytest.mark.parametrize(("methods", "said"), [
    ({"light": lambda self, moment: 2.0}, "Mine.light gives 2.0; it is one number from 0 to 1"),
    ({"light": lambda self, moment: np.nan}, "Mine.light gives nan"),
    ({"light": lambda self, moment: np.ones(2)}, "one number from 0 to 1"),
    ({"light": lambda self, moment: "bright"}, "Mine.light"),
    ({"light": lambda self, moment: 0.5 if moment.altitude > 80e3 else 1.0}, "write numpy.where"),
    ({"attitude": lambda self, moment: 0.2}, "attitude of Mine must be"),
    ({"attitude": lambda self, moment: moment.tilt}, "Mine.attitude: .*tilt"),
])  # fmt: skip
def test_a_rule_that_serves_no_flight_is_named(fly, methods, said):
    with pytest.raises(lf.ParameterError, match=said):
        fly("1 h", attitude=type("Mine", (Daytime,), methods)())


def test_there_is_nothing_to_choose_in_the_same_wind_everywhere(fly, station):
    rule = lf.mission.Shaded(lf.mission.ChooseWind(station, "66 km", "78 km"))
    flown = fly("10 min", lf.environment.UniformWind(east=5.0), attitude=rule)
    assert "the wind is the same at all altitudes to choose from" in flown.attrs["warnings"]


def test_wind_of_other_altitudes_is_none_where_the_air_is_at_rest():
    light = lf.environment.sunlight()
    moment = lf.mission.Moment(
        0.0, 70e3, Place(0.0, 0.0, 0.0), light, Wind(0.0, 0.0, 0.0), None, lf.Earth()
    )
    np.testing.assert_array_equal(moment.wind_at(np.array([60e3, 70e3])), np.zeros((3, 2)))
