"""Public reports of atmospheres: tables and closed formulas of the standards."""

import numpy as np
import pymsis
import pytest

import lightflyer as lf
from lightflyer.environment import NRLMSIS, US1976, GlobalNRLMSIS, Place
from lightflyer.environment.wind.heights import altitude_of
from lightflyer.gas.air import AIR
from lightflyer.gas.base import mean_free_path

# [USSA1976] by its own text: geopotential heights [km], temperatures [K], slopes [K/km]
BASES = (0.0, 11.0, 20.0, 32.0, 47.0, 51.0, 71.0, 84.852)
SLOPES = (-6.5, 0.0, 1.0, 2.8, 0.0, -2.8, -2.0)
GMR = 34.163195  # g M/R [K/km]
RADIUS = 6356.766  # [km]


def layered(altitude_km):
    """Temperature [K] and pressure [Pa] at a geometric altitude."""
    height = RADIUS * altitude_km / (RADIUS + altitude_km)
    temperature, pressure = 288.15, 101325.0
    for base, top, slope in zip(BASES, BASES[1:], SLOPES, strict=False):
        rise = min(height, top) - base
        above = temperature + slope * rise
        pressure *= (
            (temperature / above) ** (GMR / slope) if slope else np.exp(-GMR * rise / temperature)
        )
        temperature = above
        if height <= top:
            break
    return temperature, pressure


@pytest.mark.parametrize(
    ("altitude", "temperature", "pressure"),
    [
        # https://github.com/openrocket/openrocket/issues/2731: the geometric altitude was taken
        # for the geopotential one
        (32.0, 228.490, 889.064),
        (70.0, None, 5.2209),
        (80.0, None, 1.05247),
        (11.0, 216.774, None),  # https://github.com/AeroPython/PyFME/issues/110: not 216.65 K
    ],
)
def test_altitudes_are_geometric(altitude, temperature, pressure):
    air = US1976()
    by_hand = layered(altitude)
    if temperature:
        assert float(air.temperature(1e3 * altitude)) == pytest.approx(temperature, abs=6e-4)
        assert by_hand[0] == pytest.approx(temperature, abs=2e-3)
    if pressure:
        assert float(air.pressure(1e3 * altitude)) == pytest.approx(pressure, rel=2e-5)
        assert by_hand[1] == pytest.approx(pressure, rel=2e-4)


def test_no_nan_above_the_troposphere():
    """https://github.com/sksat/trochia/pull/73: one slope for all heights is below 0 K at 44 km."""
    altitudes = np.arange(0.0, 80.1, 1.0)
    expected = np.array([layered(one) for one in altitudes])
    air = US1976()
    assert np.asarray(air.temperature(1e3 * altitudes)) == pytest.approx(expected[:, 0], rel=1e-5)
    assert np.asarray(air.pressure(1e3 * altitudes)) == pytest.approx(expected[:, 1], rel=1e-4)


def test_beyond_a_model_is_not_drawn_on():
    """https://github.com/RocketPy-Team/RocketPy/pull/1056: below sea level a spline went on."""
    with pytest.raises(lf.ParameterError, match="-1500"):
        lf.Earth().state(-1500.0)


DATE = np.datetime64("2016-03-04T02:00")


def of_pymsis(north, east, kilometres):
    found = pymsis.calculate(
        DATE, east, north, kilometres, f107s=150.0, f107as=150.0, aps=[[4.0] * 7]
    )
    return np.squeeze(found)


def test_places_go_into_a_model_in_degrees():
    """https://github.com/ssmichael1/satkit/pull/150: latitude and longitude went in in radians."""
    air = GlobalNRLMSIS(f107=150.0, ap=4.0)
    place = Place.at(DATE, 68.0, -133.0)
    state = lf.Earth(atmosphere=air).state(75e3, place)
    expected = of_pymsis(68.0, -133.0, 75.0)
    assert float(state.temperature) == pytest.approx(
        float(expected[pymsis.Variable.TEMPERATURE]), rel=2e-3
    )


@pytest.mark.parametrize("kilometres", [50.0, 75.0])
def test_units_of_a_models_density(kilometres):
    """https://github.com/space-physics/msise00/issues/14: kg/m³, not g/m³ nor g/cm³."""
    air = NRLMSIS(DATE.item(), latitude=40.0, longitude=-75.0, f107=150.0, ap=4.0)
    density = float(air.pressure(1e3 * kilometres)) / (
        287.053 * float(air.temperature(1e3 * kilometres))
    )
    expected = of_pymsis(40.0, -75.0, kilometres)[pymsis.Variable.MASS_DENSITY]
    assert density == pytest.approx(float(expected), rel=5e-3)


def test_mean_free_path():
    """https://github.com/erf-model/ERF/issues/3593: 3.8e-7 m came out at sea level.

    The standard's own, of hard spheres, is 6.6332e-8 m; viscosity gives 6.4e-8 m with [USSA1976]'s
    Sutherland formula. https://github.com/firemodels/fds/issues/13926 lost a factor of two of it.
    """
    viscosity = 1.458e-6 * 288.15**1.5 / (288.15 + 110.4)
    expected = viscosity / 101325.0 * np.sqrt(0.5 * np.pi * 8314.32 / 28.9644 * 288.15)
    assert expected == pytest.approx(6.6332e-8, rel=0.06)
    assert float(mean_free_path(101325.0, 288.15, AIR)) == pytest.approx(expected, rel=0.01)


@pytest.mark.parametrize("latitude", [0.0, 45.0, 80.0, 90.0])
@pytest.mark.parametrize(("top", "error"), [(48e3, 3.0), (80e3, 20.0)])
def test_altitudes_of_a_geopotential(latitude, top, error):
    """https://github.com/ESCOMP/CAM/issues/987 and https://github.com/stcorp/harp/issues/21

    Gravity weakens with height and grows towards the poles: by Somigliana's formula, and the
    radius of the ellipsoid with its centrifugal part, integrated by small steps.
    """
    sine = np.sin(np.radians(latitude)) ** 2
    ground = 9.7803253359 * (1.0 + 0.00193185265241 * sine) / np.sqrt(1.0 - 0.00669437999013 * sine)
    flattening, centrifugal = 1.0 / 298.257223563, 0.00344978650684
    heights = np.linspace(0.0, top, 8001)
    free = (
        1.0
        - 2.0 / 6378137.0 * (1.0 + flattening + centrifugal - 2.0 * flattening * sine) * heights
        + 3.0 / 6378137.0**2 * heights**2
    )
    geopotential = np.trapezoid(ground * free, heights)
    assert altitude_of(geopotential, np.radians(latitude)) == pytest.approx(top, abs=error)
    # in geopotential metres 80 km are 1 km lower
    assert geopotential / 9.80665 < top - 9e-8 * top**2
