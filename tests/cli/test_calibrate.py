import json
import subprocess
import sys

import numpy as np
import pytest

import lightflyer as lf


def run(folder, *arguments):
    return subprocess.run(
        [sys.executable, "-m", "lightflyer", *arguments],
        capture_output=True, text=True, check=False, cwd=folder,
    )  # fmt: skip


@pytest.fixture
def folder(tmp_path):
    film = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
    pressure = np.geomspace(1.5, 20.0, 6)
    disk, state = lf.Disk(film, 0.01), lf.Chamber().state(pressure)
    light = lf.levitate(disk, state, lf.Lu2023(0.45, 2.5)).irradiance
    rows = [f"synthetic, {p:.8g}, {i / 1e3:.8g}" for p, i in zip(pressure, light, strict=True)]
    text = "\n".join(["sample, pressure [Pa], irradiance [kW/m^2]", *rows]) + "\n"
    (tmp_path / "points.csv").write_text(text, encoding="utf-8")
    return tmp_path


def test_fits_and_writes(folder):
    done = run(folder, "calibrate", "points.csv", "--out", "fit")
    assert done.returncode == 0, done.stderr
    fit = json.loads((folder / "fit" / "calibration.json").read_text(encoding="utf-8"))
    assert fit["parameters"]["c_fm"]["value"] == pytest.approx(0.45, rel=1e-4)
    assert fit["parameters"]["c_cont"]["value"] == pytest.approx(2.5, rel=1e-4)
    assert np.shape(fit["covariance"]) == (2, 2)
    names = {path.name for path in (folder / "fit").iterdir()}
    assert names == {"calibration.json", "residuals.csv", "residuals.png", "residuals.svg"}
    assert len((folder / "fit" / "residuals.csv").read_text(encoding="utf-8").splitlines()) == 7


@pytest.mark.parametrize(
    ("text", "arguments", "says"),
    [
        ("sample,pressure [Pa]\na,1\n", [], "points.csv:1: the column irradiance is missing"),
        ("sample,pressure [Pa],irradiance [W/m^2]\na,2,900\n", [], "1 points cannot fix"),
        (None, ["--free", "c_fm,density"], '"density" cannot be fitted'),
    ],
)
def test_bad_input(folder, text, arguments, says):
    if text:
        (folder / "points.csv").write_text(text, encoding="utf-8")
    done = run(folder, "calibrate", "points.csv", "--out", "fit", *arguments)
    assert done.returncode == 2
    assert says in done.stderr
    assert done.stderr.count("\n") == 1
    assert not (folder / "fit").exists()
