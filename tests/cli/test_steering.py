"""``lightflyer drift``, ``stability`` and ``swarm`` as a user runs them."""

import csv
import json

import numpy as np
import pytest
import xarray as xr

COMMANDS = {
    "drift": ((), "fastest"),
    "stability": (("--rod", "2 mm", "--string", "1 cm"), "growth_rate"),
    "swarm": (("--payload", "0.1 g", "--tether", "7e-9 kg/m"), "count"),
}
RANGE = ("--altitudes", "70 km to 76 km")


@pytest.mark.parametrize("command", COMMANDS)
def test_a_command_prints_a_table_and_writes_what_it_says(prints, flyer_file, tmp_path, command):
    options, name = COMMANDS[command]
    flyer, out = flyer_file('"0 mg"', '"0.05 mg"'), tmp_path / "out"
    page = tmp_path / "page.html"
    shown = prints(
        command, flyer, *options, *RANGE, "--out", out, "--format", "png", "--report", page
    )
    assert shown.startswith(f"disk of 2 cm, {command} ")
    assert "72.5" in [line.split()[0] for line in shown.splitlines() if line.strip()]
    for ending in ("nc", "csv", "json", "png"):
        assert f"{command}.{ending}" in shown
    assert (out / f"{command}.png").stat().st_size > 300
    assert f"lightflyer {command}" in page.read_text(encoding="utf-8")
    summary = json.loads((out / f"{command}.json").read_text(encoding="utf-8"))
    with xr.open_dataset(out / f"{command}.nc", engine="h5netcdf") as dataset:
        known = np.array(summary[name]["values"], float)  # null is not a number
        np.testing.assert_array_equal(dataset[name], known)
        assert np.isfinite(known).any()
        assert all(one.attrs["units"] for one in dataset.variables.values())
        assert "[flyer]" in dataset.attrs["configuration"]
        header, *rows = csv.reader((out / f"{command}.csv").read_text().splitlines())
        assert len(rows) == dataset.sizes["altitude"] * dataset.sizes.get("tilt", 1)
        column = header.index(f"{name} [{dataset[name].units}]")
        middle = len(rows) // 2
        assert float(rows[middle][column]) == pytest.approx(
            float(dataset[name][middle // dataset.sizes.get("tilt", 1)])
        )
    assert json.loads(prints(command, flyer, *options, *RANGE, "--json")) == summary


@pytest.mark.parametrize(("given", "said"), [
    (("drift", *RANGE, "--azimuth", "north"), "--azimuth"),
    (("drift", "--altitudes", "76 km to 70 km"), "the first must be the lower one"),
    (("stability", *RANGE, "--rod", "1"), 'rod = "1" has no unit'),
    (("swarm", *RANGE), "swarm needs --payload (what they carry"),
    (("swarm", *RANGE, "--payload", "1 m"), "payload"),
])  # fmt: skip
def test_what_cannot_be_is_refused_in_one_line(refuses, flyer_file, given, said):
    command, *options = given
    (line,) = refuses(command, flyer_file(), *options).splitlines()
    assert said in line
