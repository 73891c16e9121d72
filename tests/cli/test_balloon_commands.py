"""The balloon through the commands that a flyer file goes through."""

import json

import pytest
import xarray as xr

import lightflyer as lf

STUDY = """\
flyer = "flyer.toml"

[sweep]
"flyer.diameter" = ["4 m", "5.8 m", "8 m"]
altitude = ["15 km", "18 km"]
[outputs]
variables = ["relative_payload", "temperature", "film_tension", "buoyancy"]

[optimise]
maximise = "lift_over_weight"
beyond_range = true
starts = 2
[optimise.over]
"film.emittance_top" = { from = 0.1, to = 0.9 }
altitude = "18 km"
"""


@pytest.fixture
def flyer_file(run, tmp_path):
    path = tmp_path / "flyer.toml"
    assert run("init", path, "--kind", "balloon")[0] == 0
    return path


def test_a_balloon_too_heavy_to_fly_gets_no_advice_on_accommodation(run, flyer_file):
    text = flyer_file.read_text(encoding="utf-8")
    text = text.replace('payload = "1.7 kg"', 'payload = "1.7 kg"\ngas_mass = "6 kg"')
    flyer_file.write_text(text, encoding="utf-8")
    code, text, _ = run("predict", flyer_file, "--samples", "0")
    assert code == 0
    assert "It does not fly" in text
    assert "tac_bottom" not in text


def test_predict_a_balloon(run, flyer_file, tmp_path):
    out = tmp_path / "out"
    certain = 'model = "balloon"\nconvection_error = "0"'
    text = flyer_file.read_text(encoding="utf-8").replace('model = "balloon"', certain)
    flyer_file.write_text(text, encoding="utf-8")
    code, text, errors = run("predict", flyer_file, "--out", out, "--at", "18 km")
    assert (code, errors) == (0, "")
    assert text.startswith("open balloon of 5.8 m")
    summary = json.loads((out / "prediction.json").read_text())
    low, high = summary["altitude_band_km"]
    assert (low, high) == pytest.approx((1.0, 19.5), abs=0.3)
    (at,) = summary["at"]
    setup = lf.read_flyer_file(flyer_file).build()
    state = setup.environment.state(18e3)
    found = lf.equilibrium(setup.flyer, state, setup.model)
    assert at["temperature_k"] == pytest.approx(found.temperature, rel=1e-6)
    assert at["filled_share"] == 1.0
    with xr.open_dataset(out / "prediction.nc") as dataset:
        assert dataset.film_tension.attrs["units"] == "N/m"
        assert dataset.buoyancy.attrs["units"] == "N"
        # all lift is buoyancy
        assert float(abs(dataset.lift / dataset.buoyancy - 1.0).max()) < 1e-12
    assert {path.name for path in out.glob("*.png")} == {
        "levitation-irradiance.png",
        "payload.png",
    }


@pytest.mark.slow
def test_helium_needs_no_light(run, flyer_file, tmp_path):
    text = flyer_file.read_text(encoding="utf-8")
    changed = text.replace('"1.7 kg"', '"1.7 ± 0.1 kg"\ngas = "helium"')
    assert changed != text
    flyer_file.write_text(changed, encoding="utf-8")
    code, text, errors = run(
        "predict", flyer_file, "--out", tmp_path / "out", "--samples", "0", "--verbose"
    )
    assert (code, errors) == (0, "")
    assert "least irradiance  0.0 W/m²" in text
    summary = json.loads((tmp_path / "out" / "prediction.json").read_text())
    least = summary["uncertainty"]["results"]["minimum_irradiance.value_w_m2"]
    assert (least["first_order"]["low"], least["first_order"]["high"]) == (0.0, 0.0)


@pytest.mark.slow
def test_many_balloons(run, flyer_file, tmp_path):
    study, out = tmp_path / "study.toml", tmp_path / "results.zarr"
    study.write_text(STUDY, encoding="utf-8")
    assert run("sweep", study, "--out", out)[0] == 0
    dataset = lf.parametric.open_sweep(out)
    # larger balloons of the same film are hotter by less convection, and carry more than their own
    assert bool((dataset.relative_payload.diff("flyer.diameter") > 0.0).all())
    code, text, errors = run("optimise", study, "--json")
    assert (code, errors) == (0, "")
    assert json.loads(text)["design"]["film.emittance_top"] == pytest.approx(0.1)
