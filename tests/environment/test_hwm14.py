"""HWM14 without its data file, which is not shipped, and with it where a user has it."""

import os
import struct
from math import factorial

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.special import lpmv

import lightflyer as lf
from lightflyer.environment import HWM14, Place
from lightflyer.environment.wind import hwm14

KNOTS = [0.0] * 4 + [*range(5, 111, 5), 117.5, 130, 140, 155, 170, 200, 250] + [350.0] * 4
LEVELS, TERMS = 30, 800


def write(path, values):
    """A file of the form of hwm123114.bin, with the same amplitudes at every altitude."""
    level = struct.pack("<10i", 2, 8, 2, 2, 8, 3, 2, 8, 0, TERMS) + struct.pack("<800d", *values)
    head = struct.pack("<8i", TERMS, 2, 4, 3, 8, 9, 33, 3) + struct.pack("<37d", *KNOTS)
    path.write_bytes(head + level * LEVELS + struct.pack("<10d", *[0.0] * 10))
    return path


def one(index):
    return np.eye(TERMS)[index]


@pytest.fixture
def path(tmp_path):
    return tmp_path / "hwm123114.bin"


def legendre(n, m, x):
    """Of unit norm, positive at first."""
    scale = np.sqrt((2 * n + 1) / 2 * factorial(n - m) / factorial(n + m))
    return (-1) ** m * scale * lpmv(m, n, x)


@pytest.mark.parametrize("m", [1, 2, 3])
def test_harmonics_are_legendre_functions_and_their_slopes(m):
    theta, step = np.array([0.3, 1.2, 2.8]), 1e-5
    with lf.float64():
        slopes, quotients = hwm14._harmonics(jnp.cos(theta), jnp.sin(theta), m)
    for n in range(m, 9):
        scale = np.sqrt(n * (n + 1))
        low, high = (legendre(n, m, np.cos(theta + s)) for s in (-step, step))
        np.testing.assert_allclose(slopes[:, n - 1], (high - low) / (2 * step) / scale, rtol=1e-7)
        expected = m * legendre(n, m, np.cos(theta)) / np.sin(theta) / scale
        np.testing.assert_allclose(quotients[:, n - 1], expected, rtol=1e-12)


@jax.jit
def derivatives(wind, latitude, longitude):
    """Derivatives of u, v, u cos φ, v cos φ in latitude and longitude at 50 km."""

    def parts(latitude, longitude):
        u, v, _ = wind.velocity(50e3, Place(latitude, longitude, 3e6))
        return jnp.stack([u, v, u * jnp.cos(latitude), v * jnp.cos(latitude)])

    return jax.jacfwd(parts, argnums=(0, 1))(latitude, longitude)


# Where the amplitudes of waves and tides begin. Of each four, two make a wind without
# divergence (from a stream function), two one without curl (from a potential).
@pytest.mark.parametrize("start", [80 + 32, 240 + 20, 540 + 12, 680 + 100])
@pytest.mark.parametrize("kind", range(4))
def test_a_stream_function_has_no_divergence_and_a_potential_no_curl(path, start, kind):
    wind = HWM14(write(path, one(start + kind)))
    with lf.float64():
        in_latitude, in_longitude = map(np.asarray, derivatives(wind, 0.6, 1.1))
    divergence = in_longitude[0] + in_latitude[3]
    curl = in_longitude[1] - in_latitude[2]
    zero, other = (divergence, curl) if kind < 2 else (curl, divergence)
    assert abs(zero) < 1e-12
    assert abs(other) > 1e-3


def test_zonal_mean_has_seasons_in_its_own_order(path):
    # s = 0, n = 2: u; s = 1, n = 1: cosine and sine of u, then of v; s = 2, n = 3: cosine of v
    values = 5.0 * one(2) + 2.0 * one(16) + 3.0 * one(17) + 7.0 * one(18) + 4.0 * one(48 + 8 + 2)
    wind = HWM14(write(path, values))
    latitude, day = 0.7, 100.0
    theta, season = 0.5 * np.pi - latitude, 2.0 * np.pi * (day / 365.2425 + 1.0 / 365.25)
    found = wind.velocity(30e3, Place(latitude, 2.0, day * 86400.0))
    east = -5.0 * np.sin(2 * theta) + np.sin(theta) * (3 * np.sin(season) - 2 * np.cos(season))
    north = -7.0 * np.sin(theta) * np.cos(season) - 4.0 * np.sin(3 * theta) * np.cos(2 * season)
    np.testing.assert_allclose(found, [east, north, 0.0], atol=1e-12)


def test_tides_follow_the_sun_and_waves_stand(path):
    tide, wave = (HWM14(write(path, one(start))) for start in (380, 80))
    quarter = 0.5 * np.pi
    here, later = Place(0.6, 1.1, 0.0), Place(0.6, 1.1 - quarter, 21_600.0)
    season = 21_600.0 / 365.2425 / 86_400.0 * 2.0 * np.pi
    assert tide.velocity(60e3, later) == pytest.approx(tide.velocity(60e3, here), abs=season)
    same = wave.velocity(60e3, here._replace(time=21_600.0))
    assert same == pytest.approx(wave.velocity(60e3, here), abs=season)
    assert tide.velocity(60e3, here).east != pytest.approx(tide.velocity(60e3, later).north)


def test_range_and_files(path, tmp_path):
    wind = HWM14(write(path, one(0)))
    assert wind.describe() == ("wind: HWM14, quiet, without weather, nothing upwards",)
    with pytest.raises(lf.ParameterError, match="altitude above 110 km"):
        wind.velocity(111e3, Place(0.0, 0.0, 0.0))
    with pytest.raises(lf.ConfigurationError, match=r"gone\.bin: cannot be read"):
        HWM14(tmp_path / "gone.bin")
    for content in (b"", b"text" * 100):
        (tmp_path / "other.bin").write_bytes(content)
        with pytest.raises(lf.ConfigurationError, match=r"is not the file hwm123114\.bin"):
            HWM14(tmp_path / "other.bin")


# Published with the model: altitude [km], then wind towards north and east [m/s], quiet, on day
# 150, 12 h UTC, at 45° S, 85° W.
PUBLISHED = np.array(
    [
        [0.0, 0.031, 6.271],
        [25.0, 2.965, 25.115],
        [50.0, -6.627, 96.343],
        [75.0, 2.238, 44.845],
        [100.0, -14.339, 31.627],
    ]
)


@pytest.mark.skipif("LIGHTFLYER_HWM14" not in os.environ, reason="the file is not shipped")
def test_published_values():
    wind = HWM14(os.environ["LIGHTFLYER_HWM14"])
    altitude, north, east = PUBLISHED.T
    place = Place(np.radians(-45.0), np.radians(-85.0), 149.0 * 86400.0)
    found = wind.velocity(altitude * 1e3, place)
    # the year here is 11 minutes shorter
    np.testing.assert_allclose([found.north, found.east], [north, east], atol=0.01)
    # two values that the documentation of another implementation, MATLAB's atmoshwm, prints
    for altitude, latitude, longitude, day, hour, expected in (
        (25e3, -45.0, -85.0, 150, 11.0, (3.2874, 25.8735)),
        (100e3, 50.0, -20.0, 30, 0.0, (-42.9350, -40.3693)),
    ):
        time = (day - 1.0) * 86400.0 + (hour - 12.0) * 3600.0
        found = wind.velocity(altitude, Place(np.radians(latitude), np.radians(longitude), time))
        # here the season goes on during the day
        assert (found.north, found.east) == pytest.approx(expected, abs=0.5)
