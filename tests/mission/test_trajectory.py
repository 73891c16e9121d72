"""Trajectories against SciPy, against themselves turned, against finer and fuller integration."""

import jax
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

import lightflyer as lf
from lightflyer.environment import Place
from lightflyer.mission.mission import trajectory
from lightflyer.mission.path.attitude import FollowSun, Level
from lightflyer.mission.path.dynamics import Inertia, state_at_release, track_with_inertia
from lightflyer.mission.path.integration import (
    Accuracy,
    Limits,
    Start,
    scale_state,
    steady_rate,
    track,
)
from lightflyer.mission.path.motion import Craft
from lightflyer.mission.path.position import unit_vector
from lightflyer.mission.path.single import follow_with_inertia
from lightflyer.mission.path.termination import TerminationReason

HALF_DAY = 43_200.0
SIZES = {1e-3: 65.3, 2e-3: 63.3, 5e-3: 57.0, 1e-2: 46.7, 2e-2: 31.4, 3e-2: 24.9}
TURN = Rotation.from_euler("xyz", [25.0, 40.0, 70.0], degrees=True).as_matrix()


def vector(latitude, longitude):
    with lf.float64():
        return np.asarray(unit_vector(latitude, longitude))


def to_pole(start):
    """A rotation that turns a place to the pole."""
    here = vector(*start)
    across = np.cross(here, [0.0, 0.0, 1.0])
    angle = np.arccos(here[2])
    return Rotation.from_rotvec(angle * across / np.linalg.norm(across)).as_matrix()


def place_of(unit):
    return np.arctan2(unit[2], np.hypot(unit[0], unit[1])), np.arctan2(unit[1], unit[0])


def released(place, altitude=75e3, time=0.0):
    return Start(np.float64(altitude), Place(*map(np.float64, place), np.float64(time)))


def stacked(trees):
    return jax.tree.map(lambda *leaves: np.stack(leaves), *trees)


@pytest.fixture(scope="module")
def flown(sky, closed_form_disk):
    """Flights at night, by day, and turned, all by one compiled program."""
    here = (0.3, 0.2)
    cases = {("night", size): (closed_form_disk(size), sky(0.0), released(here)) for size in SIZES}
    cases["sinking"] = (closed_form_disk(0.01, 0.85, 0.85), sky(0.0), released(here))
    for name, turn in {"day": np.eye(3), "turned": TURN}.items():
        start = released(place_of(turn @ vector(*here)))
        cases[name] = (closed_form_disk(2e-3), sky(turn=turn), start)
    crafts = [
        (Craft(lf.Setup(disk, around, lf.Lu2023()), Level()), start)
        for disk, around, start in cases.values()
    ]
    times = np.linspace(0.0, HALF_DAY, 25)

    def one(craft, start):
        return track(craft, start, Limits(0.0, 200e3), times, Accuracy.for_duration(HALF_DAY))

    with lf.float64():
        tracks = jax.jit(jax.vmap(one))(*stacked(crafts))
    tracks = jax.tree.map(np.asarray, tracks)
    return {
        name: jax.tree.map(lambda leaf, row=row: leaf[row], tracks)
        for row, name in enumerate(cases)
    }


@pytest.mark.slow
@pytest.mark.parametrize("size", SIZES)
def test_a_night_takes_a_disk_from_75_km_to_where_others_computed(flown, size):
    found = flown["night", size]
    assert found.termination == TerminationReason.STILL_FLYING
    assert found.end_altitude / 1e3 == pytest.approx(SIZES[size], abs=0.5)


@pytest.mark.slow
def test_sinking_without_lift_is_that_of_scipy_and_another_atmosphere(flown, fall_speed):
    expected = solve_ivp(
        lambda _, altitude: [-fall_speed(altitude[0])],
        (0.0, HALF_DAY),
        [75e3],
        rtol=1e-8,
        atol=1e-3,
    )
    assert flown["sinking"].end_altitude == pytest.approx(expected.y[0, -1], abs=2.0)


def test_no_place_is_special_when_sun_and_air_are_turned_as_well(by_numpy, sky, closed_form_disk):
    here, step, count = (0.3, 0.2), 900.0, 24
    turns = np.stack([np.eye(3), TURN, to_pole(here)])
    starts = [released(place_of(turn @ vector(*here))) for turn in turns]
    crafts = [
        Craft(lf.Setup(closed_form_disk(2e-3), sky(turn=turn), lf.FreeMolecular()), FollowSun())
        for turn in turns
    ]
    with lf.float64():
        craft, start = stacked(crafts), stacked(starts)
        one = lambda craft, start, time, flown: steady_rate(  # noqa: E731
            craft, start, Limits(0.0, 200e3), time, flown
        )
        rate = by_numpy(jax.vmap(one, in_axes=(0, 0, None, 0)))
        flown = np.stack([np.asarray(scale_state(start)) for start in starts])
        begin = flown[0]
        for number in range(count):
            time = np.float64(number * step)
            first = rate(craft, start, time, flown)
            second = rate(craft, start, time + 0.5 * step, flown + 0.5 * step * first)
            flown = np.asarray(flown + step * second)
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


class Afternoon:
    """A flight of half an hour through sunset; its end by emittance and time of release."""

    release = (75e3, 17.0, 11.0)
    begin, duration = 835_077_800.0, 1800.0

    def __init__(self, air, disk):
        self.around, self.disk = air, disk
        self.value_and_slope = jax.jit(jax.value_and_grad(self.end))

    def flyer(self, emittance):
        return self.disk(5e-3, emittance=emittance, inertia=0.0)

    def end(self, numbers):
        altitude, latitude, longitude = self.release
        emittance, time = numbers
        way = trajectory(
            self.flyer(emittance),
            self.around,
            lf.FreeMolecular(),
            lf.Release(altitude, latitude=latitude, longitude=longitude, time=time),
            [0.0, self.duration],
            longest_step=3.0,
        )
        return way.end_altitude


@pytest.fixture(scope="module")
def afternoon(isothermal_air, closed_form_disk):
    return Afternoon(isothermal_air, closed_form_disk)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("hours_earlier", "slack_in_time"),
    [(5.0, 0.0), (0.0, 1e-3)],  # by day, and through the sharp ends of the penumbra
)
def test_gradient_of_the_last_altitude_is_that_of_differences(
    afternoon, hours_earlier, slack_in_time
):
    with lf.float64():
        here = np.array([0.08, afternoon.begin - 3600.0 * hours_earlier])
        _, slope = afternoon.value_and_slope(here)
        for number, step in enumerate((5e-4, 10.0)):
            shift = step * np.eye(2)[number]
            high, low = (
                float(afternoon.value_and_slope(here + way * shift)[0]) for way in (1.0, -1.0)
            )
            expected = (high - low) / (2.0 * step)
            slack = slack_in_time if number else 0.0
            assert float(slope[number]) == pytest.approx(expected, rel=1e-4, abs=slack)


@pytest.mark.slow
def test_velocity_and_temperature_follow_at_once(afternoon):
    setup = lf.Setup(afternoon.flyer(0.08), afternoon.around, lf.FreeMolecular())
    altitude, *place = afternoon.release
    start = released(np.radians(place), altitude, afternoon.begin)
    times = np.array([0.0, afternoon.duration])
    with lf.float64():
        steady, _ = afternoon.value_and_slope(np.array([0.08, afternoon.begin]))
        craft = Craft(setup, Level())
        accuracy = Accuracy.for_duration(afternoon.duration)
        state = np.asarray(state_at_release(craft, start, Inertia()))
        course = Limits(0.0, 200e3), times, accuracy, Inertia()
        found = jax.jit(track_with_inertia)(craft, start, state, *course).track
    alone = follow_with_inertia(craft, start, state, *course).track
    assert float(alone.end_altitude) == pytest.approx(float(found.end_altitude), abs=1e-3)
    assert int(found.termination) == TerminationReason.STILL_FLYING
    assert abs(float(steady) - altitude) > 200.0
    assert 1e-3 < abs(float(found.end_altitude - steady)) < 1.0
