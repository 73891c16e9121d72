"""Waves of the air beside closed forms of linear theory, and what they do to flights."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import cumulative_trapezoid, quad

import lightflyer as lf
from lightflyer.environment.base import Place
from lightflyer.mission.fleet import tides_of
from lightflyer.mission.path import air
from lightflyer.mission.path.air import Tides, Waves, draw_waves
from lightflyer.mission.report.assumptions import assumptions_of
from lightflyer.mission.swarms import spreading
from lightflyer.numerics.interpolation import Spline

PLACE = Place(0.8, 0.2, 8e8)
FREQUENCY, LENGTH = 2.0 * np.pi / 7200.0, 15e3


def disturbed(one, air, altitude, elapsed):
    """The state of the air with waves, and the still one."""
    still = air.state(altitude, PLACE)
    return one.disturb(still, altitude, PLACE, elapsed), still


@pytest.fixture
def single():
    """One wave whose air moves to the north at latitude 45.8°."""
    zeros = np.zeros(1)
    north = np.array([[-np.sin(0.8) * np.cos(0.2)], [-np.sin(0.8) * np.sin(0.2)], [np.cos(0.8)]])
    wavenumber = 2.0 * np.pi / LENGTH
    return Waves(
        np.array([FREQUENCY]), np.array([wavenumber]), np.ones(1), zeros, north,
        np.array([1.0 / (wavenumber * 7e3)]),
    )  # fmt: skip


def test_air_keeps_its_potential_temperature_as_it_rises(single, lit_air):
    """Air of 220 K that the vertical wind has lifted has cooled by g/c_p, as N is 0.0204 there."""
    times = np.linspace(0.0, 7200.0, 721)
    found = [disturbed(single, lit_air(), 70e3, time) for time in times]
    up = np.array([float(state.wind.up) for state, _ in found])
    warmer = np.array([float(state.temperature - still.temperature) for state, still in found])
    lifted = cumulative_trapezoid(up, times, initial=0.0)
    slope, rest = np.polyfit(lifted, warmer, 1)
    np.testing.assert_allclose(warmer, slope * lifted + rest, atol=2e-3 * np.ptp(warmer))
    assert slope == pytest.approx(-9.6 / 1004.0, rel=0.05)


def test_a_wave_moves_along_the_ground_as_linear_theory_has_it(single, lit_air):
    air = lit_air(lf.environment.UniformWind(-60.0, 1.0, 0.1))
    for time in (0.0, 900.0, 4000.0):
        state, _ = disturbed(single, air, 70e3, time)
        along, up = float(state.wind.north) - 1.0, float(state.wind.up) - 0.1
        assert abs(along) > 0.1
        assert along * FREQUENCY == pytest.approx(0.02 * up, rel=1e-9)
        assert float(state.wind.east) == pytest.approx(-60.0)


def test_pressure_carries_the_warmer_air_above(single, lit_air, monkeypatch):
    """dp'/p = τ dz/H, for a wave that does not grow."""
    monkeypatch.setattr(air, "temperature_by_gravity_waves", lambda altitude: 4.0)
    heights = np.linspace(70e3, 70e3 + LENGTH, 401)
    found = [disturbed(single, lit_air(), height, 500.0) for height in heights]
    warmer = np.array([state.temperature / still.temperature - 1.0 for state, still in found])
    denser = np.array([state.pressure / still.pressure - 1.0 for state, still in found])
    expected = cumulative_trapezoid(warmer, heights, initial=0.0) / 7e3
    assert np.ptp(denser) == pytest.approx(
        2.0 * 4.0 / 220.0 * LENGTH / (2.0 * np.pi * 7e3), rel=1e-3
    )
    np.testing.assert_allclose(denser - denser[0], expected, atol=1e-4 * np.ptp(denser))


def test_sizes_of_waves_are_those_of_the_climatology():
    """Temperature and vertical wind over ten thousand flights beside their spectra."""
    drawn = draw_waves(10_000, 1.0, seed=2)
    still = lf.Earth().state(80e3, PLACE)
    state = drawn.disturb(still, 80e3, PLACE, 3e4)
    degrees = 0.5 * 16.0 ** (60.0 / 80.0)  # 0.5 K at 20 km and 8 K at 100 km
    buoyancy, longest, shortest = 0.02, 2.0 * np.pi / 86_400.0, 2.0 * np.pi / 1800.0

    def spectrum(power):
        whole = quad(lambda w: w ** (-5.0 / 3.0), longest, buoyancy)[0]
        return quad(lambda w: w ** (power - 5.0 / 3.0), longest, shortest)[0] / whole

    tides = (0.4 / 0.6) ** 2
    expected = degrees * np.sqrt(spectrum(0.0) + tides)
    assert np.std(state.temperature) == pytest.approx(expected, rel=0.05)
    size = float(still.gravity) / buoyancy**2 * degrees / float(still.temperature)
    faster = spectrum(2.0) + 0.5 * tides * (1.0 + 4.0) * longest**2
    assert np.std(state.wind.up) == pytest.approx(size * np.sqrt(faster), rel=0.05)
    # half of it along each of two directions
    along = buoyancy * size * np.sqrt(0.5 * (spectrum(0.0) + tides))
    for part in (state.wind.east, state.wind.north):
        assert np.std(part) == pytest.approx(along, rel=0.06)


@pytest.fixture
def fly(closed_form_disk):
    """Fly an ensemble of a disk of 2 mm, or disperse it as a swarm."""

    def flown(function=lf.fly, blows=None, duration="3 h", every="1 h", members=6, **errors):
        return function(
            closed_form_disk(0.002), lf.Earth(wind=blows), lf.FreeMolecular(), duration=duration,
            release=lf.Release("75 km", latitude=45.0, longitude=0.0, time=0.0), every=every,
            ensemble=lf.mission.Ensemble(members, drag=0.0, **errors),
        )  # fmt: skip

    return flown


def test_waves_of_a_flight_are_its_own_and_come_with_the_ensemble(fly):
    flown, calm = (fly(every="30 min", members=3, **errors) for errors in ({}, {"waves": 0.0}))
    np.testing.assert_array_equal(flown.altitude, calm.altitude)
    assert np.ptp(calm.ensemble_altitude.values, axis=0).max() < 1e-6
    assert np.ptp(flown.ensemble_altitude.values[:, -1]) > 50.0
    assert "gravity waves of ± 2 K at 60 km" in flown.attrs["assumptions"]
    assert "waves: none" in calm.attrs["assumptions"]


def test_waves_of_mars_are_not_known(film):
    unasked = lf.mission.Ensemble(members=2)
    assert unasked.waves_over(lf.Mars()) == 0.0
    setup = lf.Setup(lf.Disk(film, radius=1e-3), lf.Mars(), lf.FreeMolecular())
    told = assumptions_of(setup, lf.mission.Level(), unasked, None)
    assert "waves: none; those of Mars are not known" in told


def test_a_swarm_at_one_place_flies_as_one_flyer(fly):
    """All members are the same flyer; released 10 km apart they meet other phases."""
    air = {"blows": lf.environment.UniformWind(50.0), "duration": "6 h"}
    near = fly(**air, together=True, wind=10.0)
    altitude = near.ensemble_altitude.values
    assert np.ptp(altitude, axis=0).max() < 1.0
    assert np.abs(altitude[0] - near.altitude.values).max() > 50.0
    assert "the same for all members" in near.attrs["assumptions"]
    apart = fly(**air, together=True, distance=10e3)
    assert np.std(apart.ensemble_altitude.values[:, -1]) > 5.0


def test_a_wave_that_goes_north_comes_later_to_who_is_north(single, lit_air):
    """By a quarter of its period at a quarter of its length; who is east meets it as the middle."""
    length, air = LENGTH * 0.02 / FREQUENCY, lit_air()
    north, east = single.headings[:, 0], np.array([-np.sin(0.2), np.cos(0.2), 0.0])
    here = np.array([np.cos(0.8) * np.cos(0.2), np.cos(0.8) * np.sin(0.2), np.sin(0.8)])
    angle = 0.25 * length / 6371e3

    def up(elapsed, along):
        middle = here * np.cos(angle) - along * np.sin(angle)
        path = Spline.through(np.arange(4.0) * 1e3, np.tile(middle, (4, 1)))
        state, _ = disturbed(replace(single, middle=path), air, 70e3, elapsed)
        return float(state.wind.up)

    alone = [float(disturbed(single, air, 70e3, time)[0].wind.up) for time in (900.0, -900.0)]
    assert abs(alone[0] - alone[1]) > 0.01
    assert up(900.0, north) == pytest.approx(alone[1], abs=0.02 * abs(alone[1]))
    assert up(900.0, east) == pytest.approx(alone[0], abs=0.02 * abs(alone[0]))


def test_batches_of_a_swarm_meet_one_weather(fly, monkeypatch):
    monkeypatch.setattr(spreading, "MEMBERS", 3)
    found = fly(lf.mission.disperse_ensemble, together=True, wind=10.0)
    assert float(found.altitude_spread[-1]) < 1.0
    assert float(found.distance[-1]) < 100.0


def test_tides_that_the_environment_has_are_not_counted_twice():
    """What is left out is what differs between draws of one seed."""
    earth = lf.Earth(atmosphere=lf.environment.GlobalNRLMSIS(f107=150.0, ap=4.0))
    assert tides_of(earth) == Tides(winds=False, warmth=True)
    assert tides_of(lf.Earth()) == Tides()
    whole, part = (draw_waves(50, 1.0, 0, known) for known in (Tides(), Tides(True, True)))
    still = lf.Earth().state(80e3, PLACE)

    def spread(waves):
        state = waves.disturb(still, 80e3, PLACE, 3e4)
        return state.temperature, state.wind.up, state.wind.east

    (warmer, up, east), (less, same, slower) = spread(whole), spread(part)
    calm = replace(whole, cosines=whole.cosines * (np.arange(10) < 8),
                   sines=whole.sines * (np.arange(10) < 8))  # fmt: skip
    warmth, _, wind = spread(calm)
    np.testing.assert_allclose(same, up, rtol=1e-12)
    np.testing.assert_allclose(less, warmth, rtol=1e-12)
    np.testing.assert_allclose(slower, wind, atol=1e-9)
    assert np.std(warmer) > np.std(less)
    assert np.abs(east - slower).max() > 1.0
