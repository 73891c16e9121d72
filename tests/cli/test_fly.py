"""``lightflyer fly`` as a user runs it."""

import csv
import json
import xml.etree.ElementTree as ET
from itertools import pairwise

import numpy as np
import pytest
import xarray as xr

import lightflyer as lf
from lightflyer.mission import fleet

MISSION = """\
[mission]
date = 2026-06-21T12:00:00Z
latitude = "45 deg"
longitude = "170 deg"
altitude = "75 ± 0.2 km"
duration = "30 h"
every = "5 min"
lowest_altitude = "1 km"
highest_altitude = "120 km"

[mission.ensemble]
members = 6
wind_uncertainty = "10 m/s"
vertical_wind_uncertainty = "0.02 m/s"

[mission.launches]
every = "6 h"
count = 2

[flyer]
diameter = "2 mm"

[film]
areal_density = "1.0 ± 0.02 g/m^2"
absorptance = 0.75
emittance = 0.08
tac_top = 0.8
tac_bottom = 0.9
highest_temperature = "700 K"

[environment]
atmosphere = "us1976"

[environment.wind]
kind = "data"
file = "wind.nc"

[force]
model = "free-molecular"
"""


# the stated flyer alone
ALONE = (
    (MISSION[MISSION.index("[mission.ensemble]") : MISSION.index("[flyer]")], ""),
    ('"75 ± 0.2 km"', '"75 km"'), ('"1.0 ± 0.02 g/m^2"', '"1.0 g/m^2"'),
)  # fmt: skip


def wind(path, days):
    """Air that turns about the axis, with 20 m/s at 45°, in data that end."""
    latitude = np.arange(-90.0, 91.0, 15.0)
    shape = (2, 2, latitude.size, 4)
    east = 20.0 * np.cos(np.radians(latitude)) / np.cos(np.radians(45.0))
    hours = np.array(["2026-06-20", "2026-06-20"], "datetime64[h]")
    hours[1] += np.timedelta64(round(24 * days), "h")
    dims = ("time", "altitude", "latitude", "longitude")
    about = {"units": "m s-1"}
    dataset = xr.Dataset(
        {
            "u": (dims, np.broadcast_to(east[:, None], shape), about),
            "v": (dims, np.zeros(shape), about),
        },
        coords={
            "time": hours.astype("datetime64[ns]"),
            "altitude": ("altitude", [0.0, 200e3], {"units": "m"}),
            "latitude": ("latitude", latitude, {"units": "degrees_north"}),
            "longitude": ("longitude", [0.0, 90.0, 180.0, 270.0], {"units": "degrees_east"}),
        },
    )
    dataset.to_netcdf(path, engine="h5netcdf")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    found = tmp_path_factory.mktemp("mission")
    wind(found / "wind.nc", 5.0)
    return found


@pytest.fixture
def fly(run, folder):
    """Run a mission whose file differs from :data:`MISSION`; returns code, output, errors."""

    def command(*changes, options=("--json",)):
        text = MISSION
        for old, new in changes:
            assert old in text
            text = text.replace(old, new, 1)
        path = folder / "mission.toml"
        path.write_text(text, encoding="utf-8")
        return run("fly", path, *options)

    return command


def test_what_a_rocket_lets_go_lands(fly, folder):
    out = folder / "landed"
    changes = (
        ('altitude = "75 ± 0.2 km"', 'altitude = "1.4 ± 0.02 km"'), ('"30 h"', '"6 h"'),
        ('[mission.launches]\nevery = "6 h"\ncount = 2\n', ""),
        ("members = 6", 'members = 25\nvelocity_uncertainty = "2 m/s"'),
        ("[flyer]", '[mission.release]\neast = "50 m/s"\n\n[mission.landing]\nobjects = 1000\n'
                    "flight_levels = [30, 40]\n\n[flyer]"),
    )  # fmt: skip
    code, shown, errors = fly(*changes, options=("--out", out, "--format", "png"))
    assert code == 0, errors
    assert "50 % land within" in shown
    assert (out / "landing.png").stat().st_size > 3000
    summary = json.loads((out / "mission.json").read_text(encoding="utf-8"))
    assert summary["landing"]["landed"]["share"] == 1.0
    assert summary["release"]["speed_m_s"] == pytest.approx(50.0)
    table = (out / "mission-ends.csv").read_text(encoding="utf-8")
    rows = list(csv.DictReader(table.splitlines()))
    below = [float(row["below_fl40 [s]"]) - float(row["below_fl30 [s]"]) for row in rows]
    assert len(below) == 26
    assert min(below) > 0.0  # 914 m and 1219 m
    content = json.loads((out / "mission.geojson").read_text(encoding="utf-8"))
    areas = [one for one in content["features"] if one["geometry"]["type"] == "MultiPolygon"]
    assert [one["properties"]["holds"] for one in areas] == [0.5, 0.95]


def test_a_mission_writes_what_it_says(fly, folder):
    out = folder / "out"
    code, shown, errors = fly(options=("--out", out, "--format", "png"))
    assert code == 0, errors
    names = ["mission.nc", "mission.csv", "mission.kml", "mission.geojson", "mission.json"]
    names += [
        f"{name}.png" for name in ("altitude", "ground_track", "flight", "survival", "launches")
    ]
    for name in names:
        assert name in shown
        assert (out / name).stat().st_size > 300
    summary = json.loads((out / "mission.json").read_text(encoding="utf-8"))
    assert summary["end_reason"] == "still_flying"
    assert len(summary["nights"]) == 2
    assert summary["ensemble"]["members"] == 6
    assert [launch["delay_h"] for launch in summary["launches"]] == [0.0, 6.0, 12.0]
    assert any("FreeMolecular" in text for text in summary["assumptions"])
    assert any("wind" in text for text in summary["assumptions"])
    with xr.open_dataset(out / "mission.nc", engine="h5netcdf") as dataset:
        check_dataset(dataset.load())
        check_ends((out / "mission-ends.csv").read_text(encoding="utf-8"), dataset)
        check_trajectories(dataset)
        check_geojson(json.loads((out / "mission.geojson").read_text(encoding="utf-8")), dataset)
    lines = (out / "mission.csv").read_text(encoding="utf-8").splitlines()
    assert lines[0].startswith("time [UTC],elapsed [s],altitude [m],latitude [degree_north]")
    assert len(lines) == 362
    assert lines[1].startswith("2026-06-21T12:00:00.000Z,0,75000,45,170,")
    spaces = {"k": "http://www.opengis.net/kml/2.2", "gx": "http://www.google.com/kml/ext/2.2"}
    document = ET.parse(out / "mission.kml").getroot()
    pieces = document.findall(".//gx:MultiTrack/gx:Track", spaces)
    coordinates = [[one.text for one in piece.findall("gx:coord", spaces)] for piece in pieces]
    assert sum(map(len, coordinates)) == 361 + 2  # it crosses the date line once
    assert [[len(piece.findall("k:when", spaces))] for piece in pieces] == [
        [len(one)] for one in coordinates
    ]
    assert [coordinates[0][-1][:4], coordinates[1][0][:4]] == ["180.", "-180"]
    assert len(document.findall(".//k:Folder/k:Placemark/k:MultiGeometry", spaces)) == 9
    assert len(document.findall(".//k:Folder/k:Placemark//k:LineString", spaces)) >= 9


def check_ends(text, dataset):
    """A row for the flyer as it is stated, each member and each launch."""
    header, *rows = csv.reader(text.splitlines())
    assert header[2:] == [
        "end_elapsed [s]", "end_altitude [m]", "end_latitude [degree_north]",
        "end_longitude [degree_east]", "end_reason",
    ]  # fmt: skip
    flights = [row[:2] for row in rows]
    members = [["member", str(number)] for number in range(6)]
    assert flights == [["stated", ""], *members, *(["launch", str(number)] for number in range(3))]
    assert float(rows[2][3]) == pytest.approx(float(dataset.ensemble_end_altitude[1]))
    assert float(rows[-1][5]) == pytest.approx(float(dataset.launch_end_longitude[2]))
    names = dataset.launch_end_reason.attrs["flag_meanings"].split()
    assert rows[-1][6] == names[int(dataset.launch_end_reason[2])]


def check_trajectories(dataset):
    """The conventions' chapter 9: each flight has a time and a place of its own."""
    assert dataset.attrs["Conventions"] == "CF-1.11"
    assert dataset.attrs["featureType"] == "trajectory"
    (one,) = [one for one in dataset.variables.values() if "cf_role" in one.attrs]
    assert one.attrs["cf_role"] == "trajectory_id"
    for name, variable in dataset.variables.items():
        along = variable.encoding.get("coordinates", "").split()
        assert set(along) <= set(dataset.variables), name
        if "elapsed" in variable.dims and along:
            axes = [dataset[other].attrs.get("axis") for other in along]
            assert sorted(filter(None, axes))[-3:] == ["X", "Y", "Z"] or "Z" not in axes
            assert {"T", "X", "Y"} <= set(axes), name
    for prefix in ("", "ensemble_", "launch_"):
        known = np.isfinite(dataset[f"{prefix}latitude"].values)
        np.testing.assert_array_equal(~np.isnat(dataset[f"{prefix}time"].values), known)
    since = dataset.launch_time.values[:, 0] - dataset.time.values[0]
    np.testing.assert_array_equal(since / np.timedelta64(1, "h"), [0.0, 6.0, 12.0])
    assert dataset.ensemble_altitude.attrs["standard_name"] == "altitude"
    assert dataset.wind_east.attrs["standard_name"] == "eastward_wind"


def check_geojson(document, dataset):
    """RFC 7946: lines that end at the date line, and go on beyond it."""
    assert document["type"] == "FeatureCollection"
    tracks = [one for one in document["features"] if one["properties"]["what"] == "track"]
    ends = [one for one in document["features"] if one["properties"]["what"] == "end"]
    assert len(tracks) == len(ends) == 1 + 6 + 3
    for track in tracks:
        geometry = track["geometry"]
        several = geometry["type"] == "MultiLineString"
        lines = geometry["coordinates"] if several else [geometry["coordinates"]]
        for line in lines:
            assert len(line) > 1
            assert np.abs(np.diff([place[0] for place in line])).max() < 1.0
        for before, after in pairwise(lines):
            assert [before[-1][0], *before[-1][1:]] == [-after[0][0], *after[0][1:]]
            assert abs(after[0][0]) == 180.0
    assert tracks[0]["geometry"]["type"] == "MultiLineString"
    member = ends[2]
    assert member["properties"] == {
        "what": "end", "flight": "member", "number": 1, "end": "still_flying",
        "end_elapsed_s": 30.0 * 3600.0,
    }  # fmt: skip
    place = [float(dataset[f"ensemble_end_{name}"][1])
             for name in ("longitude", "latitude", "altitude")]  # fmt: skip
    np.testing.assert_allclose(member["geometry"]["coordinates"], place, atol=0.06)


def test_an_interrupted_mission_goes_on(fly, folder, monkeypatch):
    monkeypatch.setattr(fleet, "BATCH", 2)
    changes = [('duration = "30 h"', 'duration = "1 h"'), ("members = 6", "members = 2"),
               ("count = 2", "count = 1")]  # fmt: skip
    code, whole, errors = fly(*changes)
    assert code == 0, errors
    mission = lf.mission.read_mission_file(folder / "mission.toml")
    kept = folder / "resumed" / "flights"
    lf.fly(mission.design, **mission.arguments(), folder=kept)
    (kept / "flights-000003.npz").unlink()  # as an interrupt would leave it
    options = ("--out", folder / "resumed", "--format", "png")
    code, shown, errors = fly(*changes, options=options)
    assert code == 0, errors
    assert "went on where the same command was interrupted" in shown
    assert not kept.exists()
    summary = (folder / "resumed" / "mission.json").read_text(encoding="utf-8")
    assert json.loads(summary) == json.loads(whole)


def check_dataset(dataset):
    """Units everywhere; heat and forces close; the flight crosses the date line."""
    for name, variable in dataset.variables.items():
        assert "long_name" in variable.attrs or name in ("member", "launch"), name
    assert dataset.ensemble_altitude.dims == ("member", "elapsed")
    assert float(dataset.altitude[0]) == pytest.approx(75e3)
    assert np.ptp(dataset.ensemble_altitude.values[:, 0]) > 50.0
    np.testing.assert_allclose(
        dataset.absorbed_power, dataset.gas_power + dataset.radiated_power, rtol=1e-9, atol=1e-18
    )
    # the drag of a level flyer is its lift less its weight, and takes that power
    force = dataset.lift - dataset.weight
    np.testing.assert_allclose(dataset.drag_power, force * dataset.axial_speed, rtol=1e-9)
    assert bool((force * dataset.axial_speed >= 0.0).all())
    # what the forces do along the way is what the altitude gains, by hours
    climbed = np.diff(dataset.altitude)
    seconds = np.diff(dataset.elapsed)
    mean = 0.5 * (dataset.vertical_speed.values[1:] + dataset.vertical_speed.values[:-1])
    assert np.sum(mean * seconds) == pytest.approx(np.sum(climbed), abs=50.0)
    # 20 m/s over the parallel of 45°, with the height of the flyer
    east = np.unwrap(dataset.longitude, period=360.0)
    assert dataset.longitude.min() < -170.0
    assert east[-1] - east[0] == pytest.approx(27.0, abs=0.5)


@pytest.mark.parametrize(
    ("changes", "reason", "words"),
    [
        ([('"1 km"', '"74.5 km"')], "lowest_altitude", "reached the lowest altitude"),
        ([('"120 km"', '"75.8 km"')], "highest_altitude", "reached the highest altitude"),
        ([("2026-06-21T12", "2026-06-24T06")], "no_data", "time"),
    ],
)
def test_a_mission_that_ends_early_keeps_what_was_flown(fly, changes, reason, words):
    code, shown, errors = fly(*changes, *ALONE)
    assert code == 0, errors
    summary = json.loads(shown)
    assert summary["end_reason"] == reason
    assert words in summary["end"]
    assert 0.1 < summary["duration_h"] < 30.0
    ends = {"lowest_altitude": 74.5, "highest_altitude": 75.8}
    if reason in ends:
        assert summary["end_altitude_km"] == pytest.approx(ends[reason], abs=1e-6)
    else:
        assert summary["duration_h"] == pytest.approx(18.0, abs=1e-3)


def test_a_mission_in_the_polar_night_says_that_it_finds_no_light(fly):
    code, shown, errors = fly(('"45 deg"', '"-85 deg"'), *ALONE)
    assert code == 0, errors
    summary = json.loads(shown)
    assert summary["light_h"] == 0.0
    assert any("never finds light" in text for text in summary["warnings"])


STEERED = """\
attitude = "towards-station"
largest_tilt = "10 deg"

[mission.shading]
rule = "choose-wind"
lowest = "64 km"
highest = "90 km"

[mission.station]
longitude = "171 deg"
radius = "150 km"

[mission.ensemble]"""


def test_a_steered_mission_says_how_long_it_stays_near_its_station(fly, folder):
    out = folder / "steered"
    code, shown, errors = fly(
        ('duration = "30 h"', 'duration = "4 h"'), ("[mission.ensemble]", STEERED),
        ("members = 6", "members = 2"), ('[mission.launches]\nevery = "6 h"\ncount = 2\n', ""),
        options=("--out", out, "--format", "png"),
    )  # fmt: skip
    assert code == 0, errors
    assert "h within 150 km of 45° N, 171° E, leaves it first after" in " ".join(shown.split())
    assert (out / "station.png").stat().st_size > 300
    summary = json.loads((out / "mission.json").read_text(encoding="utf-8"))
    stay = summary["station"]
    assert 0.0 < stay["within_h"] == pytest.approx(stay["left_after_h"])
    assert summary["ensemble"]["within_station_h"]["high"] > stay["within_h"] / 2.0
    assert any("tilted by at most 10° towards 45° N, 171° E" in a for a in summary["assumptions"])
    with xr.open_dataset(out / "mission.nc", engine="h5netcdf") as dataset:
        inside = dataset.station_distance <= 150e3
        hours = float(inside.sum()) * 300.0 / 3600.0
    assert hours == pytest.approx(stay["within_h"], abs=0.1)


# by what else is changed, before
MISTAKES = {
    (): [
        ('"75 ± 0.2 km"', '"0.5 km"', "mission.toml: release altitude 0.5 km is at or"),
        ('"75 ± 0.2 km"', '"130 km"', "release altitude 130 km is at or above the highest"),
        ('"120 km"', '"2000 km"', "highest altitude 2000 km is outside the atmosphere"),
        ("2026-06-21T12:00:00Z", '"soon"', "mission.toml:2: mission.date"),
        ("2026-06-21T12:00:00Z", "2026-06-21", "2026-06-21 is a day; add the hour"),
        ("2026-06-21T12:00:00Z", "1782043200", "1782043200 is not a date; write it such as"),
        ("2026-06-21T12:00:00Z", "3026-06-21T12:00:00Z", "outside the years 1950 to 2050"),
        ('every = "5 min"', 'every = "31 h"', "every, 111600 s, is longer than the duration"),
        ('latitude = "45 deg"', 'latitude = "95 deg"', "mission.toml:3: mission.latitude"),
        ('"30 h"', '"30 m"', "mission.toml:6: mission.duration"),
        ('every = "5 min"', "tilt_share = 0.5", "tilt_share has no effect"),
        ("members = 6", "members = 1", "mission.toml:12: mission.ensemble.members"),
        ("members = 6", "member = 6", "mission.toml:12: mission.ensemble.member is not a key"),
        ("[mission.ensemble]\nmembers = 6", "[mission.swarm]\nmembers = 6", "mission.swarm"),
        ("wind.nc", "nowhere.nc", "nowhere.nc"),
        ('diameter = "2 mm"', "", "mission.toml:20: [flyer] needs diameter"),
    ],
    (('"1 km"', '"50 km"'),): [
        ("[flyer]", "[mission.landing]\nobjects = 9\n\n[flyer]", "the mission ends at 50 km"),
    ],
    (("[mission.ensemble]", STEERED),): [
        ('"choose-wind"', '"choose"', 'mission.shading.rule = "choose" is unknown'),
        ('lowest = "64 km"', "", "[mission.shading] needs lowest"),
        ('lowest = "64 km"', 'lowest = "95 km"', "highest of the winds to choose from"),
        ('lowest = "64 km"', 'lowest = "64 ± 1 km"', 'lowest = "64 ± 1 km": takes no'),
        ('"10 deg"', '"120 deg"', "must be between 0 and 90 deg"),
        ('"towards-station"', '"level"', "largest_tilt has no effect beside attitude"),
        ('"150 km"', '"150"', 'mission.station.radius: "150" has no unit'),
    ],
    (("[mission]\n", '[mission]\nattitude = "level"\n'),): [
        ('latitude = "45 deg"', 'latitude = "45 ± 1 deg"', "is position_uncertainty in ["),
        ('[flyer]\n', '[flyer]\ntilt = "10 deg"\n', 'tilt has no effect beside attitude = "level"'),
    ],
}  # fmt: skip


@pytest.mark.parametrize(
    ("before", "old", "new", "said"),
    [(before, *mistake) for before, mistakes in MISTAKES.items() for mistake in mistakes],
)
def test_a_mistake_is_one_line_with_its_place(fly, before, old, new, said):
    code, shown, errors = fly(*before, (old, new))
    assert (code, shown) == (2, "")
    assert said in errors
    assert "mission.toml:" in errors or old in ("wind.nc", "[flyer]"), errors
    assert len(errors.splitlines()) <= 3
