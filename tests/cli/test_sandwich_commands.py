"""The sandwich through every command that a flyer file goes through."""

import json

import pytest
import xarray as xr

import lightflyer as lf

STUDY = """\
flyer = "flyer.toml"

[sweep]
"flyer.gap" = ["50 um", "125 um", "300 um"]
altitude = ["70 km", "75 km"]
[outputs]
variables = ["relative_payload", "temperature_top", "temperature_bottom"]

[optimise]
maximise = "payload"
beyond_range = true
starts = 2
[optimise.over]
"flyer.gap" = { from = "30 um", to = "2 mm", scale = "log" }
"flyer.bottom.emittance_bottom" = { from = 0.05, to = 0.3 }
altitude = "75 km"

[sensitivity]
outputs = "payload"
points = 64
[sensitivity.at]
altitude = "75 km"
[sensitivity.inputs]
"flyer.support_fraction" = "1.0e-4 ± 0.2e-4"
"flyer.top.tac_top" = "0.80 ± 0.05"
"""


@pytest.fixture
def flyer_file(run, tmp_path):
    path = tmp_path / "flyer.toml"
    assert run("init", path, "--kind", "sandwich")[0] == 0
    return path


@pytest.mark.slow
def test_predict_a_sandwich(run, flyer_file, tmp_path):
    code, text, errors = run("predict", flyer_file, "--out", tmp_path / "out", "--at", "75 km")
    assert (code, errors) == (0, "")
    assert text.startswith("sandwich of 2 cm, 0.117 mg")
    assert "warning: gap over the mean free path is" in text
    summary = json.loads((tmp_path / "out" / "prediction.json").read_text())
    (at,) = summary["at"]
    assert at["temperature_k"] == at["temperature_bottom_k"] > at["temperature_top_k"]
    setup = lf.read_flyer_file(flyer_file).build()
    low, high = summary["altitude_band_km"]
    for altitude, flies in ((low - 0.01, False), (low + 0.01, True), (high + 0.01, False)):
        state = setup.environment.state(altitude * 1e3)
        lifted = lf.lift(setup.flyer, state, setup.model) > lf.statics.weight(setup.flyer, state)
        assert lifted == flies
    with xr.open_dataset(tmp_path / "out" / "prediction.nc") as dataset:
        assert dataset.temperature_top.attrs["units"] == "K"
        assert "mean free path" in dataset.attrs["warnings"]
    assert {path.name for path in (tmp_path / "out").glob("*.png")} == {
        "levitation-irradiance.png",
        "payload.png",
    }


def test_warnings_are_of_where_it_flies(run, flyer_file):
    text = flyer_file.read_text(encoding="utf-8")
    for old, new in (('"1361 W/m^2"', '"400 W/m^2"'), ('"125 um"', '"100 um"')):
        assert old in text
        text = text.replace(old, new)
    flyer_file.write_text(text, encoding="utf-8")
    assert "warning: " not in run("predict", flyer_file, "--at", "75 km")[1]
    told = run("predict", flyer_file, "--at", "44 km")[1]
    assert "warning: the rarefaction parameter is" in told
    assert "at 169 Pa, above 100: the table" in told


@pytest.mark.slow
def test_many_sandwiches(run, flyer_file, tmp_path):
    study, out = tmp_path / "study.toml", tmp_path / "results.zarr"
    study.write_text(STUDY, encoding="utf-8")
    setup = lf.read_flyer_file(flyer_file).build()
    here = lf.payload(setup.flyer, setup.environment.state(75e3), setup.model)

    assert run("sweep", study, "--out", out)[0] == 0
    dataset = lf.parametric.open_sweep(out)
    swept = dataset.relative_payload.sel({"flyer.gap": 125e-6, "altitude": 75e3}, method="nearest")
    assert float(swept) == pytest.approx(here / setup.flyer.own_mass, rel=1e-9)
    assert bool((dataset.temperature_bottom > dataset.temperature_top).all())

    code, text, errors = run("optimise", study, "--json")
    assert (code, errors) == (0, "")
    best = json.loads(text)
    assert best["value"] > here
    assert best["design"]["flyer.bottom.emittance_bottom"] == pytest.approx(0.05)

    code, text, errors = run("sensitivity", study, "--json")
    assert (code, errors) == (0, "")
    inputs = json.loads(text)["payload"]["inputs"]
    assert inputs["flyer.top.tac_top"]["total"] == 0.0  # the model takes it for one
    assert inputs["flyer.support_fraction"]["total"] == pytest.approx(1.0, abs=0.15)
