"""Landings beside closed forms, the standard atmosphere, and a Monte Carlo of NumPy and SciPy."""

import json

import numpy as np
import pytest
from scipy.interpolate import RegularGridInterpolator
from scipy.optimize import brentq

import lightflyer as lf
from lightflyer.environment.base import Wind
from lightflyer.environment.wind.base import AbstractWind
from lightflyer.mission.report import landing
from lightflyer.mission.report.landing import (
    Landings,
    Map,
    _holding,
    landings_of,
    level_pressure,
    outline,
    size_holding,
)
from lightflyer.mission.report.maps import rings_of, write_geojson

RADIUS = 6_371_008.7714


def cloud(count, seed=0, wide=3e4, long=8e4, turn=0.6):
    points = np.random.default_rng(seed).standard_normal((count, 2)) * [long, wide]
    turned = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    return points @ turned + [2e3, -1e3]


@pytest.mark.parametrize("share", [0.5, 0.95])
def test_an_area_of_gaussian_landings_is_that_of_the_closed_form(share, monkeypatch):
    monkeypatch.setattr(landing, "_RESAMPLES", 100)
    exact = 2.0 * np.pi * 3e4 * 8e4 * np.log(1.0 / (1.0 - share))
    assert size_holding(cloud(200_000), share) == pytest.approx(exact, rel=0.01)
    found = [_holding(cloud(200, seed), share) for seed in range(1, 25)]
    inside = sum(one.low < exact < one.high for one in found)
    assert inside >= 19  # of 24, 95 % of which are expected; fewer have a chance of 0.1 %
    assert np.mean([one.size for one in found]) == pytest.approx(exact, rel=0.05)
    lengths = np.mean([np.linalg.norm(one.axes, axis=0) for one in found], axis=0)
    scale = np.sqrt(-2.0 * np.log(1.0 - share))
    np.testing.assert_allclose(lengths, [8e4 * scale, 3e4 * scale], rtol=0.05)


def test_an_area_holds_its_share_of_further_landings_whatever_they_are(monkeypatch):
    monkeypatch.setattr(landing, "_RESAMPLES", 1)
    generator, held = np.random.default_rng(1), []
    for _ in range(25):  # two clouds, as of day and night
        every = generator.standard_normal((1000, 2))
        every[:, 1] += 6.0 * generator.integers(2, size=1000)
        area, later = _holding(every[:100], 0.95), every[100:]
        away = (later - area.middle) @ np.linalg.inv(area.axes.T)
        held.append(np.mean(np.linalg.norm(away, axis=1) <= 1.0))
    assert np.mean(held) == pytest.approx(0.95, abs=0.015)


def test_a_volume_of_a_gaussian_cloud_is_that_of_the_closed_form():
    points = np.random.default_rng(0).standard_normal((200_000, 3)) * [1e3, 2e3, 3e3]
    reach = np.sqrt(2.3659738843753377)  # chi-squared of three degrees, median
    exact = 4.0 / 3.0 * np.pi * 6e9 * reach**3
    assert size_holding(points, 0.5) == pytest.approx(exact, rel=0.01)


@pytest.mark.parametrize(
    ("latitude", "longitude", "pieces"), [(10.0, 20.0, 1), (-20.0, 179.9, 2), (89.8, 40.0, 1),
                                          (-89.9, 0.0, 1), (90.0, 0.0, 1)]
)  # fmt: skip
def test_areas_are_right_over_date_line_and_poles(latitude, longitude, pieces):
    up = np.radians([latitude, longitude])
    centre = [np.cos(up[0]) * np.cos(up[1]), np.cos(up[0]) * np.sin(up[1]), np.sin(up[0])]
    about = Map(np.array(centre), RADIUS)
    points = cloud(500)
    back = about.plane(*about.places(points))
    np.testing.assert_allclose(back, points, atol=1e-3)
    area = _holding(points, 0.95)
    landings = Landings(np.ones(500, bool), *about.places(points), about, points, (area,))
    rings = rings_of(*outline(landings, area))
    assert len(rings) == pieces
    total = 0.0
    for ring in rings:
        np.testing.assert_array_equal(ring[0], ring[-1])
        assert np.abs(ring[:, 0]).max() <= 180.0
        # Green's theorem on the sphere, along lines that are straight in both angles
        east, north = np.radians(ring).T
        step = np.diff(north)
        mean = np.where(
            np.abs(step) > 1e-12,
            -np.diff(np.cos(north)) / np.where(np.abs(step) > 1e-12, step, 1.0),
            np.sin(north[1:]),
        )
        total -= np.sum(mean * np.diff(east)) * RADIUS**2  # positive anticlockwise
    assert total == pytest.approx(area.size, rel=3e-3)
    share = np.mean(np.sum(((points - area.middle) @ np.linalg.inv(area.axes.T)) ** 2, axis=1) <= 1)
    assert share == pytest.approx(0.95, abs=0.005)


def barometric(altitude):
    """ICAO's standard atmosphere by its layers [Pa]; geopotential altitude [m]."""
    temperature, pressure, begin = 288.15, 101_325.0, 0.0
    for end, lapse in ((11e3, -6.5e-3), (20e3, 0.0), (32e3, 1e-3)):
        top, ratio = min(altitude, end), 9.80665 / 287.05287
        if lapse:
            above = temperature + lapse * (top - begin)
            pressure *= (above / temperature) ** (-ratio / lapse)
            temperature = above
        else:
            pressure *= np.exp(-ratio * (top - begin) / temperature)
        if altitude <= end:
            return pressure, temperature
        begin = end
    raise AssertionError


@pytest.mark.parametrize("level", [10, 100, 245, 600, 1000])
def test_flight_levels_are_pressures_of_the_standard_atmosphere(level):
    assert level_pressure(level) == pytest.approx(barometric(30.48 * level)[0], rel=1e-5)


class Field(AbstractWind):
    """Wind that changes with altitude and place."""

    def velocity(self, altitude, place):
        east = 4.0 + 0.6e-3 * altitude
        north = -6.0 + 8.0 * np.sin(4.0 * place.latitude) + 0.2e-3 * altitude
        return Wind(east, north, 0.0 * altitude)

    def describe(self):
        return ("wind: a field",)


RELEASE = {"latitude": 60.0, "longitude": 165.0, "time": "2026-06-21T12:00Z"}
SPREAD = {"wind": 4.0, "correlation": 30_000.0, "drag": 0.05, "altitude": 300.0, "distance": 2e3}
FLIGHTS = 150
THICKNESS, DISK_RADIUS, TOP = 1e-3, 5e-3, 29e3  # kg/m², m, m
FILM = lf.FilmProperties(THICKNESS, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
DARK = lf.environment.Radiation(0.0)


@pytest.fixture(scope="module")
def landed():
    ensemble = lf.mission.Ensemble(
        FLIGHTS, wind=SPREAD["wind"], wind_correlation_time=SPREAD["correlation"],
        waves=0.0, drag=SPREAD["drag"], altitude=SPREAD["altitude"], distance=SPREAD["distance"],
    )  # fmt: skip
    earth = lf.Earth(radiation=DARK, wind=Field())
    return lf.fly(
        lf.Disk(FILM, DISK_RADIUS), earth, lf.FreeMolecular(), release=lf.Release(TOP, **RELEASE),
        duration="60 h", ensemble=ensemble, landing=lf.mission.Landing(objects=1000),
    )  # fmt: skip


def sinking_speeds(heights, factors):
    """Disks in dense gas by Clift, Grace and Weber, Re 1.5 to 133 [m/s], (heights, factors)."""
    found = np.empty((len(heights), len(factors)))
    for row, height in enumerate(heights):
        geopotential = 6_356_766.0 * height / (6_356_766.0 + height)
        pressure, temperature = barometric(geopotential)
        density = pressure / 287.05287 / temperature
        viscosity = 1.458e-6 * temperature**1.5 / (temperature + 110.4)
        gravity = 9.80665 * (6_356_766.0 / (6_356_766.0 + height)) ** 2
        pull = THICKNESS * np.pi * DISK_RADIUS**2 * gravity
        for column, factor in enumerate(factors):

            def missing(speed, factor=factor, density=density, viscosity=viscosity, pull=pull):
                reynolds = 2.0 * DISK_RADIUS * density * speed / viscosity
                slow = 16.0 * viscosity * DISK_RADIUS * speed
                return factor * slow * (1.0 + 0.138 * reynolds**0.792) - pull

            found[row, column] = brentq(missing, 1e-3, 10.0)
    return found


@pytest.fixture(scope="module")
def monte_carlo():
    """The same descent by NumPy: times, places and times below levels of 1000 flights."""
    count, step, generator = 1000, 600.0, np.random.default_rng(2026)
    heights, factors = np.linspace(0.0, 31.5e3, 64), np.exp(np.linspace(-0.3, 0.3, 13))
    speed = RegularGridInterpolator((heights, factors), sinking_speeds(heights, factors), "cubic")
    factor = np.exp(SPREAD["drag"] * generator.standard_normal(count))
    height = TOP + SPREAD["altitude"] * generator.standard_normal(count)
    moments = np.arange(0.0, 216_000.0, 2.0 * step)
    apart = (moments[:, None] - moments) / SPREAD["correlation"]
    covariance = np.exp(-0.5 * apart**2) + 1e-8 * np.eye(len(moments))
    normal = generator.standard_normal((len(moments), 3 * count))
    errors = (SPREAD["wind"] * np.linalg.cholesky(covariance) @ normal).reshape(-1, 3, count)

    def frame(place):
        north, east = place
        east_way = np.array([-np.sin(east), np.cos(east), 0.0 * east])
        north_way = np.array(
            [-np.sin(north) * np.cos(east), -np.sin(north) * np.sin(east), np.cos(north)]
        )
        return east_way, north_way

    def rate(time, place, height):
        share = min(time / (2.0 * step), len(moments) - 1.001)
        row, part = int(share), share % 1.0
        error = (1.0 - part) * errors[row] + part * errors[row + 1]
        east_way, north_way = frame(place)
        east = 4.0 + 0.6e-3 * height + np.sum(error * east_way, axis=0)
        north = -6.0 + 8.0 * np.sin(4.0 * place[0]) + 0.2e-3 * height
        north = north + np.sum(error * north_way, axis=0)
        square = 1.0 - 0.00669437999 * np.sin(place[0]) ** 2  # ellipsoid of WGS 84
        across = 6_378_137.0 / np.sqrt(square)
        along = across * (1.0 - 0.00669437999) / square
        turned = [north / (along + height), east / ((across + height) * np.cos(place[0]))]
        inside = np.clip(height, 0.0, 31.5e3)
        return np.array(turned), -speed(np.column_stack([inside, factor]))

    place = np.radians([[RELEASE["latitude"]], [RELEASE["longitude"]]]) * np.ones(count)
    shift = SPREAD["distance"] / RADIUS * generator.standard_normal((2, count))
    place += shift / [np.ones(count), np.cos(place[0])]
    end, ended = np.full(count, np.nan), np.full((2, count), np.nan)
    passed = {level: np.full(count, np.nan) for level in (100, 600)}
    for time in np.arange(0.0, 215_000.0, step):
        first, sinks = rate(time, place, height)
        middle = height + 0.5 * step * sinks
        second, sinks = rate(time + 0.5 * step, place + 0.5 * step * first, middle)
        below = height + step * sinks
        there = place + step * second
        for level, when in passed.items():
            edge = 30.48 * level
            edge = 6_356_766.0 * edge / (6_356_766.0 - edge)
            now = (height >= edge) & (below < edge)
            when[now] = time + step * ((height - edge) / (height - below))[now]
        now = (height >= 0.0) & (below < 0.0)
        share = (height / (height - below))[now]
        end[now] = time + step * share
        ended[:, now] = place[:, now] + share * (there - place)[:, now]
        place, height = there, below
    assert np.isfinite(end).all()
    return end, np.degrees(ended), {level: end - when for level, when in passed.items()}


def test_two_days_of_landings_are_those_of_an_independent_monte_carlo(landed, monte_carlo):
    end, (latitude, longitude), below = monte_carlo
    found = landings_of(landed)
    assert found.landed.all()
    assert 30.0 < np.median(end) / 3600.0 < 50.0
    times = landed.ensemble_end_elapsed.values
    theirs = found.map.plane(latitude, longitude)
    error = np.sqrt(1.0 / FLIGHTS + 1.0 / len(end))
    assert np.abs(times.mean() - end.mean()) < 4.0 * error * end.std() + 1e-3 * end.mean()
    assert times.std() / end.std() == pytest.approx(1.0, abs=3.5 * error / np.sqrt(2.0))
    for mine, other in ((found.points, theirs), (found.points**2, theirs**2)):
        gap = np.abs(mine.mean(axis=0) - other.mean(axis=0))
        assert np.all(gap < 4.0 * error * other.std(axis=0))
    for area in found.areas:
        assert area.size == pytest.approx(size_holding(theirs, area.share), rel=0.2)
        assert area.low < size_holding(theirs, area.share) < area.high
    for level, lasted in below.items():
        mine = landed[f"ensemble_below_fl{level}"].values
        gap = np.abs(mine.mean() - lasted.mean())
        assert gap < 4.0 * error * lasted.std() + 1e-3 * lasted.mean()


def test_a_summary_says_what_an_officer_asks(landed):
    told = lf.mission.summarise(landed)["landing"]
    assert told["landed"]["share"] == 1.0
    assert told["landed"]["low"] == pytest.approx(0.025 ** (1.0 / FLIGHTS))  # Clopper and Pearson
    areas = told["areas"]
    assert [area["holds"] for area in areas] == [0.5, 0.95]
    for area in areas:
        density = 1000.0 * area["holds"] / area["area_km2"]
        assert area["objects_per_km2"] == pytest.approx(density)
    assert set(told["below_h"]) == {"FL100", "FL245", "FL600"}
    # a level cloud of normal spread: the mean density in what holds half is 0.66 of the largest
    row = int(np.nanargmax(landed.airspace_share.values))
    names = ("latitude", "longitude", "altitude")
    part = [landed[f"ensemble_{name}"].values[:, row] for name in names]
    known = np.isfinite(part[2]) & (part[2] < 18.35e3)
    north, east = np.radians(part[0][known]), np.radians(np.unwrap(part[1][known], period=360.0))
    flat = np.array([RADIUS * north, RADIUS * np.cos(north.mean()) * east, part[2][known]])
    peak = known.mean() / np.sqrt((2.0 * np.pi) ** 3 * np.linalg.det(np.cov(flat)))
    ratio = told["airspace"]["objects_per_km3"] / (1000.0 * 1e9 * peak)
    assert 0.5 < ratio < 1.0
    speed = float(sinking_speeds([0.0], [1.0])[0, 0])
    reynolds = 2.0 * DISK_RADIUS * speed * 1.225 / 1.7894e-5  # of the standard atmosphere
    assert told["stated_end_reynolds"] == pytest.approx(reynolds, rel=0.01)
    text = lf.mission.describe(landed)
    assert "95 % land within" in text
    assert "time below FL245 [h]" in text


def test_times_below_levels_do_not_hang_on_what_is_kept(landed):
    flown = lf.fly(
        lf.Disk(FILM, DISK_RADIUS), lf.Earth(radiation=DARK), lf.FreeMolecular(),
        release=lf.Release(TOP, **RELEASE), duration="60 h", every="1 min",
    )  # fmt: skip
    for level in ("fl100", "fl245", "fl600"):
        stated = float(flown[f"below_{level}"])
        assert float(landed[f"below_{level}"]) == pytest.approx(stated, rel=1e-3)


def test_geojson_has_the_areas(landed, tmp_path):
    path = tmp_path / "mission.geojson"
    write_geojson(landed, path)
    features = json.loads(path.read_text(encoding="utf-8"))["features"]
    areas = [one for one in features if one["geometry"]["type"] == "MultiPolygon"]
    assert [area["properties"]["holds"] for area in areas] == [0.5, 0.95]
    assert len(areas[1]["geometry"]["coordinates"]) == 2  # cut at the date line


def test_a_mission_far_above_the_ground_says_nothing_of_landings():
    flown = lf.fly(
        lf.Disk(FILM, 1e-3), lf.Earth(), lf.FreeMolecular(), duration="1 h",
        release=lf.Release("75 km", **RELEASE),
    )  # fmt: skip
    assert landings_of(flown) is None
    assert "landing" not in lf.mission.summarise(flown)
