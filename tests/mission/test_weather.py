"""Missions in winds of files of which only a window is in memory, and where data end."""

import os

import numpy as np
import pytest
import xarray as xr

import lightflyer as lf
from lightflyer.config.designs import as_design
from lightflyer.environment import GriddedWind, UniformWind, WindBeyondData
from lightflyer.environment.wind import store
from lightflyer.mission.fleet import describe_work
from lightflyer.mission.report.events import Event, at_event, read_events
from lightflyer.mission.report.summary import summarise

FILM = lf.FilmProperties(4e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
START = np.datetime64("2026-06-21T00:00", "ns")
ALTITUDES = np.arange(20.0, 61.0, 4.0)


def truth(altitude, hours, latitude, longitude):
    """Wind towards east and north [m/s]; altitude in km, angles in radians."""
    across = np.cos(latitude)
    east = across * (20.0 + altitude + 10.0 * np.sin(2.0 * longitude) + hours)
    return east, across * 40.0 * np.cos(longitude) + 0.0 * altitude


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    hours, north, east = np.arange(0.0, 25.0, 2.0), np.arange(-90.0, 91.0, 2.5), 2.5
    east = np.arange(0.0, 360.0, east)
    axes = np.meshgrid(hours, ALTITUDES, np.radians(north), np.radians(east), indexing="ij")
    names, unit = ("time", "altitude", "latitude", "longitude"), {"units": "m/s"}
    u, v = truth(axes[1], axes[0], *axes[2:])
    times = START + (3600 * hours).astype(int) * np.timedelta64(1, "s")
    coordinates = {"time": times, "altitude": ("altitude", ALTITUDES, {"units": "km"})}
    coordinates |= {"latitude": north, "longitude": east}
    data = xr.Dataset({"u": (names, u, unit), "v": (names, v, unit)}, coordinates)
    file = tmp_path_factory.mktemp("weather") / "wind.nc"
    data.to_netcdf(file, engine="h5netcdf")
    return file


def fly(path, *, hour=1, altitude="50 km", duration="10 h", beyond=None, **more):
    wind = GriddedWind.from_file(path)
    wind = wind if beyond is None else WindBeyondData(wind, beyond)
    release = lf.Release(altitude, latitude=78.0, longitude=-3.0, time=f"2026-06-21T{hour:02d}:00Z")
    disk = lf.Disk(FILM, radius=0.001)  # climbs by a kilometre an hour
    return lf.fly(
        disk, lf.Earth(wind=wind), lf.FreeMolecular(), release=release, duration=duration,
        every="10 min", **more,
    )  # fmt: skip


@pytest.fixture
def both(path, monkeypatch):
    """A flight with all of the file in memory, and with windows of it."""

    def fly_both(**given):
        whole = fly(path, **given)
        windows, read = [], store.WindStore._read

        def watched(self, tabulate):
            windows.append([len(nodes) for nodes in self._window])
            read(self, tabulate)

        monkeypatch.setattr(store, "KEPT", 3000)
        monkeypatch.setattr(store.WindStore, "_read", watched)
        parts = fly(path, **given)
        assert np.prod(windows[-1]) < 0.1 * 13 * 73 * 144
        return whole, parts

    return fly_both


CHOICE = lf.mission.Shaded(
    lf.mission.ChooseWind(lf.mission.Circle(78.0, 0.0, "300 km"), "25 km", "59 km", width="30 km")
)


@pytest.mark.parametrize(
    ("given", "names"),
    [
        ({"duration": "3 h"}, "latitude wind_east wind_north temperature"),
        # it goes on beyond the data
        (
            {"duration": "6 h", "altitude": "58 km", "beyond": UniformWind(20.0)},
            "latitude wind_east",
        ),
        # who chooses its wind sees all levels
        (
            {"duration": "3 h", "attitude": CHOICE},
            "light_share temperature event_temperature",
        ),
    ],
)
def test_a_flight_through_a_window_is_the_flight(both, given, names):
    whole, parts = both(**given)
    assert whole.attrs["end"].startswith("is still aloft at the end of its time")
    for name in ("altitude", "longitude", *names.split()):
        np.testing.assert_allclose(parts[name], whole[name], rtol=1e-10, atol=1e-10)
    if "attitude" in given:
        assert np.ptp(whole.light_share.values) > 0.01  # by the wind elsewhere
    if "beyond" in given:
        assert float(whole.altitude[-1]) > 60e3
        return
    hours = (parts.time.values - START) / np.timedelta64(1, "h")
    place = np.radians(parts.latitude.values), np.radians(parts.longitude.values)
    east, north = truth(parts.altitude.values / 1e3, hours, *place)
    np.testing.assert_allclose(parts.wind_east, east, atol=0.1)
    np.testing.assert_allclose(parts.wind_north, north, atol=0.1)


def test_an_ensemble_through_a_window_is_the_ensemble_and_ends_where_the_file_does(both):
    ensemble = lf.mission.Ensemble(members=8, wind=10.0, time=1800.0, distance=9e3)
    whole, parts = both(ensemble=ensemble, hour=21, duration="5 h")
    assert "time after the data" in parts.attrs["end"]
    assert float(parts.end_elapsed) == pytest.approx(3 * 3600.0, abs=1.0)
    for name in ("altitude", "latitude", "longitude", "end_elapsed", "end_longitude"):
        ours, theirs = parts[f"ensemble_{name}"], whole[f"ensemble_{name}"]
        np.testing.assert_allclose(ours, theirs, rtol=1e-10, atol=1e-10)
    assert np.ptp(parts.ensemble_end_elapsed.values) > 1800.0
    np.testing.assert_array_equal(parts.ensemble_end_reason, whole.ensemble_end_reason)


def test_flights_that_need_more_of_a_file_than_fits_say_what_to_do(path, monkeypatch):
    monkeypatch.setattr(store, "KEPT", 3000)
    monkeypatch.setattr(store, "LARGEST_WINDOW", 11 * 6 * 10 * 10)
    assert (
        fly(path, duration="2 h").attrs["end"].startswith("is still aloft at the end of its time")
    )
    with pytest.raises(lf.ConfigurationError, match=r"points of the wind \(13 times, 11 levels, "):
        fly(path, duration="22 h")


def test_a_mission_says_where_another_wind_took_over(path):
    flown = fly(path, altitude="57.5 km", beyond=UniformWind(east=-30.0))
    elapsed, altitude, _ = at_event(read_events(flown), Event.OTHER_WIND_BEGINS)
    assert altitude == pytest.approx(59e3, abs=1.0)  # half of each a kilometre below the top
    assert elapsed == pytest.approx(np.interp(59e3, flown.altitude, flown.elapsed), abs=10.0)
    found = summarise(flown)["other_wind"]
    assert found["spans_h"] == [[elapsed / 3600.0, 10.0]]
    assert found["share"] == pytest.approx(1.0 - elapsed / 36000.0)
    assert found["lowest_altitude_km"] == altitude / 1e3
    assert found["highest_altitude_km"] == pytest.approx(float(flown.altitude.max()) / 1e3)
    assert found["wind"] == "-30 m/s east, everywhere"
    assert f"the other wind blew {100 * found['share']:.0f} % of" in lf.mission.describe(flown)
    inside = flown.isel(event=flown.event_kind.values < Event.OTHER_WIND_BEGINS)
    assert summarise(inside)["other_wind"]["share"] == 0.0
    assert "never met on the way" in lf.mission.describe(inside)


def test_flights_in_a_file_that_was_written_anew_are_others(path, monkeypatch):
    """What is kept of an interrupted mission or swarm does not go on in other weather."""
    monkeypatch.setattr(store, "KEPT", 3000)

    def described():
        environment = lf.Earth(wind=GriddedWind.from_file(path))
        return describe_work(as_design(lf.Disk(FILM, 0.001), environment, lf.FreeMolecular()), {})

    first = described()
    assert described() == first
    os.utime(path, ns=(0, 0))
    unlike = {name for name, text in described().items() if first[name] != text}
    assert unlike == {"files of the wind"}
