"""Public reports of the sun's place: values of others' programs.

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
from lightflyer.environment.light.sun import sun_from_earth


def sun_at(time, north, east):
    """Elevation without refraction, and azimuth from north over east [deg]."""
    sun = EarthSun().position_above(Place.at(time, north, east))
    return 90.0 - np.degrees(sun.zenith_angle), np.degrees(sun.azimuth) % 360.0


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


def test_the_pole_has_the_declination():
    """https://github.com/jpb10/SolarCalculator/issues/23: 23:53:46 UTC on 22 March 2023."""
    moment = "2023-03-22T23:53:46Z"
    north = sun_from_earth(Place.at(moment, -90.0, 0.0).time).direction[2]
    assert 0.8 < np.degrees(np.arcsin(north)) < 0.9
    assert sun_at(moment, -90.0, 0.0)[0] == pytest.approx(-np.degrees(np.arcsin(north)), abs=0.01)


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
