"""Public reports of the sun's place: values of others' programs, or a formula of its own.

`environment/test_sun.py` has the cases of https://github.com/millerlp/Solarlib/issues/1,
https://github.com/mourner/suncalc/issues/49 and 70,
https://github.com/cpucycle/astrotime/issues/1 and https://github.com/janrg/MeeusSunMoon/issues/25;
`core/test_clock.py` those of https://github.com/pvlib/pvlib-python/issues/1932, 1948, 1958, 2667,
https://github.com/mourner/suncalc/issues/107 and https://github.com/kylebarron/suncalc-py/issues/14.
"""

import numpy as np
import pandas as pd
import pytest

import lightflyer as lf
from lightflyer.environment import EarthSun, Place


def sun_at(time, north, east):
    """Elevation without refraction, and azimuth from north over east [deg]."""
    sun = EarthSun().position_above(Place.at(time, north, east))
    return 90.0 - np.degrees(sun.zenith_angle), np.degrees(sun.azimuth) % 360.0


def by_hand(time, north, east):
    """The same by the Astronomical Almanac's short formula, good to 0.02°; ``time``: of pandas."""
    days = (pd.DatetimeIndex(time).as_unit("s").asi8 - 946_728_000) / 86_400.0
    mean, anomaly = np.radians(280.460 + 0.9856474 * days), np.radians(357.528 + 0.9856003 * days)
    longitude = mean + np.radians(1.915) * np.sin(anomaly) + np.radians(0.020) * np.sin(2 * anomaly)
    tilt = np.radians(23.439 - 4e-7 * days)
    ascension = np.arctan2(np.cos(tilt) * np.sin(longitude), np.cos(longitude))
    declination = np.arcsin(np.sin(tilt) * np.sin(longitude))
    turned = np.radians((280.46062 + 360.98564737 * days + east) % 360.0) - ascension
    lat = np.radians(north)
    up = np.sin(lat) * np.sin(declination) + np.cos(lat) * np.cos(declination) * np.cos(turned)
    southward = np.sin(lat) * np.cos(turned) - np.tan(declination) * np.cos(lat)
    azimuth = np.degrees(np.arctan2(np.sin(turned), southward)) + 180.0
    return np.degrees(np.arcsin(up)), azimuth % 360.0


@pytest.mark.parametrize(
    ("time", "north", "east", "elevation", "azimuth"),
    [
        # https://github.com/pingswept/pysolar/issues/67: a local time, which is an hour ahead
        ("2018-03-12T06:55+01:00", 46.95, 7.47, 0.135, 95.03),
        # https://github.com/gregseth/suncalc-php/issues/22: 28.28° and -14.27° came out
        ("2023-10-30T09:40:30+01:00", 47.0, 18.0, 24.352, 150.187),
        # https://github.com/mourner/suncalc/issues/171: -57.83° from the south
        ("2023-06-21T11:09:23+02:00", 50.121110, 8.768238, None, 180.0 - 57.826),
        # https://github.com/pingswept/pysolar/issues/61: in the afternoon of Massachusetts
        ("2007-02-18T15:13:01-05:00", 42.206, -71.382, 20.37, None),
    ],
)
def test_published_places(time, north, east, elevation, azimuth):
    found = sun_at(time, north, east)
    if elevation is not None:
        assert found[0] == pytest.approx(elevation, abs=0.05)  # of 20° refraction lifts 0.05°
    if azimuth is not None:
        assert found[1] == pytest.approx(azimuth, abs=0.1)  # suncalc leaves out small terms
    assert found == pytest.approx(np.ravel(by_hand([pd.Timestamp(time)], north, east)), abs=0.03)


def test_the_pole_has_the_declination():
    """https://github.com/jpb10/SolarCalculator/issues/23: 23:53:46 UTC on 22 March 2023."""
    moment = "2023-03-22T23:53:46Z"
    expected = by_hand([pd.Timestamp(moment)], -90.0, 0.0)[0][0]
    assert -0.9 < expected < -0.8
    assert sun_at(moment, -90.0, 0.0)[0] == pytest.approx(expected, abs=0.02)


def test_no_jump_within_seconds():
    """https://github.com/cosinekitty/astronomy/issues/23: +6.75° for a second in 1750."""
    times = pd.date_range("1750-11-21T00:46:00Z", periods=20, freq="s", unit="s")
    elevation, _ = sun_at(times, 15.0, 75.0)
    assert np.abs(np.diff(elevation)).max() < 0.005


def test_latitude_and_longitude_exchanged():
    """https://github.com/brandon-rhodes/pyephem/issues/250: the sun never rose in Mexico."""
    with pytest.raises(lf.ParameterError, match=r"-99\.1332 is not between -90 and 90"):
        Place.at("2022-12-18T18:00Z", -99.133221, 19.432441)
    assert sun_at("2022-12-18T18:30Z", 19.432441, -99.133221)[0] > 40.0
