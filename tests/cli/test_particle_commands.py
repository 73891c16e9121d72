"""A particle through the commands that a flyer file goes through."""

import json

import pytest
import xarray as xr

import lightflyer as lf

STUDY = """\
flyer = "flyer.toml"

[sweep]
"flyer.diameter" = ["1 um", "2 um", "4 um"]
altitude = ["50 km", "70 km"]
[outputs]
variables = ["lift_over_weight", "temperature", "side_difference", "climb_speed"]

[optimise]
maximise = "lift_over_weight"
beyond_range = true
starts = 2
[optimise.over]
"flyer.diameter" = { from = "0.5 um", to = "8 um" }
altitude = "70 km"
"""


@pytest.fixture
def flyer_file(run, tmp_path):
    path = tmp_path / "flyer.toml"
    assert run("init", path, "--kind", "particle")[0] == 0
    return path


def test_a_particle_has_no_film_that_might_melt(run, flyer_file):
    _, text, _ = run("predict", flyer_file, "--samples", 0)
    assert "; its limit is not stated." in " ".join(text.split())
    content = flyer_file.read_text(encoding="utf-8")
    limited = content.replace('# highest_temperature = "900 K"', 'highest_temperature = "900 K"')
    flyer_file.write_text(limited, encoding="utf-8")
    _, text, _ = run("predict", flyer_file, "--samples", 0)
    assert "; it withstands 900 K and survives." in " ".join(text.split())
    assert "film" not in text.partition("next:")[0]


def test_predict_a_particle(run, flyer_file, tmp_path):
    out = tmp_path / "out"
    code, text, errors = run(
        "predict", flyer_file, "--out", out, "--at", "50 km,70 km", "--samples", 0
    )
    assert (code, errors) == (0, "")
    assert text.startswith("sphere of 2 µm, 5.027 pg, in 1361 W/m²")
    summary = json.loads((out / "prediction.json").read_text())
    setup = lf.read_flyer_file(flyer_file).build()
    for at, altitude in zip(summary["at"], (50e3, 70e3), strict=True):
        state = setup.environment.state(altitude)
        found = lf.equilibrium(setup.flyer, state, setup.model)
        lift = lf.lift(setup.flyer, state, setup.model)
        speed = -lf.statics.sinking_speed(setup.flyer, state, setup.model)
        assert at["temperature_k"] == pytest.approx(found.temperature, rel=1e-9, abs=0.0)
        assert at["lift_over_weight"] == pytest.approx(
            lift / lf.statics.weight(setup.flyer, state), rel=1e-9
        )
        assert at["climb_speed_m_s"] == pytest.approx(speed, rel=1e-6, abs=0.0)
        top, bottom = found.temperatures
        assert at["side_difference_k"] == pytest.approx(top - bottom, rel=1e-5, abs=0.0)
    with xr.open_dataset(out / "prediction.nc") as dataset:
        assert dataset.climb_speed.attrs["units"] == "m s-1"


@pytest.mark.slow
def test_many_particles(run, flyer_file, tmp_path):
    study, out = tmp_path / "study.toml", tmp_path / "results.zarr"
    study.write_text(STUDY, encoding="utf-8")
    assert run("sweep", study, "--out", out)[0] == 0
    dataset = lf.parametric.open_sweep(out)
    assert bool((dataset.climb_speed > 0.0).any())
    assert bool((dataset.side_difference > 0.0).all())
    code, text, errors = run("optimise", study, "--json")
    assert (code, errors) == (0, "")
    best = float(json.loads(text)["outputs"]["lift_over_weight"])
    assert best >= float(dataset.lift_over_weight.sel(altitude=70e3).max())
