"""Trajectories against SciPy, against themselves turned, against finer and fuller integration."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

import lightflyer as lf
from lightflyer.array.namespace import by_numpy as computed
from lightflyer.environment import Place
from lightflyer.mission.areas import unit_vector
from lightflyer.mission.mission import trajectory
from lightflyer.mission.path.attitude import FollowSun, Level
from lightflyer.mission.path.dynamics import Balanced, Inertia, Moving, follow, scale
from lightflyer.mission.path.integration import (
    Accuracy,
    Limits,
    Start,
    TerminationReason,
    integrate,
)
from lightflyer.mission.path.motion import Vehicle

HALF_DAY = 43_200.0
SIZES = {1e-3: 65.3, 2e-3: 63.3, 5e-3: 57.0, 1e-2: 46.7, 2e-2: 31.4, 3e-2: 24.9}
TURN = Rotation.from_euler("xyz", [25.0, 40.0, 70.0], degrees=True).as_matrix()


def vector(latitude, longitude):
    with lf.float64():
        return np.asarray(unit_vector(latitude, longitude))


def place_of(unit):
    return np.arctan2(unit[2], np.hypot(unit[0], unit[1])), np.arctan2(unit[1], unit[0])


def released(place, altitude=75e3, time=0.0):
    return Start(np.float64(altitude), Place(*map(np.float64, place), np.float64(time)))


@pytest.fixture(scope="module")
def flown(sky, closed_form_disk):
    """Flights at night, by day, and turned."""
    here = (0.3, 0.2)
    cases = {("night", size): (closed_form_disk(size), sky(0.0), released(here)) for size in SIZES}
    cases["sinking"] = (closed_form_disk(0.01, 0.85, 0.85), sky(0.0), released(here))
    for name, turn in {"day": np.eye(3), "turned": TURN}.items():
        start = released(place_of(turn @ vector(*here)))
        cases[name] = (closed_form_disk(2e-3), sky(turn=turn), start)
    times, accuracy = np.linspace(0.0, HALF_DAY, 25), Accuracy.for_duration(HALF_DAY)

    def fly(disk, around, start):
        vehicle = Vehicle(lf.Setup(disk, around, lf.Lu2023()), Level())
        return follow(vehicle, start, Limits(0.0, 200e3), times, accuracy)[0]

    return {name: fly(*case) for name, case in cases.items()}


@pytest.mark.parametrize("size", SIZES)
def test_a_night_takes_a_disk_from_75_km_to_where_others_computed(flown, size):
    found = flown["night", size]
    assert found.termination == TerminationReason.STILL_FLYING
    assert found.end_altitude / 1e3 == pytest.approx(SIZES[size], abs=0.5)


def test_a_flight_that_sinks_at_its_end_says_so(closed_form_disk):
    """At the speed of the last minutes, and not that it flies."""
    track = lf.fly(
        closed_form_disk(0.01, 0.85, 0.85), lf.Earth(), lf.Lu2023(), duration="2 h",
        release=lf.Release("70 km", latitude=10.0, longitude=0.0, time="2026-06-21T12:00Z"),
    )  # fmt: skip
    fall = -np.diff(track.altitude.values)[-1] / np.diff(track.elapsed.values)[-1]
    told = track.attrs["end"].partition(" aloft at the end of its time, sinking at ")[2]
    assert float(told.removesuffix(" m/s")) == pytest.approx(fall, rel=0.1)


def test_sinking_without_lift_is_that_of_scipy_and_another_atmosphere(flown, fall_speed):
    expected = solve_ivp(
        lambda _, altitude: [-fall_speed(altitude[0])],
        (0.0, HALF_DAY),
        [75e3],
        rtol=1e-8,
        atol=1e-3,
    )
    assert flown["sinking"].end_altitude == pytest.approx(expected.y[0, -1], abs=2.0)


def test_no_place_is_special_when_sun_and_air_are_turned_as_well(sky, closed_form_disk):
    here, step, count = (0.3, 0.2), 900.0, 24
    axis = np.cross(vector(*here), [0.0, 0.0, 1.0])  # about which the place turns to the pole
    to_pole = Rotation.from_rotvec((0.5 * np.pi - here[0]) * axis / np.linalg.norm(axis))
    turns = np.stack([np.eye(3), TURN, to_pole.as_matrix()])
    starts = [released(place_of(turn @ vector(*here))) for turn in turns]
    laws = [
        Balanced(
            Vehicle(
                lf.Setup(closed_form_disk(2e-3), sky(turn=turn), lf.FreeMolecular()), FollowSun()
            ),
            np.zeros((1, 1)),
            Limits(0.0, 200e3),
        )
        for turn in turns
    ]

    def rate(time, flown):
        with computed():
            found = [
                law.rate(np.array([[time]]), state[None, None])[0]
                for law, state in zip(laws, flown, strict=True)
            ]
        return np.concatenate(found)[:, 0]

    flown = np.stack([scale(start) for start in starts])
    begin = flown[0]
    for number in range(count):
        time = number * step
        second = rate(time + 0.5 * step, flown + 0.5 * step * rate(time, flown))
        flown = flown + step * second
    assert np.linalg.norm(flown[0] - begin) > 0.1
    expected = np.einsum("nij,j->ni", turns, flown[0, :3])
    np.testing.assert_allclose(flown[:, :3], expected, atol=1e-13)
    np.testing.assert_allclose(flown[:, 3], flown[0, 3], rtol=1e-12)


def test_steps_of_the_integration_know_no_direction_either(flown):
    here, there = flown["day"], flown["turned"]
    assert np.ptp(here.altitude) > 5e3
    # to the tolerance of the integration, which rounding may lead to other steps
    np.testing.assert_allclose(there.altitude, here.altitude, atol=0.5)
    np.testing.assert_allclose(there.position, here.position @ TURN.T, atol=1e-7)


def test_air_that_turns_as_a_whole_carries_along_a_circle(flown):
    day = flown["day"]
    axis = np.array([1.0, 0.0, 1.0]) / np.sqrt(2.0)
    latitudes = day.position @ axis
    np.testing.assert_allclose(latitudes, latitudes[0], atol=1e-8)


def test_velocity_and_temperature_follow_at_once(isothermal_air, closed_form_disk):
    """A flight of half an hour through sunset."""
    disk, begin, duration = closed_form_disk(5e-3, inertia=0.0), 835_077_800.0, 1800.0
    altitude, *place = 75e3, 17.0, 11.0
    steady = trajectory(
        disk, isothermal_air, lf.FreeMolecular(),
        lf.Release(altitude, latitude=place[0], longitude=place[1], time=begin), [0.0, duration],
    ).end_altitude  # fmt: skip
    start = released(np.radians(place), altitude, begin)
    numbers = Start(
        np.reshape(altitude, (1, 1)), Place(*(np.reshape(part, (1, 1)) for part in start.place))
    )
    vehicle = Vehicle(lf.Setup(disk, isothermal_air, lf.FreeMolecular()), Level())
    law = Moving(vehicle, numbers.place.time, Limits(0.0, 200e3), Inertia())
    with computed():
        state = law.at_release(numbers)[:, 0]
    found = integrate(law, state, np.array([0.0, duration]), Accuracy.for_duration(duration)).track
    assert found.termination[0] == TerminationReason.STILL_FLYING
    assert abs(steady - altitude) > 200.0
    assert 1e-3 < abs(found.end_altitude[0] - steady) < 1.0


@pytest.mark.parametrize("seed", range(3))
def test_a_flight_ends_at_the_place_of_rest_of_the_verdict(seed):
    """Disks in a light that is always the same."""
    rng = np.random.default_rng(seed)
    film = lf.FilmProperties(
        rng.uniform(0.8e-3, 1.2e-3), rng.uniform(0.6, 0.9), 0.08, rng.uniform(0.05, 0.1),
        tac_top=0.8, tac_bottom=rng.uniform(0.88, 0.95),
    )  # fmt: skip
    around = lf.Disk(film, radius=rng.uniform(1e-3, 4e-3)), lf.Earth(), lf.Lu2023()
    rest = lf.predict(*around).verdict.rest
    below = lf.Release(rest.coordinate - 2e3, 10.0, 0.0, "2026-06-21T12:00Z")
    flown = lf.fly(*around, release=below, duration="30 h", attitude=Level())
    assert float(flown.end_altitude) == pytest.approx(rest.coordinate, abs=10.0)
    assert float(flown.temperature[-1]) == pytest.approx(rest.values["temperature"], abs=0.1)
