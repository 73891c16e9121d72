"""``lightflyer spread`` as a user runs it."""

import json

import pytest
import xarray as xr

MISSION = """\
[mission]
date = 2026-06-21T12:00:00Z
latitude = "45 deg"
longitude = "10 deg"
altitude = "75 km"
duration = "2 h"
every = "30 min"

[mission.station]
radius = "40 km"

[mission.ensemble]
members = 3
wind_uncertainty = "8 m/s"

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


@pytest.fixture
def mission(write):
    return lambda *changes: write(MISSION, "mission.toml", *changes)


def test_a_swarm_is_spread_and_kept(prints, mission, tmp_path):
    out = tmp_path / "swarm"
    shown = prints("spread", mission(), "--out", out, "--format", "png")
    assert "within 40 km of 45° N, 10° E" in shown
    summary = json.loads((out / "spread.json").read_text(encoding="utf-8"))
    assert summary["members"] == 3
    assert summary["flying"]["share"] == 1.0
    (inside,) = summary["inside"].values()
    with xr.open_dataset(out / "spread.nc", engine="h5netcdf") as dataset:
        assert float(dataset.inside[0, 0]) == 1.0
        assert float(dataset.inside[0, -1]) == inside["share"]
    assert (out / "spread.png").stat().st_size > 300
    kept = next(out.glob("members/batch-*"))
    when = kept.stat().st_mtime_ns
    again = prints("spread", mission(), "--out", out, "--format", "png", "--json")
    assert json.loads(again) == summary
    assert kept.stat().st_mtime_ns == when  # nothing is flown again


@pytest.mark.parametrize(("change", "options", "said"), [
    (("[mission.ensemble]\nmembers = 3\nwind_uncertainty = \"8 m/s\"\n", ""), (),
     "add that section"),
    (("[flyer]", '[mission.launches]\nevery = "1 h"\ncount = 2\n\n[flyer]'), (),
     "take out [mission.launches]"),
    (("[flyer]", "[flyer]"), ("--members", "0"), "0 members is none"),
    (("[flyer]", "[flyer]"), ("--scheduler", "nowhere"), "nowhere"),
])  # fmt: skip
def test_what_is_no_swarm_is_refused_in_one_line(refuses, mission, change, options, said):
    errors = refuses("spread", mission(change), *options)
    (line,) = [line for line in errors.splitlines() if "error" in line]
    assert said in line
