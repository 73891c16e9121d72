"""One flight, by SciPy, is the same as by diffrax, whatever is kept of it or flies beside it."""

import dataclasses

import numpy as np
import pytest

import lightflyer as lf
from lightflyer.core.precision import float64
from lightflyer.mission import first_seconds, fleet
from lightflyer.mission.path.attitude import Own
from lightflyer.mission.path.integration import Accuracy, Limits, Start
from lightflyer.mission.path.motion import Craft
from lightflyer.mission.path.single import follow
from lightflyer.mission.path.termination import TerminationReason

FILM = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
RELEASE = lf.Release("75 km", latitude=45.0, longitude=10.0, time="2026-06-21T12:00Z")
EARTH = lf.Earth(sky=lf.environment.Daylight())


@pytest.fixture(scope="module")
def disk():
    return lf.Disk(FILM, radius=0.001)


@pytest.mark.slow
def test_a_flight_by_day_is_that_of_diffrax(disk):
    model, times = lf.FreeMolecular(), np.linspace(0.0, 6.0 * 3600.0, 13)
    theirs = lf.mission.trajectory(disk, EARTH, model, RELEASE, times, tolerance=1e-11)
    ours = lf.fly(disk, EARTH, model, release=RELEASE, duration="6 h", every="30 min")
    np.testing.assert_allclose(ours["altitude"], theirs.altitude, atol=1.0)


def test_what_is_kept_changes_no_flight(disk):
    """Nor its nights and extremes, to the printed digit."""
    said = {
        lf.mission.describe(
            lf.fly(disk, EARTH, lf.FreeMolecular(), release=RELEASE, duration="18 h", every=spacing)
        )
        for spacing in ("2 min", "1 h", "6 h")
    }
    assert len(said) == 1
    assert "nights" in said.pop()


@pytest.mark.slow
def test_an_ensemble_changes_no_flight(disk, monkeypatch):
    def fly(**more):
        return lf.fly(
            disk, EARTH, lf.FreeMolecular(), release=RELEASE, duration="2 h", every="1 h", **more
        )

    ensemble = lf.mission.Ensemble(members=6, altitude=500.0)
    with monkeypatch.context() as patch:
        patch.setattr(fleet, "_tracks", None)  # nothing is compiled for so few
        alone = fly(ensemble=ensemble)
    monkeypatch.setattr(fleet, "COMPILATION", 0)
    beside = fly(ensemble=ensemble)
    for one in (alone, beside):
        np.testing.assert_array_equal(fly()["altitude"], one["altitude"])
    # the members, by SciPy and together by XLA, begin and end around it
    np.testing.assert_allclose(alone["ensemble_altitude"], beside["ensemble_altitude"], atol=1.0)
    ends = beside["ensemble_altitude"].isel(elapsed=-1)
    assert abs(float(ends.mean() - beside["altitude"][-1])) < 1000.0


@pytest.mark.slow
def test_the_first_seconds_are_those_of_diffrax(disk, monkeypatch):
    moving = np.array([0.0, 120.0, 350.0])  # in air so thin that it goes on for seconds
    release = dataclasses.replace(RELEASE, altitude=95e3, velocity=moving)
    ensemble = lf.mission.Ensemble(members=6, velocity=20.0, waves=0.0)

    def fly():
        return lf.fly(
            disk, EARTH, lf.FreeMolecular(), release=release, duration="30 s", every="2 s",
            ensemble=ensemble,
        )  # fmt: skip

    with monkeypatch.context() as patch:
        patch.setattr(first_seconds, "_throw", None)  # nothing is compiled for so few
        alone = fly()
    monkeypatch.setattr(fleet, "COMPILATION", 0)
    beside = fly()
    for name in ("altitude", "ensemble_altitude"):
        np.testing.assert_allclose(alone[name], beside[name], atol=0.1)
    assert np.ptp(alone["altitude"].values) > 100.0
    np.testing.assert_allclose(alone["latitude"], beside["latitude"], atol=1e-6)


def test_the_end_is_where_a_limit_is_reached(disk):
    craft = Craft(lf.Setup(disk, lf.Earth(), lf.FreeMolecular()), Own())
    with float64():
        start = RELEASE.start()
    limits = Limits(74.9e3, 80e3)
    dark = lf.Setup(disk, lf.Earth(radiation=lf.environment.Radiation(0.0)), lf.FreeMolecular())
    elapsed = np.linspace(0.0, 7200.0, 5)
    sunk, way = follow(Craft(dark, Own()), start, limits, elapsed, Accuracy(1000))
    assert way(np.array([sunk.end_elapsed]))[0] == sunk.end_altitude
    assert sunk.termination == TerminationReason.LOWEST_ALTITUDE
    assert sunk.end_altitude == pytest.approx(limits.lowest, abs=1e-3)
    assert np.isinf(sunk.altitude[elapsed > sunk.end_elapsed]).all()
    few, _ = follow(craft, Start(75e3, start.place), Limits(2e4, 1.2e5), elapsed, Accuracy(3))
    assert few.termination == TerminationReason.STEP_LIMIT
    assert few.steps == 3
