"""Positions, attitudes, errors of the wind, times, spans of day and night."""

import numpy as np
import pytest
import xarray as xr

import lightflyer as lf
from lightflyer.cli.commands.init import templates
from lightflyer.environment import EARTH_PLANET, Attitude, Place, Radiation, Wind
from lightflyer.mission import FollowSun, Moment, Own
from lightflyer.mission.areas import directions, latitude_and_longitude, unit_vector
from lightflyer.mission.mission import times_of
from lightflyer.mission.path.air import WindError, draw_wind_errors
from lightflyer.mission.path.dynamics import rate_of
from lightflyer.mission.path.integration import Trajectory
from lightflyer.mission.path.motion import Vehicle, steady_speeds, velocity
from lightflyer.mission.report import events
from lightflyer.mission.report.figures import coastline
from lightflyer.mission.report.maps import pieces_of
from lightflyer.mission.report.summary import day_and_night

RELEASE = lf.Release("75 km", latitude=45.0, longitude=0.0, time="2026-06-21T12:00Z")


def test_a_mission_flies_as_its_fields_do(disk, tmp_path):
    setup = lf.Setup(disk, lf.Earth(), lf.FreeMolecular())
    mission = lf.mission.Mission(RELEASE, "1 h", launches=[600.0])
    given = {"release": RELEASE, "duration": 3600.0, "launches": [600.0]}
    xr.testing.assert_identical(lf.fly(setup, mission=mission), lf.fly(setup, **given))
    later = lf.fly(setup, mission=mission, duration="2 h")
    assert float(later.elapsed[-1]) == 7200.0
    assert mission.duration == 3600.0


def test_a_mission_file_is_a_mission(write):
    path = write(templates()["mission"].read(), "mission.toml")
    file = lf.mission.read_mission_file(path)
    assert isinstance(file.mission, lf.mission.Mission)
    assert file.mission.lowest == 50e3
    assert lf.mission.Mission(**file.arguments()) == file.mission


def test_positions_come_back_and_directions_are_at_right_angles(rng):
    latitude, longitude = rng.uniform(-1.57, 1.57, 50), rng.uniform(-3.14, 3.14, 50)
    with lf.float64():
        position = unit_vector(latitude, longitude)
        back = latitude_and_longitude(position)
        east, north = directions(latitude, longitude)
    np.testing.assert_allclose(back, [latitude, longitude], atol=1e-13)
    np.testing.assert_allclose(np.cross(east, north), position, atol=1e-15)
    assert np.all(np.asarray(north)[:, 2] > 0.0)
    with lf.float64():
        pole = latitude_and_longitude(np.array([0.0, 0.0, 1.0]))
    np.testing.assert_allclose(pole, [0.5 * np.pi, 0.0])


def test_following_the_sun_halves_its_angle_and_lets_go_of_it_at_night():
    def tilt(zenith_angle, visible):
        light = Radiation(zenith_angle=zenith_angle, azimuth=0.7, visible=visible)
        nothing = Place(0.0, 0.0, 0.0), light, Wind(0.0, 0.0, 0.0), None, lf.Earth()
        found = FollowSun().attitude(Moment(0.0, 75e3, *nothing))
        assert float(found.azimuth) == pytest.approx(0.7)
        return float(found.tilt)

    assert tilt(1.0, 1.0) == pytest.approx(0.5, rel=1e-6)
    assert tilt(1.7, 1.0) == pytest.approx(0.25 * np.pi, rel=1e-6)
    assert tilt(1.7, 0.0) == 0.0


def test_errors_of_the_wind_have_the_stated_size_and_memory():
    lag, memory = 6.0 * 3600.0, 12.0 * 3600.0
    errors = draw_wind_errors(20_000, 10.0, 0.1, memory, seed=1)
    first = [errors.cosines.sum(axis=-1)[:, axis] for axis in range(4)]
    phases = errors.frequencies[:, None] * lag
    waves = errors.cosines * np.cos(phases) + errors.sines * np.sin(phases)
    later = [waves.sum(axis=-1)[:, axis] for axis in range(4)]
    for here, there, spread in zip(first, later, (10.0, 10.0, 10.0, 0.1), strict=True):
        assert here.std() == pytest.approx(spread, rel=0.02)
        correlation = np.mean(here * there) / here.var()
        assert correlation == pytest.approx(np.exp(-0.5 * (lag / memory) ** 2), abs=0.03)


@pytest.mark.parametrize("place", [Place(0.8, 2.0, 0.0), Place(0.5 * np.pi, -1.0, 0.0)])
def test_an_error_of_the_wind_is_a_vector_along_the_ground(place):
    one = WindError(np.zeros(1), np.array([[3.0], [4.0], [12.0], [0.5]]), np.zeros((4, 1)))
    with lf.float64():
        found = one.add_to_wind(Wind(1.0, 2.0, 0.0), place, 100.0)
        up = np.asarray(unit_vector(place.latitude, place.longitude))
    along = np.array([3.0, 4.0, 12.0]) - up * (up @ [3.0, 4.0, 12.0])
    size = np.hypot(float(found.east) - 1.0, float(found.north) - 2.0)
    assert size == pytest.approx(np.linalg.norm(along), rel=1e-12)
    assert float(found.up) == 0.5


def test_times_end_with_the_duration():
    assert times_of("1 h").size == 61
    assert times_of("1 h", "20 min").tolist() == [0.0, 1200.0, 2400.0, 3600.0]
    assert times_of(1000.0, 300.0)[-1] == 1000.0


def test_day_and_night_change_where_half_of_the_light_is_left():
    """The light of an hour's triangle, by the moments at which it is looked at."""

    class Moments:
        def __call__(self, vehicle, course):
            light = np.maximum(1000.0 - np.abs(course.elapsed - 1800.0), 0.0)
            return {"irradiance": light, "temperature": 300.0 + course.elapsed}

    times = np.array([0.0, 1500.0, 3600.0])
    way = Trajectory(
        times,
        lambda at: np.stack([1.0 + 0.0 * at, 0.0 * at, 0.0 * at, 0.7 + at / 1e5], axis=-1),
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(events, "moments", Moments())
        found = events.events_of(None, way, *events.sample_flight(None, way, 0.0))
    flight = xr.Dataset({"end_elapsed": 3600.0})
    events.add_events(flight, found)
    spans = day_and_night(flight)
    assert [is_day for _, _, is_day in spans] == [False, True, False]
    np.testing.assert_allclose([end for _, end, _ in spans], [1300.0, 2300.0, 3600.0], atol=0.1)
    elapsed, altitude, temperature = events.at_event(found, events.Event.HIGHEST)
    assert (elapsed, altitude, temperature) == pytest.approx((3600.0, 73.6e3, 3900.0))


def test_lines_of_a_globe_end_at_the_date_line_and_begin_beyond_it():
    line = np.array(
        [[170.0, 10.0, 7e4], [178.0, 11.0, 7e4], [-176.0, 14.0, 6e4], [179.0, 14.0, 6e4]]
    )
    first, second, third = pieces_of(line)
    np.testing.assert_allclose(first, [*line[:2], [180.0, 12.0, 7e4 - 1e4 / 3.0]])
    np.testing.assert_allclose(second[0], [-180.0, 12.0, 7e4 - 1e4 / 3.0])
    np.testing.assert_allclose(second[1:], [line[2], [-180.0, 14.0, 6e4]])
    np.testing.assert_allclose(third, [[180.0, 14.0, 6e4], line[3]])
    (whole,) = pieces_of(line[:2])
    np.testing.assert_array_equal(whole, line[:2])


def test_coastlines_keep_to_the_world_and_do_not_cross_it():
    longitude, latitude = coastline()
    steps = np.abs(np.diff(longitude))
    assert np.nanmax(steps) < 30.0
    assert np.nanmax(np.abs(longitude)) <= 180.0
    assert np.nanmin(latitude) > -86.0
    near_gibraltar = np.hypot(longitude + 5.6, latitude - 36.0)
    assert np.nanmin(near_gibraltar) < 0.5


def test_a_release_reads_dates_and_units():
    release = lf.Release("75 km", latitude=45.0, longitude="10 deg", time="2000-01-01T13:00+01:00")
    assert (release.altitude, release.time) == (75e3, 0.0)


def test_a_tilted_disk_glides_so_that_all_forces_vanish(isothermal_air, closed_form_disk):
    tilt, azimuth = 0.4, 1.0
    up = np.array([0.0, 0.0, 1.0])
    normal = np.array(
        [np.sin(tilt) * np.sin(azimuth), np.sin(tilt) * np.cos(azimuth), np.cos(tilt)]
    )
    down = normal * np.cos(tilt) - up
    down /= np.linalg.norm(down)
    disk = closed_form_disk(5e-3)
    flyer = type(disk)(disk.film, disk.radius, attitude=Attitude(tilt, azimuth))
    vehicle = Vehicle(lf.Setup(flyer, isothermal_air, lf.FreeMolecular()), Own())
    with lf.float64():
        around = vehicle.surroundings(70e3, Place(0.3, 0.2, 835_030_000.0), 0.0)
        unknowns = vehicle.heat(around).unknowns
        forces = vehicle.forces(around, unknowns)
        axial, slope = steady_speeds(around, forces, unknowns)
        moving = np.array([float(part) for part in velocity(around, axial, slope)])
        pushed = float(lf.FreeMolecular().force(flyer, around.state, unknowns))
        drags = [
            float(flyer.drag(around.state, unknowns, speed, way))
            for speed, way in ((axial, "broadside"), (slope, "edgewise"))
        ]
    weight = float(forces.weight)
    total = pushed * normal - weight * up - drags[0] * normal - drags[1] * down
    assert np.linalg.norm(total) < 1e-9 * weight
    assert min(abs(drags[0]), drags[1]) > 0.1 * weight
    np.testing.assert_allclose(moving, float(axial) * normal + float(slope) * down, rtol=1e-9)


def test_a_degree_is_longer_at_the_pole_and_along_the_equator():
    # World Geodetic System 1984: radii of curvature of meridian and prime vertical at the equator
    altitude, place = 1e3, Place(0.0, 0.0, 0.0)
    with lf.float64():
        rate = np.asarray(rate_of(Wind(1.0, 1.0, 5.0), place, altitude, EARTH_PLANET))
    assert 1.0 / rate[1] - altitude == pytest.approx(6_378_137.0, rel=1e-9)
    assert 1.0 / rate[2] - altitude == pytest.approx(6_335_439.327, rel=1e-9)
    assert rate[0] == 0.0
    assert rate[3] * 100e3 == pytest.approx(5.0)
