"""The plate through the commands that a flyer file goes through."""

import json

import pytest
import xarray as xr

import lightflyer as lf

STUDY = """\
flyer = "flyer.toml"

[sweep]
"flyer.height" = ["30 um", "50 um", "100 um"]
pressure = ["10 Pa", "100 Pa"]
[outputs]
variables = ["lift_over_weight", "flow_velocity", "temperature_bottom"]
"""


@pytest.fixture
def flyer_file(run, tmp_path):
    path = tmp_path / "flyer.toml"
    assert run("init", path, "--kind", "plate")[0] == 0
    with path.open("a", encoding="utf-8") as file:  # derivatives take long to compile
        file.write("force_error = 0.0\nheat_error = 0.0\n")
    return path


@pytest.mark.slow
def test_predict_a_plate(run, flyer_file, tmp_path):
    code, text, errors = run("predict", flyer_file, "--out", tmp_path / "out", "--at", "100 Pa")
    assert (code, errors) == (0, "")
    assert text.startswith("plate of 8 mm, 0.01851 mg")
    assert "flow velocity" in text
    summary = json.loads((tmp_path / "out" / "prediction.json").read_text())
    (at,) = summary["at"]
    assert at["temperature_k"] == at["temperature_bottom_k"] > at["temperature_top_k"]
    assert at["stopping_pressure_mpa"] > at["pressure_difference_mpa"] > 0.0
    setup = lf.read_flyer_file(flyer_file).build()
    low, high = summary["pressure_band_pa"]
    assert low < 10.0  # where such plates levitated
    assert high > 200.0
    for pressure, flies in ((0.99 * low, False), (1.01 * low, True), (1.01 * high, False)):
        state = setup.environment.state(pressure)
        lifted = lf.lift(setup.flyer, state, setup.model) > lf.statics.weight(setup.flyer, state)
        assert lifted == flies
    with xr.open_dataset(tmp_path / "out" / "prediction.nc") as dataset:
        assert dataset.flow_velocity.attrs["units"] == "m s-1"
        assert dataset.pressure_difference.attrs["units"] == "Pa"
        assert "highest_temperature" not in dataset.attrs["warnings"]  # the template states it


def test_many_plates(run, flyer_file, tmp_path):
    study, out = tmp_path / "study.toml", tmp_path / "results.zarr"
    study.write_text(STUDY, encoding="utf-8")
    assert run("sweep", study, "--out", out)[0] == 0
    dataset = lf.parametric.open_sweep(out)
    setup = lf.read_flyer_file(flyer_file).build()
    state = setup.environment.state(100.0)
    here = lf.lift(setup.flyer, state, setup.model) / lf.statics.weight(setup.flyer, state)
    swept = dataset.lift_over_weight.sel(
        {"flyer.height": 50e-6, "pressure": 100.0}, method="nearest"
    )
    assert float(swept) == pytest.approx(here, rel=1e-9)
    assert dataset.flow_velocity.attrs["units"] == "m s-1"
    assert bool((dataset.flow_velocity > 0.0).all())
