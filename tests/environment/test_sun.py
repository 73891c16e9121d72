"""The sun's place against pvlib's SPA and a planet's geometry."""

import jax
import numpy as np
import pytest
from pvlib import spa

import lightflyer as lf
from lightflyer.environment import (
    EARTH_PLANET,
    EarthSun,
    Place,
    Planet,
    SunPosition,
    TabulatedSun,
)
from lightflyer.environment.light.sun import sun_from_earth, sun_in_sky

J2000 = 946_728_000.0  # 2000-01-01 12:00 UTC in Unix time [s]
CENTURY = 100.0 * 365.25 * 86_400.0


def unit_vector(zenith_angle, azimuth):
    return np.stack(
        [
            np.sin(zenith_angle) * np.cos(azimuth),
            np.sin(zenith_angle) * np.sin(azimuth),
            np.cos(zenith_angle),
        ],
        axis=-1,
    )


def separation(one, other):
    return np.degrees(np.arcsin(np.linalg.norm(np.cross(one, other), axis=-1)))


@pytest.fixture(scope="module")
def random_century():
    """Random places and times from 1950 to 2050, and the sun of SPA there."""
    rng = np.random.default_rng(14)
    count = 400
    time = rng.uniform(-0.5, 0.5, count) * CENTURY
    latitude = np.arcsin(rng.uniform(-1.0, 1.0, count))
    longitude = rng.uniform(-np.pi, np.pi, count)
    unix = time + J2000
    delta_t = spa.calculate_deltat(1970.0 + unix / (365.25 * 86_400.0), 6)
    found = np.array([
        spa.solar_position(np.array([when]), lat, lon, 0.0, 0.0, 12.0, delta, 0.5667)[:, 0]
        for when, lat, lon, delta in zip(
            unix, np.degrees(latitude), np.degrees(longitude), delta_t, strict=True
        )
    ])  # fmt: skip
    distance = spa.earthsun_distance(unix, delta_t, 1)
    return (
        Place(latitude, longitude, time),
        np.radians(found[:, 1]),
        np.radians(found[:, 4]),
        distance,
    )


def test_the_sun_stands_where_spa_has_it(random_century):
    place, zenith_angle, azimuth, distance = random_century
    sun = EarthSun().position_above(place)
    apart = separation(
        unit_vector(sun.zenith_angle, sun.azimuth), unit_vector(zenith_angle, azimuth)
    )
    assert apart.max() < 0.005  # half of it the parallax, which SPA has
    assert np.abs(np.degrees(sun.zenith_angle - zenith_angle)).max() < 0.005
    np.testing.assert_allclose(sun.distance / 149_597_870_700.0, distance, rtol=5e-5)


def test_examples_of_almanacs():
    # [RedaAndreas2004]_ appendix A.5: 17 October 2003, 19:30:30 UTC, 39.742476° N, 105.1786° W
    sun = EarthSun().position_above(Place.at("2003-10-17T19:30:30Z", 39.742476, -105.1786))
    # its elevation before refraction is 39.872046°, from the surface: 8.794" lower at the horizon
    below = 8.794 / 3600.0 * np.sin(sun.zenith_angle)
    assert np.degrees(sun.zenith_angle) + below == pytest.approx(90.0 - 39.872046, abs=1e-3)
    assert np.degrees(sun.azimuth) % 360.0 == pytest.approx(194.34024, abs=0.005)
    # [Meeus1998]_ example 25.a: 13 October 1992, 0 h terrestrial time: declination -7.78507°
    declination = np.degrees(np.arcsin(sun_from_earth(-2636.5 * 86_400.0 - 69.2).direction[2]))
    assert declination == pytest.approx(-7.785, abs=0.002)


def test_derivatives_by_time_and_place(compiled):
    def height(time, latitude, longitude):
        sun = sun_in_sky(sun_from_earth(time), latitude, longitude)
        return np.cos(0.3) * sun.zenith_angle + sun.azimuth

    at = (8.2e8, 0.7, 2.0)
    with lf.float64():
        slopes = compiled(jax.grad(height, argnums=(0, 1, 2)))(*at)
    for axis, step in enumerate((1.0, 1e-6, 1e-6)):
        low, high = (
            height(*(x + sign * step * (i == axis) for i, x in enumerate(at)))
            for sign in (-1.0, 1.0)
        )
        assert float(slopes[axis]) == pytest.approx((high - low) / (2.0 * step), rel=1e-6)


def test_overhead_and_over_the_pole():
    """Nothing special: finite derivatives where azimuth or longitude have no meaning."""
    overhead = SunPosition(np.array([1.0, 0.0, 0.0]), np.array(1.5e11))

    def zenith(latitude):
        return sun_in_sky(overhead, latitude, 0.0).zenith_angle

    with lf.float64():
        assert float(zenith(0.0)) == 0.0
        assert float(jax.grad(zenith)(0.0)) == 0.0
    north = [
        EarthSun().position_above(Place(np.pi / 2.0, longitude, 8.2e8)).zenith_angle
        for longitude in (0.0, 2.0, -2.0)
    ]
    np.testing.assert_allclose(north, north[0], rtol=1e-14)


@pytest.mark.parametrize("azimuth", [0.0, 0.9, np.pi / 2.0])
def test_curvature_is_that_of_the_ellipsoid(azimuth):
    """By Euler's theorem, of the radii of curvature along the meridian and across it."""
    latitude, a, f = 0.8, 6_378_137.0, 1.0 / 298.257223563
    squared = f * (2.0 - f)
    across = a / np.sqrt(1.0 - squared * np.sin(latitude) ** 2)
    along = across * (1.0 - squared) / (1.0 - squared * np.sin(latitude) ** 2)
    radius = 1.0 / (np.cos(azimuth) ** 2 / along + np.sin(azimuth) ** 2 / across)
    assert EARTH_PLANET.curvature_radius(latitude, azimuth) == pytest.approx(radius, rel=1e-5)
    ball = Planet(name="ball", radius=2e6, rotation_rate=1e-4)
    assert ball.curvature_radius(latitude, azimuth) == pytest.approx(2e6, rel=1e-14)


def test_places_from_dates():
    place = Place.at("2026-06-21T14:00:00+02:00", 45.0, -30.0)
    assert place == Place.at(835_315_200.0, 45.0, -30.0)
    assert np.degrees(place.longitude) == pytest.approx(-30.0)
    with pytest.raises(lf.ParameterError, match="latitude = 91"):
        Place.at(0.0, 91.0, 0.0)
    with pytest.raises(lf.ParameterError, match="is not a date"):
        Place.at("midsummer", 45.0, 0.0)


@pytest.mark.parametrize("days", [1.0, 100.0])
def test_a_table_stands_for_the_sun(days):
    start = 8.2e8
    table = TabulatedSun(EarthSun(), EARTH_PLANET.rotation_rate, start, start + days * 86_400.0)
    time = start + np.linspace(0.0, days, 997) * 86_400.0
    found, expected = table.position(time), sun_from_earth(time)
    np.testing.assert_allclose(found.direction, expected.direction, atol=1e-7)
    np.testing.assert_allclose(found.distance, expected.distance, rtol=1e-7)
    assert np.isnan(table.position(start - 1.0).distance)
    assert np.isnan(table.position(time[-1] + 1.0).direction).all()
    with pytest.raises(lf.ParameterError, match="is empty"):
        TabulatedSun(EarthSun(), EARTH_PLANET.rotation_rate, start, start)
