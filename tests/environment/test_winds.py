import re
from pathlib import Path

import jax
import numpy as np
import pymsis
import pytest

import lightflyer as lf
from lightflyer.config.reader import read_flyer_file
from lightflyer.environment import (
    GlobalNRLMSIS,
    GradientWind,
    Place,
    SumOfWinds,
    UniformWind,
)
from lightflyer.environment.wind.gradient import balanced_rotation

ROTATION = 7.292115e-5
NOON = np.datetime64("2000-01-01T12:00:00")


def seconds(date):
    return (np.datetime64(date) - NOON) / np.timedelta64(1, "s")


JANUARY, JULY = map(seconds, ("2023-01-15T12", "2023-07-15T12"))


@pytest.fixture(scope="module")
def gradient():
    return GradientWind(GlobalNRLMSIS(f107=150.0, ap=4.0))


def test_uniform_winds_and_sums():
    wind = SumOfWinds(UniformWind(east="-60 m/s", north=5.0), UniformWind(up=0.05))
    found = wind.velocity(np.array([50e3, 70e3]), Place(0.5, 0.1, 0.0))
    np.testing.assert_array_equal(found, [[-60.0, -60.0], [5.0, 5.0], [0.05, 0.05]])
    assert wind.describe() == (
        "wind: -60 m/s east, 5 m/s north, everywhere",
        "wind: 0.05 m/s up, everywhere",
    )
    assert UniformWind().describe() == ("wind: none",)
    with pytest.raises(lf.ParameterError, match="a wind must be of class AbstractWind, not float"):
        SumOfWinds(3.0)
    with pytest.raises(lf.ParameterError, match="up"):
        UniformWind(up="2 kg")


def test_earth_has_a_wind_where_a_place_is_given():
    earth = lf.Earth(wind=UniformWind(east=30.0))
    assert earth.state(70e3).wind is None
    assert lf.Earth(wind=earth.wind, place=Place(0.1, 0.2, 0.0)).state(70e3).wind is None
    assert earth.state(70e3, Place(0.1, 0.2, 0.0)).wind.east == 30.0
    assert earth.state(70e3).pressure == lf.Earth().state(70e3).pressure


def test_balance_is_that_of_the_equation_of_motion():
    sine = np.array([-0.9, 0.5, 0.99])
    forcing = np.array([3e-10, -4e-10, 5e-10])
    found = balanced_rotation(forcing, sine, ROTATION)
    # ω² sin φ + 2 Ω ω sin φ + F = 0: centrifugal, Coriolis and pressure force by distance
    balance = found**2 * sine + 2.0 * ROTATION * found * sine + forcing
    np.testing.assert_allclose(balance, 0.0, atol=1e-15 * 5e-10 * 1e3)
    assert np.all(found > -ROTATION)  # of the two, the one that is nearly geostrophic
    weak = balanced_rotation(1e-16, 0.5, ROTATION)
    assert weak == pytest.approx(-1e-16 / (2.0 * ROTATION * 0.5), rel=1e-7)
    assert np.isnan(balanced_rotation(1e-8, 0.5, ROTATION))


def level_ellipsoid(latitude, altitude):
    """Geopotential of gravity and rotation [m²/s²]: point mass, oblateness, centrifugal."""
    a, squeezed, mass, oblate = 6378137.0, 6.69437999014e-3, 3.986004418e14, 1.08262982e-3
    normal = a / np.sqrt(1.0 - squeezed * np.sin(latitude) ** 2)
    out = (normal + altitude) * np.cos(latitude)
    up = (normal * (1.0 - squeezed) + altitude) * np.sin(latitude)
    distance = np.hypot(out, up)
    third = 1.5 * (up / distance) ** 2 - 0.5
    attraction = mass / distance * (1.0 - oblate * (a / distance) ** 2 * third)
    return -attraction - 0.5 * (ROTATION * out) ** 2


@pytest.mark.parametrize(("latitude", "altitude"), [(50.0, 60e3), (-35.0, 40e3)])
def test_gradient_wind_from_the_published_program_itself(gradient, latitude, altitude):
    sides, hours = latitude + np.array([-1.0, 1.0]), np.arange(0, 24, 3)
    dates = np.datetime64("2023-07-15") + hours * np.timedelta64(1, "h")
    found = pymsis.calculate(
        dates,
        np.arange(0.0, 360.0, 45.0),
        sides,
        [altitude / 1e3],
        [150.0] * 8,
        [150.0] * 8,
        [[4.0] * 7] * 8,
        version=2.1,
    )
    number, temperature = np.nansum(found[..., 1:10], axis=-1), found[..., 10].astype(float)
    log_pressure = np.log(number.astype(float) * temperature).mean(axis=(0, 1, 3))
    gas_constant = 8.314462 / 28.9644e-3
    push = gas_constant * temperature.mean() * np.diff(log_pressure)[0]
    push += np.diff(level_ellipsoid(np.radians(sides), altitude))[0]
    push /= np.diff(np.radians(sides))[0] * (6371e3 + altitude)
    # u² tan φ / r + 2 Ω u sin φ + push = 0
    sine, tangent = np.sin(np.radians(latitude)), np.tan(np.radians(latitude))
    roots = np.roots([tangent / (6371e3 + altitude), 2.0 * ROTATION * sine, push])
    expected = roots[np.argmin(np.abs(roots))].real
    east, north, up = gradient.velocity(altitude, Place(np.radians(latitude), 1.0, JULY))
    assert east == pytest.approx(expected, abs=1.0)
    assert abs(expected) > 30.0
    assert (north, up) == (0.0, 0.0)


# HWM14, mean over longitude and local time [m/s]: 20, 40, 60, 80 km by latitude, computed from the
# model's data file.
LATITUDES = np.radians([-75.0, -60.0, -45.0, -30.0, 30.0, 45.0, 60.0, 75.0])
HEIGHTS = np.array([20e3, 40e3, 60e3, 80e3])
HWM14 = {
    JANUARY: [
        [-4, 3, 5, -4, 9, 16, 19, 13],
        [-11, -16, -21, -40, 13, 29, 38, 24],
        [-26, -31, -33, -31, 45, 44, 28, 15],
        [-28, -39, -24, -8, 34, 40, 22, -4],
    ],
    JULY: [
        [28, 48, 33, 7, -12, -1, -1, -2],
        [44, 87, 80, 32, -37, -26, -20, -12],
        [21, 53, 70, 54, -42, -45, -41, -32],
        [18, 31, 40, 43, -1, -16, -36, -31],
    ],
}


@pytest.mark.parametrize(("date", "largest"), [(JANUARY, 45.0), (JULY, 22.0)])
def test_gradient_wind_beside_the_zonal_mean_of_hwm14(gradient, date, largest):
    place = Place(LATITUDES, 0.0, date)
    found = np.array([gradient.velocity(height, place).east for height in HEIGHTS])
    beside = found - HWM14[date]
    assert np.sqrt(np.mean(beside**2)) < 15.0
    assert np.mean(np.abs(beside) < 20.0) > 0.75
    assert np.abs(beside).max() < largest  # over the summer mesosphere of the south


def test_gradient_wind_ends_near_the_equator_and_above(gradient):
    near = Place(np.radians(14.9), 0.0, JULY)
    with pytest.raises(lf.ParameterError, match="latitude within 15° of the equator"):
        gradient.velocity(60e3, near)
    with pytest.raises(lf.ParameterError, match="altitude above 100 km"):
        gradient.velocity(101e3, near._replace(latitude=-1.0))
    assert (
        min(gradient.margins(60e3, near).values())
        < 0.0
        < min(gradient.margins(60e3, near._replace(latitude=-0.3)).values())
    )
    with lf.float64():
        traced = jax.jit(lambda latitude: gradient.velocity(60e3, Place(latitude, 0.0, JULY)).east)
        inside, beyond = (float(traced(np.radians(angle))) for angle in (15.01, 14.99))
    assert np.isfinite(inside)
    assert np.isnan(beyond)


def test_gradient_wind_turns_the_air_around_the_pole_like_a_solid(gradient):
    close = np.radians([89.9, 89.8, 90.0])
    east = gradient.velocity(60e3, Place(close, 2.0, JULY)).east
    assert east[1] == pytest.approx(2.0 * east[0], rel=1e-3)
    assert east[2] == pytest.approx(0.0, abs=1e-9)


def test_winds_in_either_precision(gradient):
    wind = SumOfWinds(gradient, UniformWind(east=3.0))

    def east(x):
        return wind.velocity(60e3 * x, Place(0.8 * x, 0.3, JULY)).east

    with lf.float64():
        slope = float(jax.grad(east)(1.0))
        step = 1e-5
        difference = float(east(1.0 + step) - east(1.0 - step)) / (2.0 * step)
    assert slope == pytest.approx(difference, rel=1e-4)
    assert float(jax.grad(east)(1.0)) == pytest.approx(slope, rel=1e-4)


WITH_WIND = """atmosphere = "lu2023"
[environment.wind]
"""


@pytest.mark.parametrize(
    ("section", "said"),
    [
        ('kind = "gale"', r'wind\.kind = "gale" is unknown; choose from uniform, gradient, data'),
        ('upwards = "1 m/s"', r"upwards is not a key of \[environment\.wind\]"),
        ('up = "1 kg"', r'up: "1 kg": unit "kg" is of the wrong kind'),
        ('kind = "gradient"\neast = "1 m/s"', r'east belongs to kind = "uniform"'),
        ('kind = "gradient"', r"give wind\.f107 and wind\.ap, or an atmosphere with them"),
        ('kind = "gradient"\nf107 = 150', r"needs both f107 and ap"),
        ('kind = "data"\nfile = "gone.nc"', r'file = "gone\.nc": cannot be read: No such file'),
        ('kind = "data"', r"\[environment\.wind\] needs file"),
        ('kind = "hwm14"\nfile = "gone.bin"', r"gone\.bin: cannot be read"),
    ],
)
def test_winds_of_a_file_get_one_line_for_a_mistake(flyer_file, section, said):
    path = flyer_file('atmosphere = "lu2023"\nirradiance', f"{WITH_WIND}{section}\n#")
    path.write_text(path.read_text().replace('incidence = "0 deg"\n', ""))
    with pytest.raises(lf.ConfigurationError, match=said) as caught:
        read_flyer_file(path)
    assert "\n" not in str(caught.value)
    assert "flyer.toml" in str(caught.value)


def test_page():
    page = (Path(__file__).parents[2] / "docs" / "winds.md").read_text(encoding="utf-8")
    names = {}
    for block in re.findall(r"```python\n(.*?)```", page, re.DOTALL):
        if "winds.nc" not in block:  # a reader's own file
            exec(block, names)
    state = names["state"]
    assert f"{state.pressure:.2f} Pa, {state.temperature:.0f} K" in page
    shear = lf.Earth(wind=names["Shear"]()).state(70e3, Place(0.7, 0.0, 0.0))
    assert shear.wind.east == pytest.approx(70.0)


def test_winds_of_a_file(flyer_file):
    section = 'kind = "uniform"\neast = "-60 m/s"\nup = "5 ± 2 cm/s"\n'
    path = flyer_file('atmosphere = "lu2023"\nirradiance', f"{WITH_WIND}{section}#")
    path.write_text(path.read_text().replace('incidence = "0 deg"\n', ""))
    file = read_flyer_file(path)
    assert file.uncertainties() == {"environment.wind.up": 0.02}
    wind = file.build().environment.wind
    assert wind.velocity(70e3, Place(0.1, 0.2, 0.0)) == (-60.0, 0.0, 0.05)
