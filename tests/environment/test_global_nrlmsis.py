import jax
import numpy as np
import pymsis
import pytest

import lightflyer as lf
from lightflyer.environment import GlobalNRLMSIS, Place

BOLTZMANN = 1.380649e-23
HEIGHTS = np.array([5.3e3, 31.7e3, 48.1e3, 63.3e3, 76.9e3, 88.2e3, 97.7e3, 109.0e3, 131.3e3])
NOON = np.datetime64("2000-01-01T12:00:00")


@pytest.fixture(scope="module")
def atmosphere():
    return GlobalNRLMSIS(f107=150.0, ap=4.0)


@pytest.fixture(scope="module")
def somewhere():
    """Random places over the sphere and 30 years."""
    rng = np.random.default_rng(11)
    latitude = np.arcsin(rng.uniform(-1.0, 1.0, 80))
    return Place(latitude, rng.uniform(-np.pi, np.pi, 80), rng.uniform(0.0, 30 * 3.15576e7, 80))


def directly(place, heights, f107=150.0, ap=4.0):
    """Temperature, pressure and molar mass of the published program at columns."""
    columns = []
    for latitude, longitude, time in zip(*place, strict=True):
        found = pymsis.calculate(
            [NOON + np.timedelta64(int(time), "s")],
            [np.degrees(longitude)],
            [np.degrees(latitude)],
            heights / 1e3,
            [f107],
            [f107],
            [[ap] * 7],
            version=2.1,
        ).reshape(heights.size, 11)
        number = np.nansum(found[:, 1:10], axis=1)
        mass = found[:, 0] / number
        columns.append(
            [found[:, 10], number * BOLTZMANN * found[:, 10], mass / 28.9644 * 6.02214e26]
        )
    return np.moveaxis(columns, 1, 0)


def test_it_is_the_published_program_at_random_places_and_times(atmosphere, somewhere):
    temperature, pressure, ratio = directly(somewhere, HEIGHTS)
    place = Place(*(part[:, None] for part in somewhere))
    warmer = atmosphere.temperature(HEIGHTS, place) - temperature
    denser = np.log(atmosphere.pressure(HEIGHTS, place) / pressure)
    heavier = atmosphere.molar_mass_ratio(HEIGHTS, place) - ratio
    below = HEIGHTS < 110e3
    # the documented accuracy
    assert np.sqrt(np.mean(warmer[:, below] ** 2)) < 0.12
    assert np.sqrt(np.mean(denser[:, below] ** 2)) < 1.3e-3
    assert np.abs(warmer[:, below]).max() < 1.6
    assert np.abs(denser[:, below]).max() < 0.012
    assert np.abs(warmer).max() < 2.5
    assert np.abs(denser).max() < 0.02
    assert np.abs(heavier).max() < 3e-3


def five(method, altitude, latitude, longitude, time):
    """Call a method with five places at once, for which it is compiled once."""
    altitude, *place = (np.broadcast_to(part, 5) for part in (altitude, latitude, longitude, time))
    return method(altitude, Place(*place))


def test_a_pole_has_one_atmosphere_and_the_date_line_none_of_its_own(atmosphere):
    around = np.linspace(-np.pi, np.pi, 5)
    for pole in (-0.5 * np.pi, 0.5 * np.pi):
        found = five(atmosphere.temperature, 85e3, pole, around, 3e8)
        np.testing.assert_allclose(found, found[0], rtol=1e-6)
    found = five(atmosphere.pressure, 70e3, 0.9, around, 3e8)
    assert found[0] == pytest.approx(found[-1], rel=1e-13)
    assert found[0] != pytest.approx(found[2], rel=1e-3)


def test_slopes_are_continuous_across_a_pole(atmosphere):
    def over_the_pole(angle):
        over = angle > 0.5 * np.pi
        latitude = jax.numpy.where(over, np.pi - angle, angle)
        return atmosphere.temperature(85e3, Place(latitude, 0.4 + np.pi * over, 3e8))

    with lf.float64():
        sides = 0.5 * np.pi + np.array([-1e-7, 1e-7])
        before, after = np.asarray(jax.vmap(jax.grad(over_the_pole))(sides))
    assert before == pytest.approx(after, rel=1e-4)


def test_derivatives_in_altitude_place_and_time(atmosphere):
    def log_pressure(altitude, latitude, longitude, time):
        place = Place(latitude, longitude, time)
        return jax.numpy.log(atmosphere.pressure(altitude, place))

    here, steps = (71e3, 0.8, 2.0, 5e8), (10.0, 1e-4, 1e-4, 10.0)
    with lf.float64():
        slopes = jax.grad(log_pressure, argnums=(0, 1, 2, 3))(*here)
    for number, step in enumerate(steps):
        aside = np.zeros((4, 5))
        aside[number, :2] = -step, step
        low, high = np.log(five(atmosphere.pressure, *(np.array(here)[:, None] + aside)))[:2]
        assert float(slopes[number]) == pytest.approx((high - low) / (2.0 * step), rel=1e-5)


def test_earth_takes_it_by_place(atmosphere):
    earth = lf.Earth(atmosphere=atmosphere)
    night = earth.state(100e3, Place(0.2, 0.0, 43_200.0))
    day = earth.state(100e3, Place(0.2, 0.0, 0.0))
    assert night.temperature != pytest.approx(day.temperature, abs=1.0)
    assert day.gas.specific_gas_constant > 1.01 * lf.gas.AIR.specific_gas_constant
    with pytest.raises(lf.ConfigurationError, match="needs one of them: fly a mission"):
        earth.state(70e3)
    with pytest.raises(lf.ParameterError, match="altitude"):
        earth.state(151e3, Place(0.2, 0.0, 0.0))


def test_impossible_activity():
    with pytest.raises(lf.ParameterError, match="f107"):
        GlobalNRLMSIS(f107=0.0, ap=4.0)
    with pytest.raises(lf.ParameterError, match="ap"):
        GlobalNRLMSIS(f107=150.0, ap=500.0)
