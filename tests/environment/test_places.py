"""Places and altitudes of scripts: dates in arrays, degrees for radians, kilometres for metres."""

import warnings

import jax
import numpy as np
import pandas as pd
import pytest

import lightflyer as lf
from lightflyer.environment import Daylight, Place

SUNNY = lf.Earth(sky=Daylight())
DATES = pd.date_range("2026-06-21 12:00", periods=3, freq="6h")


def zenith(place):
    return np.degrees(SUNNY.state(75e3, place).radiation.zenith_angle)


def test_the_sun_of_an_index_of_dates():
    """https://github.com/pvlib/pvlib-python/pull/1948"""
    each = [zenith(Place.at(f"{date:%Y-%m-%dT%H:%MZ}", 45.0, 10.0)) for date in DATES]
    assert each == pytest.approx([22.92, 79.99, 111.01], abs=0.005)
    assert zenith(Place.at(DATES, 45.0, 10.0)) == pytest.approx(each, rel=1e-12)
    elsewhere = DATES.tz_localize("UTC").tz_convert("Asia/Tokyo")
    assert zenith(Place.at(elsewhere, 45.0, 10.0)) == pytest.approx(each, rel=1e-12)


def test_a_unix_time_is_no_time_since_2000():
    with pytest.warns(lf.ParameterWarning, match="in the year 2056: .* give datetime.from"):
        Place.at(1.78e9, 45.0, 10.0)
    assert Place.at(8.4e8, 45.0, 10.0).time == 8.4e8


def test_lists_of_other_lengths():
    with pytest.raises(lf.ParameterError, match=r"latitude of shape \(3,\), longitude of shape"):
        Place.at("2026-06-21T12:00Z", [45.0, 46.0, 47.0], [10.0, 20.0])


@pytest.mark.parametrize(
    "make",
    [
        lambda: Place(45.0, 0.1, 0.0),
        lambda: Place(0.8, -120.5, 0.0),
        lambda: Place(np.array([0.1, 45.0]), 0.1, 0.0),
        lambda: Place(0.1, 0.1, 0.0)._replace(latitude=-90.0),
    ],
)
def test_degrees_are_no_radians(make):
    """https://github.com/StevenSamirMichael/satkit/pull/150"""
    with pytest.raises(lf.ParameterError, match=r"Place.at\(date, latitude, longitude\) takes deg"):
        make()


def test_places_that_are_one():
    here = Place.at("2026-06-21T12:00Z", 90.0, 360.0)
    assert here == Place(0.5 * np.pi, 2.0 * np.pi, here.time)
    slopes = jax.grad(lambda place: place.latitude * place.longitude)(Place(0.7, 0.1, here.time))
    assert isinstance(slopes, Place)


@pytest.mark.parametrize("altitude", [72, [60.0, 72.0], np.linspace(60.0, 90.0, 4)])
def test_kilometres_are_warned_of(altitude):
    with pytest.warns(lf.ParameterWarning, match='for kilometres write "(72|90) km"'):
        lf.Earth().state(altitude)


@pytest.mark.parametrize("altitude", [0.0, "72 m", 72e3, [0.0, 90.0, 90e3]])
def test_other_altitudes_are_not(altitude):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        lf.Earth().state(altitude)


def test_kilometres_of_a_release_and_of_a_prediction(disk):
    with pytest.warns(lf.ParameterWarning, match='write "75 km"'):
        lf.Release(75, latitude=45.0, longitude=10.0, time=DATES[0])
    with pytest.warns(lf.ParameterWarning, match='write "72 km"'):
        lf.predict(disk, lf.Earth(), lf.Lu2023(), at=[72])


@pytest.mark.parametrize(
    ("parts", "said"),
    [
        ((lf.Earth(), lf.Kinetic), r"model .* not the class Kinetic itself; write Kinetic\("),
        ((lf.Earth(), "kinetic"), 'model must be of class AbstractForceModel, not the text "kin'),
        ((lf.Earth, lf.Kinetic()), r"environment .* not the class Earth itself; write Earth\("),
        ((lf.Kinetic(), lf.Earth()), "environment must be of class .*, not Kinetic"),
    ],
)
@pytest.mark.parametrize("function", [lf.predict, lf.Setup, lf.levitation_band])
def test_a_class_or_a_name_is_no_object(disk, function, parts, said):
    with pytest.raises(lf.ParameterError, match=said):
        function(disk, *parts)


def test_a_sun_over_a_planet_is_a_thousand_watts_and_said():
    with pytest.warns(lf.ParameterWarning, match=r'"1 sun": a sun is 1000 W/m².* 1361 W/m²'):
        lf.FlyerFile(
            flyer={"diameter": "2 cm"},
            film={"areal_density": "1 g/m^2", "absorptance": 0.75, "emittance": 0.08,
                  "tac_top": 0.8, "tac_bottom": 0.9},
            environment={"irradiance": "1 sun"},
        )  # fmt: skip
