"""Public reports of weather files and winds: fields in closed form, on small grids.

`environment/test_gridded_wind.py` has the cases of
https://github.com/RocketPy-Team/RocketPy/issues/24 and 19,
https://github.com/jonsowman/cusf-standalone-predictor/issues/77,
https://github.com/nextsimhub/nextsimdg/issues/888 and
https://github.com/dbekaert/RAiDER/issues/806.
"""

import numpy as np
import pytest
import xarray as xr

from lightflyer.environment import US1976, GriddedWind, Place

START = np.datetime64("2026-06-21T00:00", "ns")
TIMES = START + np.arange(2) * np.timedelta64(6, "h")
LEVELS = np.arange(20.0, 81.0, 20.0)  # [km]
NORTH = np.arange(-90.0, 91.0, 5.0)
DIMS = ("time", "altitude", "latitude", "longitude")


def weather(field, east, north=NORTH, levels=LEVELS):
    """A file of u and v [m/s]; ``field`` of altitude [km], latitude and longitude [deg]."""
    u, v = field(*np.meshgrid(levels, north, east, indexing="ij"))
    shape = (len(TIMES), len(levels), len(north), len(east))
    return xr.Dataset(
        {name: (DIMS, np.broadcast_to(one, shape).copy(), {"units": "m s-1"})
         for name, one in (("u", u), ("v", v))},
        coords={"time": TIMES, "altitude": ("altitude", levels, {"units": "km"}),
                "latitude": north, "longitude": east},
    )  # fmt: skip


def wind_at(wind, north, east, altitude=50e3):
    found = wind.velocity(altitude, Place.at(START, north, east))
    return np.array([np.asarray(found.east), np.asarray(found.north)])


POSITIVE = np.arange(0.0, 360.0, 5.0)


@pytest.mark.parametrize("pole", [90.0, -90.0])
def test_a_polar_row_that_is_one_pair_of_numbers(pole):
    """https://github.com/nextsimhub/nextsimdg/issues/368: the rows of poles in ERA5.

    https://github.com/slcs-jsc/mptrac/issues/32: parcels stuck to the pole. Across it blow 20 m/s.
    """

    def across(altitude, north, east):
        sign = np.sign(north)
        u, v = -20.0 * np.sin(np.radians(east)), -20.0 * sign * np.cos(np.radians(east))
        polar = np.abs(north) == 90.0
        return np.where(polar, 3.0, u), np.where(polar, -7.0, v)

    wind = GriddedWind(weather(across, POSITIVE))
    places = np.copysign([90.0, 89.9, 88.0, 86.0], pole)
    found = wind_at(wind, places, np.full(4, 37.0))
    expected = across(0.0, places[2], 37.0)  # the same as far as the pole
    np.testing.assert_allclose(found, np.tile(expected, (4, 1)).T, atol=0.1)


def test_levels_out_of_order():
    """https://github.com/dbekaert/RAiDER/issues/568: levels of ERA5 came in another order."""

    def field(altitude, north, east):
        return altitude + 0.0 * north + 0.0 * east, 0.0 * altitude * north * east

    data = weather(field, POSITIVE).isel(altitude=[2, 0, 3, 1])
    assert wind_at(GriddedWind(data), 10.0, 10.0, 47e3)[0] == pytest.approx(47.0, rel=1e-6)


def test_winds_are_interpolated_not_their_directions():
    """https://github.com/firelab/windninja/issues/645: half way from 350° to 10° is no south wind.

    https://github.com/RocketPy-Team/RocketPy/issues/253: the same between two levels.
    """

    def field(altitude, north, east):
        comes_from = np.radians(np.where(altitude < 50.0, 350.0, 10.0) + 0.0 * north + 0.0 * east)
        return -10.0 * np.sin(comes_from), -10.0 * np.cos(comes_from)

    wind = GriddedWind(weather(field, POSITIVE, levels=np.array([40.0, 60.0])))
    u, v = wind_at(wind, 45.0, 10.0, 50e3)
    assert u == pytest.approx(0.0, abs=1e-6)
    assert v == pytest.approx(-10.0 * np.cos(np.radians(10.0)), rel=1e-6)


@pytest.mark.parametrize("by", ["altitude", "geopotential"])
def test_levels_that_almost_coincide(by):
    """https://github.com/mitre/FMACM/issues/7: at 28,000 ft −1400 kt came out, and 571 kt here."""
    feet = np.array([10e3, 20e3, 30e3, 31e3, 31004.0])
    knots = np.array([23.92, 126.31, 189.96, 221.55, 211.88])
    metres = 0.3048 * feet
    data = weather(
        lambda level, *_: (np.interp(level, feet, knots), 0.0 * level),
        POSITIVE, NORTH[5:-5], feet,
    )  # fmt: skip
    data = data.assign_coords(altitude=("altitude", metres, {"units": "m"}))
    if by == "geopotential":
        air = US1976()
        geopotential = 9.80665 * 6356766.0 * metres / (6356766.0 + metres)
        pressure = np.asarray(air.pressure(metres)) / 100.0
        data = data.rename(altitude="pressure").assign_coords(
            pressure=("pressure", pressure, {"units": "hPa"})
        )
        data["z"] = data.u * 0.0 + xr.DataArray(geopotential, dims="pressure")
        data["z"].attrs["units"] = "m**2/s**2"
    wind = GriddedWind(data, US1976())
    # 45° N: the geopotential counts from the ellipsoid there
    heights = np.linspace(metres[0] + 30.0, metres[-1] - 30.0, 2001)
    found, _ = wind_at(wind, np.full(2001, 45.0), np.full(2001, 3.0), heights)
    assert found == pytest.approx(np.interp(heights, metres, knots), abs=7.0)
