"""A flight is SciPy's, whatever is kept of it or flies beside it."""

import dataclasses

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import lightflyer as lf
from lightflyer.array.namespace import by_numpy, float64
from lightflyer.mission.path.attitude import Own
from lightflyer.mission.path.dynamics import Balanced, Inertia, Moving, follow, scale
from lightflyer.mission.path.integration import (
    Accuracy,
    Limits,
    Start,
    TerminationReason,
    integrate,
)
from lightflyer.mission.path.motion import Vehicle

FILM = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
RELEASE = lf.Release("75 km", latitude=45.0, longitude=10.0, time="2026-06-21T12:00Z")
EARTH = lf.Earth(sky=lf.environment.Daylight())
WIND = lf.environment.UniformWind(50.0, 5.0)


@pytest.fixture(scope="module")
def disk():
    return lf.Disk(FILM, radius=0.001)


def by_scipy(law, begin, times, **how):
    """The same rates, one moment at a time."""

    def rate(time, state):  # (n,), or (n, k) for the slopes
        rows = np.atleast_2d(state.T)
        with by_numpy():
            found = law.rate(np.full((1, len(rows)), time), rows[None])[0][0]
        return found.T.reshape(state.shape)

    return solve_ivp(rate, (times[0], times[-1]), begin, t_eval=times, vectorized=True, **how).y.T


def test_a_flight_through_a_night_is_that_of_scipy(disk):
    earth, times = lf.Earth(sky=lf.environment.Daylight(), wind=WIND), np.linspace(0.0, 64.8e3, 13)
    vehicle = Vehicle(lf.Setup(disk, earth, lf.FreeMolecular()), Own())
    start, limits = RELEASE.start(), Limits(2e4, 1.2e5)
    ours, way = follow(vehicle, start, limits, times, Accuracy.for_duration(times[-1]))
    law = Balanced(vehicle, np.reshape(start.place.time, (1, 1)), limits)
    theirs = by_scipy(law, scale(start), times, method="LSODA", rtol=1e-9, atol=1e-9)
    assert np.ptp(ours.altitude) > 5e3
    np.testing.assert_allclose(ours.altitude, 1e5 * theirs[:, 3], atol=0.05)
    np.testing.assert_allclose(ours.position, theirs[:, :3], atol=1e-7)
    np.testing.assert_allclose(way(times)[0], ours.altitude, atol=1e-6)


def test_a_steady_flight_takes_few_calls_of_the_rate(disk, monkeypatch):
    calls, rate = [], Balanced.rate
    monkeypatch.setattr(Balanced, "rate", lambda *args: calls.append(1) or rate(*args))
    vehicle = Vehicle(lf.Setup(disk, EARTH, lf.FreeMolecular()), Own())
    times = np.linspace(0.0, 48 * 3600.0, 25)
    follow(vehicle, RELEASE.start(), Limits(2e4, 1.2e5), times, Accuracy.for_duration(times[-1]))
    assert len(calls) <= 80


def test_what_is_kept_changes_no_flight(disk):
    """Nor its nights and extremes, to the printed digit."""
    said = {
        lf.mission.describe(
            lf.fly(disk, EARTH, lf.FreeMolecular(), release=RELEASE, duration="18 h", every=spacing)
        )
        for spacing in ("2 min", "6 h")
    }
    assert len(said) == 1
    assert "nights" in said.pop()


def test_an_ensemble_changes_no_flight(disk):
    def fly(**more):
        return lf.fly(
            disk, EARTH, lf.FreeMolecular(), release=RELEASE, duration="2 h", every="1 h", **more
        )

    beside = fly(ensemble=lf.mission.Ensemble(members=6, altitude=500.0))
    np.testing.assert_array_equal(fly()["altitude"], beside["altitude"])
    # the members begin and end around it
    ends = beside["ensemble_altitude"].isel(elapsed=-1)
    assert abs(float(ends.mean() - beside["altitude"][-1])) < 1000.0


def test_members_fly_as_each_does_alone():
    """In one array, though some end earlier than others."""
    disk = lf.Disk(FILM, radius=0.005)
    vehicle = Vehicle(lf.Setup(disk, EARTH, lf.FreeMolecular()), Own())
    start, times = RELEASE.start(), np.linspace(0.0, 18 * 3600.0, 19)
    limits, accuracy = Limits(66e3, 1.2e5), Accuracy.for_duration(times[-1])
    released = start.place.time + 3600.0 * np.array([0.0, 3.0, 5.0, 14.0])
    starts = [Start(75e3, start.place._replace(time=time)) for time in released]
    law = Balanced(vehicle, released[:, None], limits)
    together = integrate(law, np.stack([scale(one) for one in starts]), times, accuracy).track
    reasons = [TerminationReason.LOWEST_ALTITUDE] * 3 + [TerminationReason.STILL_FLYING]
    np.testing.assert_array_equal(together.termination, reasons)
    for row, one in enumerate(starts):
        alone, _ = follow(vehicle, one, limits, times, accuracy)
        assert together.end_elapsed[row] == pytest.approx(alone.end_elapsed, abs=0.05)
        np.testing.assert_allclose(together.altitude[row], alone.altitude, atol=0.01)
    assert np.ptp(together.end_elapsed[:3]) > 3600.0


def test_a_flight_ends_at_a_pole_where_a_wind_comes_from_all_sides(disk):
    """There is no way on: the wind blows north up to it."""
    earth = lf.Earth(sky=lf.environment.Daylight(), wind=lf.environment.UniformWind(10.0, 30.0))
    release = dataclasses.replace(RELEASE, latitude=89.0)
    flown = lf.fly(disk, earth, lf.FreeMolecular(), release=release, duration="6 h", every="10 min")
    assert TerminationReason(int(flown.end_reason)) is TerminationReason.NO_DATA
    assert float(flown.end_latitude) == pytest.approx(90.0, abs=1e-5)
    altitude, radius = float(flown.end_altitude), 6_399_593.6  # of curvature at a pole
    # a spiral: the way north at 30 m/s
    whole = np.radians(1.0) * (radius + altitude) / 30.0
    assert float(flown.end_elapsed) == pytest.approx(whole, rel=1e-3)


@pytest.mark.parametrize("inertia", [None, Inertia()])
def test_the_first_seconds_are_those_of_scipy(disk, inertia):
    moving = np.array([0.0, 120.0, 350.0])  # in air so thin that it goes on for seconds
    start = dataclasses.replace(RELEASE, altitude=95e3, velocity=moving).start()
    vehicle = Vehicle(lf.Setup(disk, EARTH, lf.FreeMolecular()), Own())
    times = np.linspace(0.0, 8.0, 5)
    numbers = Start(*(np.reshape(one, (1, 1)) for one in (start.altitude,)),
                    type(start.place)(*(np.reshape(one, (1, 1)) for one in start.place)),
                    moving[None, None])  # fmt: skip
    law = Moving(vehicle, numbers.place.time, Limits(0.0, 2e5), inertia)
    with by_numpy():
        begin = law.at_release(numbers)[:, 0]
    ours = integrate(law, begin, times, Accuracy(100_000))
    theirs = by_scipy(law, begin[0], times, method="LSODA", rtol=1e-8, atol=1e-10)
    assert np.ptp(theirs[:, 3]) * 1e5 > 50.0
    np.testing.assert_allclose(ours.trajectory.states(times), theirs, atol=2e-7)


def test_the_end_is_where_a_limit_is_reached(disk):
    vehicle = Vehicle(lf.Setup(disk, lf.Earth(), lf.FreeMolecular()), Own())
    with float64():
        start = RELEASE.start()
    limits = Limits(74.9e3, 80e3)
    dark = lf.Setup(disk, lf.Earth(radiation=lf.environment.Radiation(0.0)), lf.FreeMolecular())
    elapsed = np.linspace(0.0, 7200.0, 5)
    sunk, way = follow(Vehicle(dark, Own()), start, limits, elapsed, Accuracy(1000))
    assert way(np.array([sunk.end_elapsed]))[0] == sunk.end_altitude
    assert sunk.termination == TerminationReason.LOWEST_ALTITUDE
    assert sunk.end_altitude == pytest.approx(limits.lowest, abs=1e-3)
    assert np.isinf(sunk.altitude[elapsed > sunk.end_elapsed]).all()
    short = Accuracy(3, longest=600.0)
    few, _ = follow(vehicle, Start(75e3, start.place), Limits(2e4, 1.2e5), elapsed, short)
    assert few.termination == TerminationReason.STEP_LIMIT
    assert few.steps == 3
