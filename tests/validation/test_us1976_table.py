"""The US Standard Atmosphere 1976 against its published tables and two independent packages."""

import warnings

import ambiance
import fluids.atmosphere
import numpy as np
import pytest

import lightflyer as lf

TOLERANCE = 5e-5

# U.S. Standard Atmosphere, 1976 (NOAA-S/T 76-1562), tables I and III: geometric altitude [m],
# kinetic temperature [K], pressure [Pa], density [kg/m3], viscosity [Pa s], mean free path [m];
# None where not transcribed. Digits as printed.
PUBLISHED = [
    (0, 288.150, 1.01325e5, 1.2250, 1.7894e-5, 6.6332e-8),
    (5000, 255.676, 5.4048e4, 7.3643e-1, 1.6282e-5, 1.1034e-7),
    (11000, 216.774, 2.2700e4, 3.6480e-1, 1.4223e-5, 2.2274e-7),
    (20000, 216.650, 5.5293e3, 8.8910e-2, 1.4216e-5, 9.1393e-7),
    (30000, 226.509, 1.1970e3, 1.8410e-2, 1.4753e-5, 4.4137e-6),
    (50000, 270.650, 7.9779e1, 1.0269e-3, 1.7037e-5, None),
    (70000, 219.585, 5.2209, 8.2829e-5, None, None),
    (80000, 198.639, 1.0524, 1.8458e-5, None, None),
    (86000, 186.87, 3.7338e-1, 6.958e-6, None, None),
]

# The same, table I above 86 km: altitude [m], temperature [K], pressure [Pa], molar mass.
PUBLISHED_ABOVE = [
    (90e3, 186.87, 1.8359e-1, 28.91),
    (100e3, 195.08, 3.2011e-2, 28.40),
    (110e3, 240.00, 7.1042e-3, 27.27),
    (120e3, 360.00, 2.5382e-3, 26.20),
    (150e3, 634.39, 4.5422e-4, 24.10),
    (200e3, 854.56, 8.4736e-5, 21.30),
    (300e3, 976.01, 8.7704e-6, 17.73),
    (500e3, 999.24, 3.0236e-7, 14.33),
    (1000e3, 1000.00, 7.5138e-9, 3.94),
]


@pytest.mark.parametrize("row", PUBLISHED, ids=lambda row: f"{row[0]}m")
def test_published_rows_to_86_km(row):
    altitude, *expected = row
    atmosphere = lf.environment.US1976()
    quantities = ("temperature", "pressure", "density", "viscosity", "mean_free_path")
    for name, value in zip(quantities, expected, strict=True):
        if value is not None:
            found = getattr(atmosphere, name)(float(altitude))
            # half a unit of the last printed digit comes on top of the tolerance
            assert found == pytest.approx(value, rel=TOLERANCE + 2e-5), name


@pytest.mark.parametrize("row", PUBLISHED_ABOVE, ids=lambda row: f"{row[0] / 1e3:g}km")
def test_published_rows_above_86_km(row):
    altitude, temperature, pressure, molar_mass = row
    atmosphere = lf.environment.US1976()
    assert atmosphere.temperature(altitude) == pytest.approx(temperature, rel=3e-5)
    assert atmosphere.pressure(altitude) == pytest.approx(pressure, rel=2e-5)
    ratio = atmosphere.molar_mass_ratio(altitude)
    assert 28.9644 * ratio == pytest.approx(molar_mass, rel=1e-3)


def test_rows_left_out_of_the_interpolation_above_86_km():
    # table I rows that the package's table does not hold
    heights = np.array([170e3, 220e3, 260e3])
    published = np.array([2.1210e-4, 5.0149e-5, 1.9894e-5])
    np.testing.assert_allclose(lf.environment.US1976().pressure(heights), published, rtol=1e-3)


def test_every_hundred_metres_against_fluids():
    altitudes = np.arange(0.0, 80e3, 100.0)
    other = [fluids.atmosphere.ATMOSPHERE_1976(z) for z in altitudes]
    atmosphere = lf.environment.US1976()
    for name, theirs in (("temperature", "T"), ("pressure", "P"), ("density", "rho")):
        expected = [getattr(row, theirs) for row in other]
        np.testing.assert_allclose(getattr(atmosphere, name)(altitudes), expected, rtol=TOLERANCE)
    viscosity = [row.mu for row in other]
    np.testing.assert_allclose(atmosphere.viscosity(altitudes), viscosity, rtol=TOLERANCE)


def test_every_hundred_metres_against_ambiance():
    altitudes = np.arange(0.0, 80e3, 100.0)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        other = ambiance.Atmosphere(altitudes)
    atmosphere = lf.environment.US1976()
    np.testing.assert_allclose(atmosphere.temperature(altitudes), other.temperature, rtol=TOLERANCE)
    np.testing.assert_allclose(atmosphere.pressure(altitudes), other.pressure, rtol=2 * TOLERANCE)
    # ICAO's Avogadro constant is 7e-5 larger than the standard's
    mean_free_path = other.mean_free_path * (6.02257e23 / 6.022169e23)
    np.testing.assert_allclose(
        atmosphere.mean_free_path(altitudes), mean_free_path, rtol=2 * TOLERANCE
    )


def test_kinetic_differs_from_molecular_scale_temperature_above_80_km():
    # fluids gives the molecular-scale temperature; the ratio of table 8 turns it into kinetic
    for altitude, ratio in ((83e3, 0.999870), (85e3, 0.999694), (86e3, 0.999579)):
        molecular_scale = fluids.atmosphere.ATMOSPHERE_1976(altitude).T
        found = lf.environment.US1976().temperature(altitude)
        assert found == pytest.approx(molecular_scale * ratio, rel=1e-6)
