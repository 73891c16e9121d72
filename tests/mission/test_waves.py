"""Waves of the air beside closed forms of linear theory, and what they do to flights."""

import jax
import numpy as np
import pytest
from scipy.integrate import cumulative_trapezoid, quad

import lightflyer as lf
from lightflyer.environment.base import Place
from lightflyer.mission.path import waves
from lightflyer.mission.path.waves import Waves, draw_waves

PLACE = Place(0.8, 0.2, 8e8)
FREQUENCY, LENGTH = 2.0 * np.pi / 7200.0, 15e3


def disturbed(one, air, altitude, elapsed):
    """The state of the air with waves, and the still one."""
    with lf.float64():
        still = air.state(altitude, PLACE)
        return jax.tree.map(np.asarray, (one.disturb(still, altitude, PLACE, elapsed), still))


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
    monkeypatch.setattr(waves, "temperature_by_gravity_waves", lambda altitude: 4.0)
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
    with lf.float64():
        still = lf.Earth().state(80e3, PLACE)
        state = jax.vmap(lambda one: one.disturb(still, 80e3, PLACE, 3e4))(drawn)
        still, state = jax.tree.map(np.asarray, (still, state))
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


def test_waves_of_a_flight_are_its_own_and_come_with_the_ensemble(closed_form_disk):
    def fly(**errors):
        return lf.fly(
            closed_form_disk(0.002), lf.Earth(), lf.FreeMolecular(), duration="3 h", every="30 min",
            release=lf.Release("75 km", latitude=45.0, longitude=0.0, time=0.0),
            ensemble=lf.mission.Ensemble(members=3, drag=0.0, **errors),
        )  # fmt: skip

    flown, calm = fly(), fly(waves=0.0)
    np.testing.assert_array_equal(flown.altitude, calm.altitude)
    assert np.ptp(calm.ensemble_altitude.values, axis=0).max() < 1e-6
    assert np.ptp(flown.ensemble_altitude.values[:, -1]) > 50.0
    assert "gravity waves of ± 2 K at 60 km" in flown.attrs["assumptions"]
    assert "waves: none" in calm.attrs["assumptions"]


def test_waves_of_mars_are_not_known():
    ensemble = lf.mission.Ensemble(members=2, waves=1.0)
    with pytest.raises(lf.ParameterError, match="over Mars leave waves out"):
        ensemble.waves_over(lf.Mars())
    assert lf.mission.Ensemble(members=2).waves_over(lf.Mars()) == 0.0
