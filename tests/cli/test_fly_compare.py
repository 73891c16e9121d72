"""``lightflyer fly --compare`` as a user runs it."""

import json

import numpy as np
import pytest
import xarray as xr

MISSION = """\
[mission]
date = 2026-06-21T12:00:00Z
latitude = "45 deg"
longitude = "10 deg"
altitude = "75 km"
duration = "3 h"
attitude = "level"

[flyer]
diameter = "2 mm"

[film]
areal_density = "1.0 g/m^2"
absorptance = 0.75
emittance = 0.08
tac_top = 0.8
tac_bottom = 0.9

[environment]
atmosphere = "us1976"

[force]
model = "free-molecular"
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    found = tmp_path_factory.mktemp("compare")
    (found / "mission.toml").write_text(MISSION, encoding="utf-8")
    for name, count in (("first", 13), ("second", 5)):
        minutes = np.linspace(0.0, 240.0, count)
        rows = [
            f"{np.datetime64('2026-06-21T12:00:00') + np.timedelta64(round(60 * one), 's')}Z,"
            f"45,{10.0 + one / 600.0},{75000 + 10 * one}"
            for one in minutes
        ]
        text = "\n".join(["datetime,lat,lon,alt", *rows]) + "\n"
        (found / f"{name}.csv").write_text(text, encoding="utf-8")
    return found


@pytest.mark.slow
def test_a_flight_is_laid_beside_tracks(run, folder):
    out = folder / "out"
    tracks = [folder / "first.csv", folder / "second.csv"]
    options = ("--compare", *tracks, "--out", out, "--format", "png")
    code, shown, errors = run("fly", folder / "mission.toml", *options)
    assert code == 0, errors
    # without the folder's name, by whose length lines are broken
    assert "10 of 13 fixes, 3.00 h" in " ".join(shown.split())
    assert "3 of 13 fixes are before the release or after the flight's end" in shown
    assert "what would explain the altitudes" in shown
    assert (out / "comparison.png").stat().st_size > 10_000
    summary = json.loads((out / "mission.json").read_text(encoding="utf-8"))
    with xr.open_dataset(out / "mission.nc", engine="h5netcdf") as found:
        found.load()
    assert found.sizes["measured_track"] == 2
    assert [str(name) for name in found.measured_track_source.values] == list(map(str, tracks))
    one = found.isel(measured_track=0)
    beside = np.isfinite(one.altitude_residual.values)
    flown = np.interp(one.measured_elapsed.values, found.elapsed, found.altitude)
    expected = 75e3 + one.measured_elapsed.values / 6.0 - flown
    np.testing.assert_allclose(one.altitude_residual[beside], expected[beside], atol=2.0)
    last = summary["measured"][0]["residuals"]["altitude"]["last_km"]
    assert last == pytest.approx(expected[beside][-1] / 1e3, abs=2e-3)
    degree = 6371.0 * np.pi / 180.0 * np.cos(np.radians(45.0))
    along = summary["measured"][0]["residuals"]["along"]["last_km"]
    assert along == pytest.approx(0.3 * degree, rel=2e-3)  # there is no wind in the mission
    rows = (out / "comparison.csv").read_text(encoding="utf-8").splitlines()
    assert len(rows) == 1 + 13 + 5
    assert rows[0].startswith("track,time [UTC],measured_elapsed [s],measured_altitude [m]")
    assert rows[-1].endswith(",,,,,,,")  # after the end


def test_mistakes_are_told_before_anything_is_flown(run, folder):
    out = folder / "none"
    for text, said in (("lat,lon,alt\n1,2,3\n", "the column time is missing"),
                       ("time,lat,lon,alt\n2020-01-01T00:00Z,1,2,3\n2020-01-01T01:00Z,1,2,3\n",
                        "none of its fixes, of 2020-01-01 00:00 UTC to"),
                       ("time,lat,lon,alt\n2026-06-21T12:05Z,45,10,75\n2026-06-21T13:00Z,45,9,76\n",
                        "at most 76 m, and the flight begins at 75000 m")):  # fmt: skip
        (folder / "bad.csv").write_text(text, encoding="utf-8")
        options = ("--compare", folder / "bad.csv", "--out", out)
        code, shown, errors = run("fly", folder / "mission.toml", *options)
        assert (code, shown) == (2, "")
        assert said in errors
        assert len(errors.strip().splitlines()) == 1
        assert not out.exists()
    twice = folder / "first.csv", folder / "first.csv"
    code, _, errors = run("fly", folder / "mission.toml", "--compare", *twice)
    assert "has the same data as" in errors
    code, _, errors = run("fly", folder / "mission.toml", "--compare")
    assert (code, errors) == (2, "lightflyer: error: --compare needs a file\n")
