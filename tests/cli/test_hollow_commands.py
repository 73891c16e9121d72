"""Hollow bodies through the commands that a flyer file goes through."""

import numpy as np
import pytest

import lightflyer as lf

STUDY = """\
flyer = "flyer.toml"

[sweep]
"flyer.channel_width" = ["0.4 mm", "0.8 mm"]
"flyer.outlet_diameter" = ["4 cm", "8 cm"]
altitude = "75 km"
[outputs]
variables = ["payload", "temperature_inner", "temperature_outer", "jet_velocity", "buoyancy"]
"""


@pytest.fixture
def flyer_file(run, tmp_path):
    path = tmp_path / "flyer.toml"
    assert run("init", path, "--kind", "hollow")[0] == 0
    return path


def test_many_hollow_bodies(run, flyer_file, tmp_path):
    study, out = tmp_path / "study.toml", tmp_path / "results.zarr"
    study.write_text(STUDY, encoding="utf-8")
    code, _, errors = run("sweep", study, "--out", out)
    assert (code, errors) == (0, "")
    dataset = lf.parametric.open_sweep(out)
    assert dataset.jet_velocity.attrs["units"] == "m s-1"
    assert bool((dataset.temperature_inner > dataset.temperature_outer).all())
    setup = lf.read_flyer_file(flyer_file).build()
    mine = {"flyer.channel_width": 8e-4, "flyer.outlet_diameter": 0.08}
    swept = dataset.payload.sel(mine, method="nearest")
    here = lf.payload(setup.flyer, setup.environment.state(75e3), setup.model)
    assert float(np.squeeze(swept)) == pytest.approx(here, rel=1e-9)
    assert here > 1e-6


def test_a_mistake_is_one_line(run, flyer_file):
    text = flyer_file.read_text(encoding="utf-8")
    assert '"8 cm"' in text
    flyer_file.write_text(text.replace('"8 cm"', '"11 cm"'), encoding="utf-8")
    code, _, errors = run("predict", flyer_file)
    assert code == 2
    assert errors.strip().splitlines() == [
        f"lightflyer: error: {flyer_file}:6: [flyer]: the outlet must be smaller than the sphere"
    ]
